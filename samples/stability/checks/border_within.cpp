// The model's border against the true one, at its worst place.

#include <cmath>

#include "raymarch/curves/border_match.h"
#include "raymarch/measured_border.h"
#include "raymarch/metric.h"
#include "raymarch/truth.h"
#include "samples/stability/checks/check.h"
#include "samples/stability/checks/worst.h"

namespace limn {
namespace {

struct Measured {
  BorderTruth truth{};
  BorderCurves curves{};
};

double value_of(const std::vector<MetricValue>& values, const std::string& name) {
  for (const MetricValue& value : values) {
    if (value.name == name) return value.value;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

/// The metric's number; border that is missing, or there though it should not be, counts as far off as a partner is looked for.
double displacement(const Measured& measured, const StabilityView& view, const std::string& kind, const std::string& statistic,
                    double allowed, std::string& words) {
  const Picture nothing;
  const std::string metric = kind + "_displacement";
  const auto values = find_metric(metric).measure({nothing, nothing, view.camera, &measured.curves, &measured.truth});
  double number = value_of(values, metric + "_" + statistic);
  const double missing = value_of(values, metric + "_missing"), false_border = value_of(values, metric + "_false");
  words += fmt::format("{}{}: {} {:.3g} px at ({:.1f}, {:.1f}), {:.2g} % missing, {:.2g} % false", words.empty() ? "" : "; ", kind,
                       statistic, number, value_of(values, metric + "_max_x"), value_of(values, metric + "_max_y"),
                       std::isfinite(missing) ? 100.0 * missing : 0.0, std::isfinite(false_border) ? 100.0 * false_border : 0.0);
  if (missing > allowed || false_border > allowed) return search_reach_px(view.camera);
  return std::isfinite(number) ? number : 0.0;
}

/// How far the silhouette draws back, in kr h^2 / 8: what a chord within one voxel of side h can miss.
double retreat(const Measured& measured, const StabilityView& view, double voxel, std::string& words) {
  double largest = -1e30, at_px = 0.0;
  for (const MatchedSample& sample : match_borders(measured.truth.curves, measured.curves, CurveKind::silhouette, view.camera).truth) {
    const BorderPoint& point = measured.truth.curves.curves[sample.at.curve].points[sample.at.segment];
    const std::optional<double> moved = sample.displacement_px;
    if (!sample.inside || !moved || !(point.radial_curvature > 0.0)) continue;
    const double unit = point.radial_curvature * voxel * voxel / 8.0 * pixels_per_unit_at(view.camera, point.depth);
    if (-*moved / unit > largest) largest = -*moved / unit, at_px = -*moved;
  }
  words = fmt::format("the silhouette draws back by at most {:.3g} of kr h^2/8 ({:.3g} px)", largest, at_px);
  return largest;
}

StabilityFinding run(CaseContext& context, const MethodCall*, const Parameters& with) {
  Worst worst;
  const double threshold = with.number("threshold");
  const std::string kind = with.choice("kind"), statistic = with.choice("statistic");
  for (const StabilityView& view : context.views()) {
    const StabilityStage& stage = context.stage();
    Measured measured{solve_truth(context.truth_scene(), view.camera, {.threshold = threshold}, context.how()),
                      measure_border(stage.model, view.camera, view.seen, {.threshold = threshold}, context.how())};
    std::string words;
    double number = 0.0;
    if (kind == "retreat") {
      number = retreat(measured, view, total(stage.model).voxel_size, words);
    } else {
      if (kind != "inner") number = displacement(measured, view, "silhouette", statistic, with.number("missing"), words);
      if (kind != "silhouette") number = std::max(number, displacement(measured, view, "inner", statistic, with.number("missing"), words));
    }
    const Border border = draw_border(stage, view, {&find_border_method("rim"), resolve(find_border_method("rim").parameters, {})});
    worst.see(number, words, stage, view, &border);
  }
  return worst.take();
}

}  // namespace

StabilityCheck border_within_check() {
  return {
      {"border_within", "how far the model's border lies from the true one, solved apart from any picture", "limn"},
      "px",
      false,
      {a_choice("kind", {"both", "silhouette", "inner", "retreat"}).help("which border, or how far the silhouette draws back in kr h^2/8"),
       a_choice("statistic", {"max", "p95"}).help("of its length"),
       stability_number("missing", 0.02, "", "share that may be missing, or false"), stability_number("threshold", 0.4, "", "of the rim")},
      run};
}

}  // namespace limn
