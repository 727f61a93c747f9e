#include "raymarch/lines/field_layers.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "raymarch/analytic/clip_ray.h"

namespace limn {
namespace {

constexpr double kLift = 1e-8;  // of the extent: far above rounding, some millionths of a pixel
constexpr double kChordLift_px = 0.02;
constexpr double kResolution = 1e-10;
constexpr double kSphereStep = 0.02;  // of the extent: farther out a step |f| / L is cheaper than bounds
constexpr int kMostSteps = 100'000;

/// f > 0 between two places where it is fa and fb, as its slope has bounds (Piyavskii 1972).
bool positive_between(double fa, double fb, double length, const Interval& slope) {
  const double x = std::clamp((slope.upper * length - fb + fa) / (slope.upper - slope.lower), 0.0, length);
  return fa + slope.lower * x > 0.0;
}

/// How many roots lie on a stretch, if that is settled: none, or one where f runs one way.
std::optional<int> roots_on(double fa, double fb, double length, const RayBounds& bounds) {
  if (bounds.value.lower > 0.0 || bounds.value.upper < 0.0) return 0;
  const bool differ = (fa > 0.0) != (fb > 0.0);
  if (bounds.slope.lower >= 0.0 || bounds.slope.upper <= 0.0) return differ ? 1 : 0;
  if (differ) return std::nullopt;
  const bool clear =
      fa > 0.0 ? positive_between(fa, fb, length, bounds.slope) : positive_between(-fa, -fb, length, {-bounds.slope.upper, -bounds.slope.lower});
  return clear ? std::optional<int>(0) : std::nullopt;
}

}  // namespace

FieldLayers::FieldLayers(const std::vector<Field>& bodies, const Camera& camera, double extent) : camera_(camera), extent_(extent) {
  for (const Field& field : bodies) {
    Body body{field, field.traits().bounds, field.traits().lipschitz};
    if (!body.clip.empty()) body.clip = dilate(body.clip, 1e-3 * extent);
    bodies_.push_back(std::move(body));
  }
}

int FieldLayers::before(const CurveSample& sample) const {
  // A point on a chord lies off the curve: the ray starts so much farther off the surface.
  const double chord_lift = sample.on_chord ? kChordLift_px / pixels_per_unit_at(camera_, std::max(sample.depth, 1e-9)) : 0.0;
  const glm::dvec3 origin = sample.p + std::max(kLift * extent_, chord_lift) * sample.lift;
  const bool perspective = camera_.projection == Projection::perspective;
  const double end = perspective ? glm::distance(camera_.eye, origin) : project(camera_, origin).z;
  const glm::dvec3 direction = perspective ? (camera_.eye - origin) / end : camera_.world_from_camera[2];
  auto& evaluators = evaluators_.local();
  if (evaluators.empty()) {
    for (const Body& body : bodies_) evaluators.emplace_back(body.field);
  }
  int layers = 0;
  for (size_t i = 0; i < bodies_.size(); ++i) layers += sign_changes(evaluators[i], bodies_[i], origin, direction, end);
  return layers;
}

int FieldLayers::sign_changes(FieldEvaluator& evaluator, const Body& body, const glm::dvec3& origin, const glm::dvec3& direction,
                              double end) const {
  double t = 0.0, t_end = end;
  if (body.clip.empty() || !clip_ray(body.clip, origin, direction, t, t_end)) return 0;
  const auto value_at = [&](double at) { return evaluator.value(origin + at * direction); };
  double f = value_at(t), length = 0.0;
  int roots = 0;
  for (int step = 0; step < kMostSteps && t < t_end; ++step) {
    const double apart = std::fabs(f) / body.lipschitz;
    if (apart > kSphereStep * extent_) {
      t += apart * (1.0 - 1e-12);
      if (t >= t_end) break;
      f = value_at(t);
      length = 0.0;
      continue;
    }
    length = std::max({length, 4.0 * apart, kResolution * extent_});
    double stretch = std::min(length, t_end - t);
    for (;;) {
      const double f_end = value_at(t + stretch);
      RayBounds bounds = evaluator.bounds_along(origin, direction, {t, t + stretch});
      bounds.slope.lower = std::max(bounds.slope.lower, -body.lipschitz);
      bounds.slope.upper = std::min(bounds.slope.upper, body.lipschitz);
      std::optional<int> here = roots_on(f, f_end, stretch, bounds);
      if (!here && stretch <= kResolution * extent_) here = (f > 0.0) != (f_end > 0.0) ? 1 : 0;
      if (here) {
        roots += *here;
        t += stretch;
        f = f_end;
        length = 2.0 * stretch;
        break;
      }
      stretch *= 0.5;
    }
  }
  return roots;
}

}  // namespace limn
