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

struct CutSettings {
  double edge_px = 2.0;                             ///< Edges that are seen longer are cut,
  double least = 0.0;                               ///< but none that is shorter than this, world units,
  std::int64_t most = 0;                            ///< and no more where there would be more triangles.
  std::function<void(glm::dvec3&)> onto_surface{};  ///< Moves the middles of edges; empty: they stay.
};
/// Cuts long edges in their middles; neighbours cut a common edge at the same point. Returns how long the longest edge is that is in the
/// picture and should have been cut, px; 0: none.
double cut_long_edges(const Camera& camera, const CutSettings& settings, FeatureMesh& mesh);

/// Whether a triangle may be in the picture: none of its sides has all corners beyond it.
bool may_be_seen(const Camera& camera, const std::array<glm::dvec3, 3>& corners);

}  // namespace limn
