#pragma once
// What rays through pixels say about a drawing's visible and hidden lines. Shares nothing with the solver of lines.

#include "raymarch/lines.h"
#include "raymarch/surface.h"

namespace limn::bench {

/// A model to ask: fields and level sets as they are, by the marcher; other meshes as they are, and cages refined as often as two million
/// faces allow.
SceneModel oracle_model(const Scene& scene);

/// Of points 2 px apart on every edge, half a pixel from its ends. Rays pass through the point and a quarter of a pixel to both sides;
/// those of a contour also outside of it, where nothing of its own surface is.
struct OracleCount {
  std::int64_t points = 0, visible = 0;
  std::int64_t occluded = 0;         ///< Drawn as visible, and all rays hit something nearer.
  std::int64_t seen = 0;             ///< Drawn as hidden, and no ray does, or none outside of a contour.
  std::vector<glm::dvec2> places{};  ///< Of the last two.
};
void add(const OracleCount& more, OracleCount& sum);
OracleCount ask_oracle(const SceneModel& model, const Camera& camera, const ViewGraph& graph);

}  // namespace limn::bench
