#include "raymarch/lines/field_layers.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "raymarch/analytic/clip_ray.h"
#include "sdf/field_program.h"

namespace limn {
namespace {

constexpr double kLift = 1e-8;  // of the extent: far above rounding, some millionths of a pixel
// A ray leaves a crease along itself, and where a face is nearly edge-on it leaves that face a thousand times more slowly: it has to get
// beyond what faces that coincide are moved apart by (SharpField::epsilon).
constexpr double kCreaseLift = 1e-6;
constexpr double kChordLift_px = 0.02;
constexpr double kResolution = 1e-10;
constexpr size_t kLongProgram = 12;   // instructions: longer ones are shortened for parts of a ray
constexpr double kShortenFrom = 1e5;  // resolutions: on shorter stretches nothing is left to leave out

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
  const bool clear = fa > 0.0 ? positive_between(fa, fb, length, bounds.slope)
                              : positive_between(-fa, -fb, length, {-bounds.slope.upper, -bounds.slope.lower});
  return clear ? std::optional<int>(0) : std::nullopt;
}

/// Sign changes on a stretch of the ray, at whose ends f is known; with a program shortened for the stretch where it is long.
struct RayWalk {
  const glm::dvec3 &origin, &direction;
  double lipschitz, resolution;

  int count(FieldEvaluator& evaluator, double t0, double f0, double t1, double f1) const {
    const double length = t1 - t0;
    // f cannot reach zero between the ends, as steep as it is.
    if ((f0 > 0.0) == (f1 > 0.0) && std::fabs(f0) + std::fabs(f1) > lipschitz * length) return 0;
    RayBounds bounds = evaluator.bounds_along(origin, direction, {t0, t1});
    bounds.slope.lower = std::max(bounds.slope.lower, -lipschitz);
    bounds.slope.upper = std::min(bounds.slope.upper, lipschitz);
    if (const std::optional<int> roots = roots_on(f0, f1, length, bounds)) return *roots;
    if (length <= resolution) return (f0 > 0.0) != (f1 > 0.0) ? 1 : 0;
    const double t = 0.5 * (t0 + t1);
    const glm::dvec3 middle = origin + t * direction;
    const double f = evaluator.value(middle);
    if (evaluator.field().program().instructions.size() < kLongProgram || length < kShortenFrom * resolution)
      return count(evaluator, t0, f0, t, f) + count(evaluator, t, f, t1, f1);
    const auto half = [&](double from, double at_from, double to, double at_to) {
      const Box box = include(include(Box{}, origin + from * direction), origin + to * direction);
      FieldEvaluator shorter(evaluator.restricted(box));
      return count(shorter, from, at_from, to, at_to);
    };
    return half(t0, f0, t, f) + half(t, f, t1, f1);
  }
};

}  // namespace

LayerRay layer_ray(const Camera& camera, double extent, const CurveSample& sample) {
  // A point on a chord lies off the curve: the ray starts so much farther off the surface.
  const double chord_lift = sample.on_chord ? kChordLift_px / pixels_per_unit_at(camera, std::max(sample.depth, 1e-9)) : 0.0;
  const double lift = std::isnan(sample.radial_curvature) ? kCreaseLift : kLift;
  LayerRay ray;
  ray.origin = sample.p + std::max(lift * extent, chord_lift) * sample.lift;
  const bool perspective = camera.projection == Projection::perspective;
  ray.end = perspective ? glm::distance(camera.eye, ray.origin) : project(camera, ray.origin).z;
  ray.direction = perspective ? (camera.eye - ray.origin) / ray.end : camera.world_from_camera[2];
  return ray;
}

FieldLayers::FieldLayers(const std::vector<Field>& bodies, const Camera& camera, double extent) : camera_(camera), extent_(extent) {
  for (const Field& field : bodies) {
    Body body{field, field.traits().bounds, field.traits().lipschitz};
    if (!body.clip.empty()) body.clip = dilate(body.clip, 1e-3 * extent);
    bodies_.push_back(std::move(body));
  }
}

int FieldLayers::before(const CurveSample& sample) const {
  const auto [origin, direction, end] = layer_ray(camera_, extent_, sample);
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
  const RayWalk walk{origin, direction, body.lipschitz, kResolution * extent_};
  return walk.count(evaluator, t, evaluator.value(origin + t * direction), t_end, evaluator.value(origin + t_end * direction));
}

}  // namespace limn
