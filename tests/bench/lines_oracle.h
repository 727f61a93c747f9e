#pragma once
// What rays through pixels say about a drawing's visible and hidden lines. Shares nothing with the solver of lines.

#include "raymarch/lines.h"
#include "raymarch/surface.h"
#include "tests/bench/spline_rays.h"

namespace limn::bench {

/// What is asked: fields as they are, by the marcher of pictures; level sets by the splines that are drawn; other meshes as they are, and
/// cages refined as often as two million faces allow.
struct Oracle {
  std::optional<SceneModel> model{};  ///< Of all objects but level sets.
  std::vector<std::optional<SplineBody>> splines{};
  std::vector<std::optional<Field>> fields{};  ///< One for each object: where the contours of fields lie.
};
Oracle make_oracle(const Scene& scene);

/// Of points 2 px apart on every edge, half a pixel from its ends. Rays pass through the point and a quarter of a pixel to both sides;
/// those of a contour also outside of it, where nothing of its own surface is. A level set's contour is looked for beside the drawn one
/// first: so rays pass outside of it by less than a drawing's tolerance. Where a field's contour seems to be seen a ray through its own
/// point, found in the same way, has to say so, too.
struct OracleCount {
  std::int64_t points = 0, visible = 0;
  std::int64_t occluded = 0;  ///< Drawn as visible, and all rays hit something nearer.
  std::int64_t seen = 0;      ///< Drawn as hidden, and no ray does, or none outside of a contour.
  /// Drawn as hidden, of a level set's contour whose own point is not found: the ray through the drawn point meets something nearer, those
  /// that pass outside of it, nearer to it than it is known, do not.
  std::int64_t undecided = 0;
  std::vector<glm::dvec2> places{};  ///< Of those drawn wrongly.
};
void add(const OracleCount& more, OracleCount& sum);
OracleCount ask_oracle(const Oracle& oracle, const Camera& camera, const ViewGraph& graph);

}  // namespace limn::bench
