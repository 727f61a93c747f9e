#include "raymarch/lines/curvature_jumps.h"

#include <algorithm>
#include <cmath>

namespace limn {
namespace {

constexpr double kJump = 4.0;  // times as steep as beside it
constexpr double kLeastAcross = 1e-3;
constexpr double kAlong = 0.01;  // a sine: directions that differ from the faces' common line by less lie along it

/// A contour from the change on, one way or the other.
struct Arm {
  glm::dvec3 p{0.0}, tangent{0.0}, normal{0.0};  ///< The tangent leads away from the change.
  double curvature = 0.0;
  double decline = 0.0;  ///< Of the curvature's size towards the change, by length; 0 where it grows.
};

std::optional<Arm> arm_of(const CurvatureChange& change, size_t first, int way) {
  const auto& samples = change.curve.samples;
  const auto n = static_cast<std::ptrdiff_t>(samples.size());
  const auto at = [&](std::ptrdiff_t i) { return samples[static_cast<size_t>((i % n + n) % n)]; };
  const auto start = static_cast<std::ptrdiff_t>(first);
  const CurveSample a = at(start);
  // The next sample whose curvature is known.
  for (std::ptrdiff_t i = start + way, count = 0; count < 4; i += way, ++count) {
    if (!change.curve.closed && (i < 0 || i >= n)) return {};
    const CurveSample b = at(i);
    const double length = glm::distance(a.p, b.p);
    if (!std::isfinite(b.radial_curvature) || !(length > 0.0)) continue;
    return Arm{a.p, (b.p - a.p) / length, a.high, a.radial_curvature,
               std::max(0.0, std::fabs(b.radial_curvature) - std::fabs(a.radial_curvature)) / length};
  }
  return {};
}

/// S v on an arm's face: across the contour within the tangent plane, and v^T S v is the radial curvature.
std::optional<glm::dvec3> bend_along(const Arm& arm, const glm::dvec3& view) {
  const glm::dvec3 across = glm::cross(arm.normal, arm.tangent);
  const double share = glm::dot(across, view);
  if (std::fabs(share) < kLeastAcross) return {};
  return arm.curvature / share * across;
}

/// The share of the way from one arm to the other at which their tangents come nearest to each other.
double meeting_share(const Arm& back, const Arm& ahead) {
  const glm::dvec3 between = ahead.p - back.p, d = -back.tangent, e = -ahead.tangent;
  const double de = glm::dot(d, e), determinant = 1.0 - de * de;
  if (determinant < 1e-9) return 0.5;
  const double from_back = std::max(0.0, (glm::dot(between, d) - de * glm::dot(between, e)) / determinant),
               from_ahead = std::max(0.0, (de * glm::dot(between, d) - glm::dot(between, e)) / determinant);
  return from_back + from_ahead > 0.0 ? from_back / (from_back + from_ahead) : 0.5;
}

}  // namespace

std::optional<CurvatureJump> jump_at(const CurvatureChange& change) {
  const std::optional<Arm> back = arm_of(change, change.before, -1), ahead = arm_of(change, change.after, 1);
  if (!back || !ahead) return {};
  const double length = glm::distance(back->p, ahead->p);
  if (std::fabs(ahead->curvature - back->curvature) < kJump * length * std::max(back->decline, ahead->decline)) return {};
  const Arm &positive = back->curvature > 0.0 ? *back : *ahead, &negative = back->curvature > 0.0 ? *ahead : *back;
  const glm::dvec3 view = view_vector(change.camera, 0.5 * (back->p + ahead->p));
  const std::optional<glm::dvec3> one = bend_along(positive, view), other = bend_along(negative, view);
  if (!one || !other) return {};
  const glm::dvec3 across = *one - *other;
  const double share = meeting_share(*back, *ahead), sight = glm::dot(across, view), run = glm::dot(across, positive.tangent);
  if (std::min(std::fabs(sight), std::fabs(run)) < kAlong * glm::length(across)) return CurvatureJump{{}, share};
  const bool positive_in_front = (sight > 0.0) == (run > 0.0), more_on_back = positive_in_front == (&negative == &*back);
  return CurvatureJump{more_on_back ? -1 : 1, share};
}

}  // namespace limn
