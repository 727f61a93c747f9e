#include "raymarch/lines/frame_crossings.h"

#include <algorithm>
#include <optional>

#include "raymarch/lines/curve_walk.h"

namespace limn {
namespace {

constexpr int kHalvings = 40;

CurveSample on_step(const Camera& camera, const CurveSample& a, const CurveSample& b, double share) {
  CurveSample q = a;
  q.p = glm::mix(a.p, b.p, share);
  project_sample(camera, q);
  return q;
}

/// Between a share within the frame and one outside of it.
double share_between(const Camera& camera, const CurveSample& a, const CurveSample& b, double inside, double outside) {
  for (int step = 0; step < kHalvings; ++step) {
    const double t = 0.5 * (inside + outside);
    (in_frame(camera, on_step(camera, a, b, t)) ? inside : outside) = t;
  }
  return std::clamp(inside, 0.0, 1.0 - 1e-9);
}

/// The middle of what the frame cuts out of a step whose ends lie outside of it.
std::optional<double> share_within(const Camera& camera, const CurveSample& a, const CurveSample& b) {
  const double near = 1e-9 * std::max(a.depth, b.depth);
  if (!(near > 0.0)) return {};
  // The part of the step that lies before the eye.
  const double behind = (near - a.depth) / (b.depth - a.depth);
  const double start = a.depth > 0.0 ? 0.0 : behind, end = b.depth > 0.0 ? 1.0 : behind;
  const CurveSample one = on_step(camera, a, b, start), two = on_step(camera, a, b, end);
  const glm::dvec2 way = two.px - one.px, size(camera.width_px, camera.height_px);
  double low = 0.0, high = 1.0;
  for (int axis = 0; axis < 2; ++axis) {
    const double enters = -one.px[axis] / way[axis], leaves = (size[axis] - one.px[axis]) / way[axis];
    if (way[axis] == 0.0) {
      if (one.px[axis] < 0.0 || one.px[axis] > size[axis]) return {};
      continue;
    }
    low = std::max(low, std::min(enters, leaves));
    high = std::min(high, std::max(enters, leaves));
  }
  if (!(low < high)) return {};
  // Shares of the image and of the step differ in perspective, where 1 / depth is linear in the image.
  const double image = 0.5 * (low + high);
  const double share =
      camera.projection == Projection::perspective ? image * one.depth / ((1.0 - image) * two.depth + image * one.depth) : image;
  return start + share * (end - start);
}

}  // namespace

std::vector<double> frame_shares(const Camera& camera, const CurveSample& a, const CurveSample& b) {
  const bool from = in_frame(camera, a), to = in_frame(camera, b);
  if (from != to) return {share_between(camera, a, b, from ? 0.0 : 1.0, from ? 1.0 : 0.0)};
  if (from) return {};
  const std::optional<double> within = share_within(camera, a, b);
  if (!within || !in_frame(camera, on_step(camera, a, b, *within))) return {};
  return {share_between(camera, a, b, *within, 0.0), share_between(camera, a, b, *within, 1.0)};
}

}  // namespace limn
