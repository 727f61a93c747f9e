#pragma once
// Internal: triangles of a surface cut until their edges are short in the image.

#include <array>
#include <functional>
#include <vector>

#include "raymarch/lines/surface_curves.h"

namespace limn {

struct FeatureMesh {
  std::vector<glm::dvec3> positions{};  ///< Solver space.
  std::vector<std::array<std::uint32_t, 3>> triangles{};
};

/// Cuts edges that are seen longer than `edge_px` in their middles, which `onto_surface` moves, until none is left or there are `most`
/// triangles. Neighbours cut a common edge at the same point. Returns how long the longest edge in the picture is, px.
double cut_long_edges(const Camera& camera, double edge_px, std::int64_t most, const std::function<void(glm::dvec3&)>& onto_surface,
                      FeatureMesh& mesh);

/// Whether a triangle may be in the picture: none of its sides has all corners beyond it.
bool may_be_seen(const Camera& camera, const std::array<glm::dvec3, 3>& corners);

}  // namespace limn
