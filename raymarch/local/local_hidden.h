#pragma once
// Internal: which triangles are surely hidden in a picture, from the depths of a coarse model.

#include <vector>

#include "raymarch/local/local_triangles.h"
#include "subdiv/mesh.h"

namespace limn {

/// The nearest depth in each pixel of a picture.
struct HiddenParts {
  int width = 0, height = 0;
  std::vector<float> depth{};  ///< Along the view axis; infinite where nothing is seen. Empty: not known.
};

HiddenParts hidden_parts(const LocalTriangles& mesh, const Camera& camera);
HiddenParts hidden_parts(const TriangleMesh& mesh, const Camera& camera);

/// True where everything within `margin_px` of the points (pixels and depth, as project() gives them) is covered by what is nearer by at
/// least `margin` world units.
bool is_hidden(const HiddenParts& parts, std::span<const glm::dvec3> points, double margin_px, double margin);

}  // namespace limn
