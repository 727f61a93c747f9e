// Ink along the contour is no wider than was asked for, wherever the curvature goes.

#include "raymarch/curves/curve_geometry.h"
#include "raymarch/measured_border.h"
#include "samples/stability/checks/check.h"
#include "samples/stability/checks/contour_curves.h"
#include "samples/stability/checks/worst.h"

namespace limn {
namespace {

constexpr double kReach_px = 100.0;

/// The true contours where the scene is made of fields, hidden ones too: ink may show beside them. Else what the model shows.
BorderCurves contours_of(CaseContext& context, const StabilityView& view) {
  const Scene& scene = context.truth_scene();
  if (!std::holds_alternative<Field>(scene.objects.front().source))
    return measure_border(context.stage().model, view.camera, view.seen, {.threshold = 0.0}, context.how());
  BorderCurves curves;
  for (const WholeContour& contour : whole_contours(scene, view.camera, context.how())) {
    BorderCurve curve{CurveKind::silhouette, 1, contour.closed, {}};
    for (const WholeContour::Point& point : contour.points) {
      curve.points.emplace_back();
      curve.points.back().px = point.px;
    }
    curves.curves.push_back(std::move(curve));
  }
  return curves;
}

StabilityFinding run(CaseContext& context, const MethodCall* method, const Parameters& with) {
  Worst worst;
  for (const StabilityView& view : context.views()) {
    const Border border = draw_border(context.stage(), view, *method);
    const BorderCurves curves = contours_of(context, view);
    const CurveIndex index(curves, CurveKind::silhouette);
    double widest = 0.0;
    glm::ivec2 at(0);
    std::int64_t inked = 0;
    for (int y = 0; y < view.seen.height; ++y) {
      for (int x = 0; x < view.seen.width; ++x) {
        if (!(border.coverage.at(x, y) > 0.5f)) continue;
        ++inked;
        const auto nearest = index.nearest({x + 0.5, y + 0.5}, 0, kReach_px);
        const double distance = nearest ? nearest->distance_px : kReach_px;
        if (distance > widest) widest = distance, at = {x, y};
      }
    }
    const bool none = inked == 0;
    worst.see(none ? kReach_px : widest - with.number("width"),
              none ? "no ink at all"
                   : fmt::format("{} pixels of ink, the farthest {:.2f} px from the contour at ({}, {})", inked, widest, at.x, at.y),
              context.stage(), view, &border);
  }
  return worst.take();
}

}  // namespace

StabilityCheck width_within_check() {
  return {{"width_within", "how much farther from the contour ink lies than it should be wide", "limn"},
          "px",
          true,
          {stability_number("width", 3.0, "px", "that the method was asked for")},
          run};
}

}  // namespace limn
