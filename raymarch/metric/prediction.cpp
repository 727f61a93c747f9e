// What theory predicts from the model's normals and the true curvature, beside what was measured.

#include "raymarch/metric/border_prediction.h"

#include "raymarch/metric/curve_findings.h"

namespace limn {
namespace {

std::vector<MetricValue> measure(const MetricInput& input) {
  constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
  DisplacementPrediction d;
  WidthPrediction w{0, nothing, nothing, nothing, nothing, nothing, nothing};
  if (input.curves != nullptr && input.truth != nullptr && input.model != nullptr) {
    CurveFindings own, &findings = findings_of(input, own);
    const BorderPrediction prediction =
        predict_border(*input.model, input.camera, *input.truth, *input.curves, find_match(input, findings));
    d = prediction.displacement;
    w = prediction.width;
  }
  return {{"prediction_error_rms", d.error_rms_px, "px"},
          {"prediction_displacement_rms", d.predicted_rms_px, "px"},
          {"prediction_displacement_low", d.low_px, "px"},
          {"prediction_displacement_high", d.high_px, "px"},
          {"prediction_measured_rms", d.measured_rms_px, "px"},
          {"prediction_displacement_mean", d.predicted_mean_px, "px"},
          {"prediction_measured_mean", d.measured_mean_px, "px"},
          {"prediction_correlation", d.correlation, ""},
          {"prediction_within_quarter", d.within_quarter, ""},
          {"prediction_covered", d.covered, ""},
          {"prediction_outside", d.outside, ""},
          {"prediction_ends", d.ends, ""},
          {"prediction_turns_back", d.turns_back, ""},
          {"prediction_first_order_rms", d.first_order_rms_px, "px"},
          {"prediction_normal_error_rms", glm::degrees(d.normal_error_rms), "deg"},
          {"prediction_width_error_rms", w.error_rms_px, "px"},
          {"prediction_width_mean", w.exact_mean_px, "px"},
          {"prediction_width_plain_mean", w.plain_mean_px, "px"},
          {"prediction_width_measured_mean", w.measured_mean_px, "px"},
          {"prediction_width_correlation", w.correlation, ""}};
}

}  // namespace

Metric prediction_metric() {
  return {
      {"prediction",
       "the inner border's displacement and the ink's width, predicted from the model's normals and the true curvature, beside what was "
       "measured. The displacement: to where the model's N.V meets the threshold, from its normals at eleven image points on a line "
       "across the true border; to first order s c eps / kr. Root mean squares, what the measured one is expected between (low, high: "
       "by what the last image point changed, 25 % of the displacement, and the next place on the line where N.V meets the threshold), "
       "means, correlation, share of what moved less than 2 px that is predicted to 25 %, share of the border that could be compared "
       "(not where inner_displacement is ill), and shares without "
       "a prediction because an assumption fails: the model shows another sheet there or none (outside), the surface ends or is "
       "covered on the way (ends), N.V turns back or hardly changes (turns_back); the normal error eps behind it. The width: "
       "c^2 / (2 kr) and the osculating circle's",
       "width: Kindlmann et al. 2003; displacement: limn"},
      {"prediction_error_rms [px]",
       "prediction_displacement_rms [px]",
       "prediction_displacement_low [px]",
       "prediction_displacement_high [px]",
       "prediction_measured_rms [px]",
       "prediction_displacement_mean [px]",
       "prediction_measured_mean [px]",
       "prediction_correlation",
       "prediction_within_quarter",
       "prediction_covered",
       "prediction_outside",
       "prediction_ends",
       "prediction_turns_back",
       "prediction_first_order_rms [px]",
       "prediction_normal_error_rms [deg]",
       "prediction_width_error_rms [px]",
       "prediction_width_mean [px]",
       "prediction_width_plain_mean [px]",
       "prediction_width_measured_mean [px]",
       "prediction_width_correlation"},
      true,
      measure,
      MetricSubject::curves};
}

}  // namespace limn
