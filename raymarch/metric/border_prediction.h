#pragma once
// What theory says of a model's border before it is measured: how far a wrong normal moves it, and how wide curvature makes it.

#include "raymarch/truth.h"

namespace limn {

/// A model's normal error eps (in the plane of N and V, positive: N.V too low) moves the inner border by s c eps / kr, seen in parallel
/// (c the threshold, s px per world unit, kr the radial curvature): N.V changes by sin (kr + c / d) for each world unit towards the eye
/// along the surface, d the distance to the eye, because the view turns too; the step's image is taken along the border's normal.
/// Where normals jump from cell to cell (a level set's `cell` gradient) the border runs along the jumps. With N.V right in the middle of a
/// cell of width w, and that middle at u <= w/2 from the true border, theory says u and the border goes w/2 - u the same way: over all u
/// both are spread evenly up to w/2, so the root mean squares agree and the places do not (correlation 1/2).
/// Lengths are weighted; NaN where nothing could be compared.
struct DisplacementPrediction {
  int samples = 0;                ///< Each px of the true inner border, both predicted and measured.
  double covered = 0.0;           ///< Their share of it. Creases have no curvature, a vanished border no measurement.
  double normal_error_rms = 0.0;  ///< Of eps, radians.
  double predicted_mean_px = 0.0, measured_mean_px = 0.0;
  double predicted_rms_px = 0.0, measured_rms_px = 0.0;
  double error_rms_px = 0.0;    ///< Of predicted less measured.
  double correlation = 0.0;     ///< Pearson's.
  double within_quarter = 0.0;  ///< Share predicted to 25 % (or 0.01 px), of those measured below 2 px.
};

/// Ink of N.V < c is c^2 / (2 kr) wide in the world, exactly (1 - sqrt(1 - c^2)) / kr on the osculating circle (Kindlmann et al. 2003).
/// From an eye at distance d of the contour it spans the angle delta of sqrt(1 - c^2) = cos delta - kr d sin delta.
struct WidthPrediction {
  int samples = 0;  ///< Each px of the true silhouette where both are known.
  double covered = 0.0;
  double plain_mean_px = 0.0;  ///< c^2 / (2 kr).
  double exact_mean_px = 0.0;  ///< The circle's, perspective and all.
  double measured_mean_px = 0.0;
  double error_rms_px = 0.0;  ///< Of exact less measured.
  double correlation = 0.0;   ///< Of exact and measured.
};

struct BorderPrediction {
  DisplacementPrediction displacement{};
  WidthPrediction width{};
};

/// Compares with what was measured: `curves` of `model` (raymarch/measured_border.h). The model is asked for its normals at the truth's
/// image points. `truth` must know positions, normals and curvatures; where it does not, nothing is predicted.
BorderPrediction predict_border(const SceneModel& model, const Camera& camera, const BorderTruth& truth, const BorderCurves& curves);

}  // namespace limn
