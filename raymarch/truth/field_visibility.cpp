#include "raymarch/truth/field_visibility.h"

#include <algorithm>
#include <cmath>

#include "raymarch/analytic/clip_ray.h"
#include "sdf/field_program.h"

namespace limn {
namespace {

// How far off the surface rays start, as a share of the scene's radius: far above rounding, and in the image some millionths of a pixel.
constexpr double kLift = 1e-8;
constexpr double kResolution = 1e-10;
constexpr double kSphereStep = 0.02;  // of the extent: farther out a step |f| / L is cheaper than bounds
constexpr int kMostSteps = 100'000;
constexpr size_t kLargeProgram = 64;  // instructions, from which on a field is shortened for the segment that is left
constexpr int kFewSteps = 3;          // that most rays end within

/// f > 0 between two places where it is fa and fb, as its slope has bounds (Piyavskii 1972).
bool positive_between(double fa, double fb, double length, const Interval& slope) {
  if (slope.lower >= 0.0) return fa > 0.0;
  if (slope.upper <= 0.0) return fb > 0.0;
  const double x = std::clamp((slope.upper * length - fb + fa) / (slope.upper - slope.lower), 0.0, length);
  return fa + slope.lower * x > 0.0;
}

}  // namespace

FieldOccluders::FieldOccluders(const std::vector<Field>& fields, const Camera& camera, double extent) : camera_(camera), extent_(extent) {
  for (const Field& field : fields) {
    const FieldTraits& traits = field.traits();
    Occluder occluder{field, traits.bounds, traits.lipschitz};
    if (!traits.bounds.empty()) occluder.clip = dilate(traits.bounds, 1e-3 * extent);
    occluders_.push_back(std::move(occluder));
  }
}

std::vector<FieldEvaluator>& FieldOccluders::evaluators() const {
  auto& mine = evaluators_.local();
  if (mine.empty()) {
    for (const Occluder& occluder : occluders_) mine.emplace_back(occluder.field);
  }
  return mine;
}

bool FieldOccluders::blocked(const TracedPoint& point, std::optional<size_t> own) const {
  const glm::dvec3 origin = point.p + kLift * extent_ * point.lift;
  const bool perspective = camera_.projection == Projection::perspective;
  const double end = perspective ? glm::distance(camera_.eye, origin) : project(camera_, origin).z;
  const glm::dvec3 direction = perspective ? (camera_.eye - origin) / end : camera_.world_from_camera[2];
  auto& evaluators = this->evaluators();
  // The object itself hides most of what is hidden.
  if (own && blocks(evaluators[*own], occluders_[*own], origin, direction, end)) return true;
  for (size_t i = 0; i < occluders_.size(); ++i) {
    if (own != i && blocks(evaluators[i], occluders_[i], origin, direction, end)) return true;
  }
  return false;
}

bool FieldOccluders::blocks(FieldEvaluator& whole, const Occluder& occluder, const glm::dvec3& origin, const glm::dvec3& direction,
                            double end) const {
  double t = 0.0, t_end = end;
  if (occluder.clip.empty() || !clip_ray(occluder.clip, origin, direction, t, t_end)) return false;
  std::optional<FieldEvaluator> shortened;
  const auto evaluator = [&]() -> FieldEvaluator& { return shortened ? *shortened : whole; };
  const auto value_at = [&](double at) { return evaluator().value(origin + at * direction); };
  const bool large = occluder.field.program().instructions.size() >= kLargeProgram;
  double f = value_at(t);
  double length = 0.0;
  for (int step = 0; step < kMostSteps && t < t_end; ++step) {
    if (!(f > 0.0)) return true;
    if (large && step == kFewSteps) {
      const Box left = include(include(Box{}, origin + t * direction), origin + t_end * direction);
      shortened.emplace(whole.restricted(dilate(left, kLift * extent_)));
    }
    if (const double advance = f / occluder.lipschitz; advance > kSphereStep * extent_) {
      t += advance * (1.0 - 1e-12);
      if (t >= t_end) return false;
      f = value_at(t);
      length = 0.0;
      continue;
    }
    length = std::max({length, 4.0 * f / occluder.lipschitz, kResolution * extent_});
    double stretch = std::min(length, t_end - t);
    for (;;) {
      const double f_end = value_at(t + stretch);
      if (!(f_end > 0.0)) return true;
      RayBounds bounds = evaluator().bounds_along(origin, direction, {t, t + stretch});
      bounds.slope.lower = std::max(bounds.slope.lower, -occluder.lipschitz);
      bounds.slope.upper = std::min(bounds.slope.upper, occluder.lipschitz);
      if (stretch <= kResolution * extent_ || bounds.value.lower > 0.0 || positive_between(f, f_end, stretch, bounds.slope)) {
        t += stretch;
        f = f_end;
        length = 2.0 * stretch;
        break;
      }
      stretch *= 0.5;
    }
  }
  return false;
}

double FieldOccluders::others(const glm::dvec3& p, std::optional<size_t> own) const {
  auto& evaluators = this->evaluators();
  double least = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < evaluators.size(); ++i) {
    if (own != i) least = std::min(least, evaluators[i].value(p));
  }
  return least;
}

}  // namespace limn
