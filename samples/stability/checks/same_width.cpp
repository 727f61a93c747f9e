// Lines are as wide in a larger picture, or under another projection of the same scale: as many pixels, or as much of the picture.

#include <numbers>

#include "raymarch/border/silhouette.h"
#include "samples/stability/checks/check.h"
#include "samples/stability/checks/worst.h"

namespace limn {
namespace {

struct Width {
  double mean_px = 0.0;
  double size = 0.0;  ///< Of the picture, in pixels.
};

/// Width of the ink beside and on the object. Of a convex silhouette of length L, a line of width w has the area w L + pi w^2 outside and
/// w L - pi w^2 inside (Steiner); grid lines cross L 4/pi times, in the mean over all directions (Cauchy and Crofton).
Width width_of(const StabilityView& view, const Border& border) {
  double outside = 0.0, inside = 0.0;
  for (size_t i = 0; i < border.coverage.size(); ++i) (view.seen.id.pixels[i] == 0 ? outside : inside) += double{border.coverage.pixels[i]};
  constexpr double pi = std::numbers::pi;
  const double length = static_cast<double>(find_silhouette(view.seen, false).crossings) * 0.25 * pi;
  const auto width = [&](double area, double sign) {
    return sign * (std::sqrt(std::max(0.0, length * length + sign * 4.0 * pi * area)) - length) / (2.0 * pi);
  };
  return {width(outside, 1.0) + width(inside, -1.0), static_cast<double>(view.camera.height_px)};
}

/// Parallel projection that is as large at the depth of the scene's middle, from as far away.
StabilityView orthographic(const StabilityStage& stage, const StabilityView& view, const ExecutionSettings& how) {
  StabilityView out = view;
  const double depth = project(view.camera, stage.model.bounds.center()).z;
  out.camera.projection = Projection::orthographic;
  out.camera.pixels_per_unit = pixels_per_unit_at(view.camera, depth);
  out.seen = render_gbuffer(stage.model, out.camera, how);
  out.words += ", orthographic";
  return out;
}

StabilityFinding run(CaseContext& context, const MethodCall* method, const Parameters& with) {
  const StabilityStage& stage = context.stage();
  const bool grows = with.flag("grows");
  std::vector<StabilityView> views = context.views();
  if (with.flag("orthographic")) {
    for (const StabilityView& view : context.views()) views.push_back(orthographic(stage, view, context.how()));
  }
  std::vector<Border> borders;
  std::vector<Width> widths;
  for (const StabilityView& view : views) {
    borders.push_back(draw_border(stage, view, *method));
    widths.push_back(width_of(view, borders.back()));
  }
  // The largest picture tells best.
  const auto reference = std::max_element(widths.begin(), widths.end(), [](const Width& a, const Width& b) { return a.size < b.size; });
  Worst worst;
  for (size_t i = 0; i < views.size(); ++i) {
    const double wanted = reference->mean_px * (grows ? widths[i].size / reference->size : 1.0);
    worst.see(wanted > 0.0 ? std::abs(widths[i].mean_px - wanted) : 1e3,
              fmt::format("lines {:.2f} px wide in the mean, {:.2f} px expected", widths[i].mean_px, wanted), stage, views[i], &borders[i]);
  }
  return worst.take();
}

}  // namespace

StabilityCheck same_width_check() {
  return {{"same_width", "how much the mean width of lines differs between pictures of several sizes, or between projections of one scale",
           "limn"},
          "px",
          true,
          {a_flag("grows", false).help("with the picture: the width is part of the scene, not of the page"),
           a_flag("orthographic", false).help("the same views in parallel projection too")},
          run};
}

}  // namespace limn
