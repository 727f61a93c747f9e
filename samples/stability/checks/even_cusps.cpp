// Cusps of a contour in the image: where the radial curvature is 0. A closed contour has an even number of them.

#include "samples/stability/checks/check.h"
#include "samples/stability/checks/contour_curves.h"
#include "samples/stability/checks/worst.h"

namespace limn {
namespace {

struct Cusps {
  int of_curvature = 0;  ///< Changes of the radial curvature's sign.
  int of_image = 0;      ///< Turns of the image curve back on itself.
};

Cusps count_cusps(const WholeContour& contour) {
  Cusps cusps;
  const size_t count = contour.points.size();
  const auto sign = [&](size_t i) { return contour.points[i % count].radial_curvature > 0.0; };
  std::vector<glm::dvec2> steps;
  for (size_t i = 0; i < count; ++i) {
    cusps.of_curvature += sign(i) != sign(i + 1);
    const glm::dvec2 step = contour.points[(i + 1) % count].px - contour.points[i].px;
    if (glm::length(step) > 0.0) steps.push_back(step);
  }
  for (size_t i = 0; i < steps.size(); ++i) cusps.of_image += glm::dot(steps[i], steps[(i + 1) % steps.size()]) < 0.0;
  return cusps;
}

StabilityFinding run(CaseContext& context, const MethodCall*, const Parameters&) {
  Worst worst;
  for (const StabilityView& view : context.views()) {
    int wrong = 0, closed = 0, cusps = 0, open = 0;
    for (const WholeContour& contour : whole_contours(context.truth_scene(), view.camera, context.how())) {
      open += !contour.closed;
      if (!contour.closed) continue;
      const Cusps found = count_cusps(contour);
      ++closed;
      cusps += found.of_image;
      wrong += found.of_image % 2 != 0 || found.of_image != found.of_curvature;
    }
    worst.see(
        wrong + open + (closed == 0),
        fmt::format("{} closed contours with {} cusps, {} of them with a count that is odd or not that of the curvature's zeros; {} open",
                    closed, cusps, wrong, open),
        context.stage(), view);
  }
  return worst.take();
}

}  // namespace

StabilityCheck even_cusps_check() {
  return {{"even_cusps",
           "contours with an odd number of cusps, or one other than that of the radial curvature's zeros; open ones; none at all", "limn"},
          "contours",
          false,
          {},
          run};
}

}  // namespace limn
