#pragma once
// What theory says of a model's border before it is measured: how far a wrong normal moves it, and how wide curvature makes it.

#include <limits>

#include "raymarch/curves/border_match.h"
#include "raymarch/truth.h"

namespace limn {

/// A model's normal error eps (in the plane of N and V, positive: N.V too low) moves the inner border by s c eps / kr to first order, seen
/// in parallel (c the threshold, s px per world unit, kr the radial curvature): N.V changes by sin (kr + c / d) for each world unit towards
/// the eye along the surface, d the distance to the eye, because the view turns too; the step's image is taken along the border's normal.
/// Where kr is small against the displacement N.V bends on the way, and eps changes: the border lies where the changed N.V meets c, which
/// is solved for (raymarch/metric/solved_shift.h). Where there is no such place, the assumption that fails is counted instead.
/// Where normals jump from cell to cell (a level set's `cell` gradient) the border runs along the jumps.
/// Lengths are weighted; NaN where nothing could be compared.
struct DisplacementPrediction {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  int samples = 0;                  ///< Each px of the true inner border, both predicted and measured: what all means below are over.
  double covered = kNone;           ///< Their share of it. Creases have no curvature, a vanished border no measurement.
  double outside = kNone,           ///< Share of it without a prediction, because the model shows another sheet there, or none;
      ends = kNone,                 ///< because the surface ends or is covered before N.V meets the threshold;
      turns_back = kNone;           ///< because N.V turns back before it meets it, or gets there too slowly to be told.
  double normal_error_rms = kNone;  ///< Of eps, radians.
  double predicted_mean_px = kNone, measured_mean_px = kNone;
  double predicted_rms_px = kNone, measured_rms_px = kNone;
  double low_px = kNone,
         high_px = kNone;  ///< What measured_rms_px is expected between: all shifts less, or more, by their uncertainty and truth's.
  double first_order_rms_px = kNone;  ///< Of eps s c / kr.
  double error_rms_px = kNone;        ///< Of predicted less measured.
  double correlation = kNone;         ///< Pearson's.
  double within_quarter = kNone;      ///< Share predicted to 25 % (or 0.01 px), of those measured below 2 px.
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

/// How far the inner border moves along `sample.outward` for each radian by which N.V is too low, to first order, px; NaN where `truth`
/// knows no curvature. `sample` is one of `truth`'s.
double displacement_per_radian(const Camera& camera, const BorderCurves& truth, const BorderSample& sample);

/// Compares with what was measured: `curves` of `model` (raymarch/measured_border.h). The model is asked for its normals at the truth's
/// image points. `truth` must know positions, normals and curvatures; where it does not, nothing is predicted.
BorderPrediction predict_border(const SceneModel& model, const Camera& camera, const BorderTruth& truth, const BorderCurves& curves);
/// Where the match of `curves` with the truth's is known (both kinds).
BorderPrediction predict_border(const SceneModel& model, const Camera& camera, const BorderTruth& truth, const BorderCurves& curves,
                                const BorderMatch& match);

}  // namespace limn
