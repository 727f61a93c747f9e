#pragma once
// Internal: where a contour's radial curvature changes its sign, and cusps may be.

#include "raymarch/lines/curvature_jumps.h"
#include "raymarch/lines/curve_walk.h"

namespace limn {

/// Samples around a change of the radial curvature's sign.
struct SignChange {
  size_t before = 0, after = 0;
  double place = 0.0;
  double turn = 0.0;  ///< Where the polyline turns back in the image: of a jump at a sample beside the place.
  std::optional<CurvatureJump> jump{};
};

/// Changes so close to each other that nobody can tell them apart are one, or none where the last undoes the first.
struct SignChanges {
  std::vector<SignChange> apart{};
  std::vector<SignChange> undone{};  ///< Without places.
};
/// `extent`: the scene's radius.
SignChanges sign_changes_of(const SurfaceCurve& curve, const CurveWalk& walk, const Camera& camera, double extent);

}  // namespace limn
