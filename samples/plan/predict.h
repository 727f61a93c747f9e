#pragma once
// What a plan expects of a model before it is built.

#include "raymarch/curves/curve_geometry.h"
#include "samples/plan/plan.h"

namespace limn {

/// A piece of the true border, as predictions see it.
struct BorderPlace {
  CurveKind kind = CurveKind::silhouette;
  double weight_px = 0.0;         ///< Its length.
  double px_per_unit = 0.0;       ///< Pixels for each world unit at its depth.
  double curvature = 0.0;         ///< Radial, its magnitude, 1 / world unit; NaN at creases.
  double curvature_change = 0.0;  ///< Of the radial curvature along the border, 1 / world unit squared.
  double px_per_radian = 0.0;     ///< Of an inner border: how far it moves for each radian of normal error, to first order.
  /// Of an inner border: to the other side of its band of ink, and across what is clear beside it; infinite beyond reach_px.
  double ink_px = 0.0, clear_px = 0.0;
  double reach_px = 0.0;  ///< Larger displacements are not measured (search_reach_px).
};

/// The true border of a view, about each px.
std::vector<BorderPlace> border_places(const PlanView& view);

/// Of a candidate in one view. Normals are wrong by the series' constant times the power of curvature and size; half of the border by so
/// much too far out, half too far in. An inner border then lies where the wrong N.V meets the threshold on the true surface's profile,
/// which the next border or the silhouette ends; what gets there is lost, and counts as off by the width of its band. The bounds are those
/// of a constant smaller and larger by kNormalSpread.
PredictedErrors predict_errors(const ResolutionSeries& series, size_t candidate, const std::vector<BorderPlace>& places, double threshold);
/// `expected` alone of predict_errors, in a third of its time.
BorderErrors expected_errors(const ResolutionSeries& series, size_t candidate, const std::vector<BorderPlace>& places, double threshold);

}  // namespace limn
