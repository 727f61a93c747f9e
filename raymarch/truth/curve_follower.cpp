#include "raymarch/truth/curve_follower.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sdf/segment.h"

namespace limn {
namespace {

constexpr double kFirstStep = 0.25;   // of the longest one
constexpr double kLeastStep = 1e-5;   // of the longest one
constexpr double kSagitta = 0.3;      // of the tolerance
constexpr double kCorrection = 0.05;  // of a step, by which the prediction may be off
constexpr double kClosing = 0.15;     // of a step: so near it the start is the end
constexpr double kTurn = 0.95;        // the cosine of the angle between tangents, and between normals, along a step
constexpr double kLongest_px = 1.0;
constexpr double kPolished = 0.03;      // of the reach of Newton's iteration, whose error is squared with each step
constexpr double kSeedPolished = 1e-4;  // the same of seeds
constexpr double kAim = 0.9;            // of the longest step within all bounds, as far as the last one tells
constexpr double kMostGrowth = 2.0, kMostShrinking = 0.1;
constexpr double kClose = 1e-3;         // of the reach of Newton's iteration, where only whether it converges is asked
constexpr double kLeastTurning = 1e-3;  // of the longest step: shorter ones are not searched for turns of the image
constexpr double kLeastLooked = 0.25;   // of the longest step: along shorter ones nobody looks
constexpr std::array<double, 3> kLookedAt = {0.5, 0.25, 0.75};
constexpr double kMostAside = 0.05;        // of a step's length, that points along it may lie off the cubic through its ends
constexpr size_t kFirstMark = 64;          // points
constexpr size_t kMostPoints = 2'000'000;  // of a curve
constexpr size_t kAskedEvery = 64;         // points, whether anybody else has followed the curve

glm::dvec3 tangent_of(const CurvePoint& point) { return glm::normalize(glm::cross(point.high, point.uphill)); }

/// Where chords meet, a point of the curve may lie beside the end of the one and before the beginning of the other.
bool passes(const CurvePoint& from, const CurvePoint& to, const glm::dvec3& tangent, const CurvePoint& point) {
  const glm::dvec3 way = to.p - from.p;
  const double length = glm::length(way), along = glm::dot(point.p - from.p, way) / length;
  return along > -kClosing * length && along <= length && distance_to_segment(point.p, from.p, to.p) < kClosing * length &&
         glm::dot(tangent, tangent_of(point)) > 0.5;
}

}  // namespace

/// A point that a path comes to.
struct CurveFollower::Ahead {
  CurvePoint point{};
  glm::dvec3 tangent{0.0};
  glm::dvec2 image_way{0.0};  ///< The tangent's image, px.
};

/// Where a path leads: its tangent as the parabola through the last three of them.
struct CurveFollower::Course {
  Course(const glm::dvec3& from, const glm::dvec2& image) : tangent(from), image_way(image) {}

  void go(const Ahead& next, double length) {
    const glm::dvec3& to = next.tangent;
    const glm::dvec3 slope = (to - tangent) / length;  // half a step ago
    bend_change = last_length > 0.0 ? (slope - last_slope) / (last_length + length) : glm::dvec3(0.0);
    bend = slope + length * bend_change;
    tangent = to, image_way = next.image_way, last_slope = slope, last_length = length;
  }
  glm::dvec3 way(double step) const { return step * (tangent + step * (bend / 2.0 + step / 3.0 * bend_change)); }

