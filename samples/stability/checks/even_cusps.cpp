// Cusps of a contour in the image: where the radial curvature is 0. A closed contour has an even number of them.

#include "samples/stability/checks/check.h"
#include "samples/stability/checks/contour_curves.h"
#include "samples/stability/checks/worst.h"

namespace limn {
namespace {

constexpr double kTail_px = 1e-4;  // a swallowtail's tail shorter than this may lie between two points of the contour
constexpr double kAcross = 0.1;    // of the steps before and after it: one so short may go straight across the tip of a cusp

struct Cusps {
  int of_curvature = 0;  ///< Changes of the radial curvature's sign.
  int of_image = 0;      ///< Turns of the image curve back on itself.
  int tails = 0;         ///< Stretches between two such changes that are too short in the image for its points to turn back.
};

/// Where along the contour the radial curvature is 0, between two points of different sign; px from the first point.
std::vector<double> zeros_of_curvature(const WholeContour& contour) {
  std::vector<double> zeros;
  const size_t count = contour.points.size();
  double along_px = 0.0;
  for (size_t i = 0; i < count; ++i) {
    const double a = contour.points[i].radial_curvature, b = contour.points[(i + 1) % count].radial_curvature;
    const double step_px = glm::distance(contour.points[i].px, contour.points[(i + 1) % count].px);
    if ((a > 0.0) != (b > 0.0)) zeros.push_back(along_px + step_px * a / (a - b));
    along_px += step_px;
  }
  if (!zeros.empty()) zeros.push_back(zeros.front() + along_px);
  return zeros;
}

/// In the image. Beside a cusp the curve is (t^2, t^3): a step from -t to t is perpendicular to both ways there, and tells of no turn.
std::vector<glm::dvec2> telling_steps(const WholeContour& contour) {
  std::vector<glm::dvec2> steps;
  const size_t count = contour.points.size();
  for (size_t i = 0; i < count; ++i) {
    const glm::dvec2 step = contour.points[(i + 1) % count].px - contour.points[i].px;
    if (glm::length(step) > 0.0) steps.push_back(step);
  }
  std::vector<glm::dvec2> telling;
  for (size_t i = 0; i < steps.size(); ++i) {
    const double before = glm::length(steps[(i + steps.size() - 1) % steps.size()]), after = glm::length(steps[(i + 1) % steps.size()]);
    if (glm::length(steps[i]) >= kAcross * std::min(before, after)) telling.push_back(steps[i]);
  }
  return telling;
}

Cusps count_cusps(const WholeContour& contour) {
  Cusps cusps;
  const std::vector<double> zeros = zeros_of_curvature(contour);
  for (size_t i = 0; i + 1 < zeros.size(); ++i) {
    ++cusps.of_curvature;
    cusps.tails += zeros[i + 1] - zeros[i] < kTail_px;
  }
  const std::vector<glm::dvec2> steps = telling_steps(contour);
  for (size_t i = 0; i < steps.size(); ++i) cusps.of_image += glm::dot(steps[i], steps[(i + 1) % steps.size()]) < 0.0;
  return cusps;
}

/// An even number in the image, and that of the curvature's zeros but for tails that the image cannot show.
bool agree(const Cusps& cusps) {
  const int unseen = cusps.of_curvature - cusps.of_image;
  return cusps.of_image % 2 == 0 && cusps.of_curvature % 2 == 0 && unseen >= 0 && unseen <= 2 * cusps.tails;
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
      wrong += !agree(found);
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