  glm::dvec3 tangent{0.0}, bend{0.0}, bend_change{0.0}, last_slope{0.0};
  glm::dvec2 image_way{0.0};
  double last_length = 0.0;  ///< 0: there was no step.
};

std::optional<CurvePoint> CurveFollower::seed(const CurvePoint& point, double reach) {
  return polish(evaluator_, viewer_, c_, point.p, reach * settings_.longest_step, kSeedPolished);
}

std::optional<std::vector<CurvePoint>> CurveFollower::around(const CurvePoint& start, const std::function<bool()>& stop) {
  for (const double share : {1.0, 0.25, 0.0625}) {
    bool stopped = false;
    const auto stops = [&] { return stopped = stop(); };
    auto path = around_in_steps(start, share * settings_.longest_step, stops);
    if (path || stopped) return path;
  }
  return {};
}

glm::dvec2 CurveFollower::image_way(const glm::dvec3& p, const glm::dvec3& way) const {
  const glm::dvec3 at = (p - camera_.eye) * camera_.world_from_camera, along = way * camera_.world_from_camera;
  const double scale = pixels_per_unit_at(camera_, -at.z), nearing = camera_.projection == Projection::perspective ? along.z / -at.z : 0.0;
  return scale * glm::dvec2(along.x + nearing * at.x, -along.y - nearing * at.y);
}

std::optional<std::vector<CurvePoint>> CurveFollower::around_in_steps(const CurvePoint& start, double longest,
                                                                      const std::function<bool()>& stop) {
  std::vector<CurvePoint> path{start};
  Course course(tangent_of(start), image_way(start.p, tangent_of(start)));
  double step = kFirstStep * longest;
  size_t mark = 0;
  while (path.size() < kMostPoints) {
    if (path.size() % kAskedEvery == 0 && stop()) return {};
    const CurvePoint from = path.back();
    const std::optional<Ahead> next = advance(from, course, longest, step);
    if (!next) return {};
    const CurvePoint& to = next->point;
    const glm::dvec3 way = to.p - from.p;
    if (path.size() > 2 && passes(from, to, course.tangent, start)) {
      if (glm::dot(start.p - from.p, way) <= 0.0) path.pop_back();
      return path;
    }
    // Where it comes by a later point again it goes in circles beside its start (Brent 1980, "An improved Monte Carlo factorization
    // algorithm", has the marks).
    if (mark > 0 && path.size() > mark + 2 && passes(from, to, course.tangent, path[mark])) return {};
    if (path.size() >= std::max(kFirstMark, 2 * mark)) mark = path.size() - 1;
    course.go(*next, glm::length(way));
    path.push_back(to);
  }
  return {};
}

bool CurveFollower::turns_twice(const glm::dvec3& from, const glm::dvec3& to, const glm::dvec2& start, const glm::dvec2& end,
                                double step) const {
  const double speed = glm::length(start);
  if (!(speed > 0.0)) return false;
  const double last = glm::dot(end, start) / speed,
               mean = glm::dot(glm::dvec2(project(camera_, to) - project(camera_, from)), start) / (speed * step),
               bend = 3.0 * (speed + last) - 6.0 * mean, slope = last - speed - bend;
  return last > 0.0 && slope < 0.0 && slope > -2.0 * bend && 4.0 * bend * speed < slope * slope;
}

bool CurveFollower::leaves_cubic(const glm::dvec3& from, const glm::dvec3& to, const glm::dvec3& start, const glm::dvec3& end) {
  const double length = glm::distance(from, to);
  return std::any_of(kLookedAt.begin(), kLookedAt.end(), [&](double t) {
    const double rest = 1.0 - t;
    const glm::dvec3 between =
        rest * rest * (1.0 + 2.0 * t) * from + t * t * (1.0 + 2.0 * rest) * to + length * t * rest * (rest * start - t * end);
    return !polish(evaluator_, viewer_, c_, between, kMostAside * length, kClose);
  });
}

double CurveFollower::fitting_share(const CurvePoint& from, const Course& course, double step, const Ahead& to) const {
  const glm::dvec2 &image_from = course.image_way, &image_to = to.image_way;
  const double off = glm::distance(to.point.p, from.p + course.way(step)),
               bend = 1.0 - std::min(glm::dot(to.tangent, course.tangent), glm::dot(to.point.high, from.high)),
               turn = std::atan2(image_from.x * image_to.y - image_from.y * image_to.x, glm::dot(image_from, image_to)),
               sagitta = 0.5 * (glm::length(image_from) + glm::length(image_to)) * step * std::fabs(turn) / 8.0;
  // The error of a prediction by a cubic grows with the fourth power of the step, the others with its square.
  constexpr double kNone = 1e-300;
  return std::min({std::cbrt(kCorrection * step / std::max(off, kNone)), std::sqrt((1.0 - kTurn) / std::max(bend, kNone)),
                   std::sqrt(kSagitta * settings_.tolerance_px / std::max(sagitta, kNone))});
}

bool CurveFollower::goes_round(const CurvePoint& from, const Course& course, double step, const Ahead& to) {
  return (step > kLeastTurning * settings_.longest_step && turns_twice(from.p, to.point.p, course.image_way, to.image_way, step)) ||
         (step > kLeastLooked * settings_.longest_step && leaves_cubic(from.p, to.point.p, course.tangent, to.tangent));
}

std::optional<CurveFollower::Ahead> CurveFollower::advance(const CurvePoint& from, const Course& course, double longest, double& step) {
  const double scale = pixels_per_unit_at(camera_, std::max(project(camera_, from.p).z, 1e-9));
  step = std::min({step, longest, kLongest_px / scale});
  while (step > kLeastStep * settings_.longest_step) {
    const std::optional<CurvePoint> point = polish(evaluator_, viewer_, c_, from.p + course.way(step), kCorrection * step, kPolished);
    if (!point) {
      step *= 0.5;
      continue;
    }
    const glm::dvec3 tangent = tangent_of(*point);
    const Ahead to{*point, tangent, image_way(point->p, tangent)};
    const double fitting = fitting_share(from, course, step, to);
    if (!(fitting >= 1.0)) {
      step *= std::clamp(kAim * fitting, kMostShrinking, kAim);
    } else if (goes_round(from, course, step, to)) {
      step *= 0.5;
    } else {
      step *= std::min(kAim * fitting, kMostGrowth);
      return to;
    }
  }
  return {};
}

}  // namespace limn
