// The field itself. Three stages, each proven not to step over a root: sphere tracing over the whole batch through empty space,
// interval isolation of the first root of each ray, and safeguarded Newton iteration over the batch again.

#include <tbb/enumerable_thread_specific.h>

#include <array>
#include <chrono>

#include "raymarch/curvature.h"
#include "raymarch/surface/offset.h"
#include "raymarch/surface/registry.h"
#include "sdf/error.h"

namespace limn {
namespace {

// Outside this share of the extent a step |f|/L is cheaper than an interval; inside it intervals converge faster.
constexpr double kIsolationDistance = 0.02;
constexpr int kMaxSphereSteps = 64;
// Stretches are not cut below this share of the extent: whether a ray touches within it is decided by the sign of f at the ends.
constexpr double kResolution = 1e-10;
// Rounding noise of f, as a share of Lipschitz constant times extent.
constexpr double kNoise = 1e-13;
constexpr double kRootTolerance = 1e-12;
// Directions are unit to float precision only.
constexpr double kDirectionSlack = 1.0 + 1e-6;

struct AnalyticState {
  AnalyticState(Field render_field, int max) : field(std::move(render_field)), max_steps(max), evaluators(field) {
    const FieldTraits& traits = field.traits();
    if (traits.bounds.empty()) clip = {};
    bounded = traits.bounds.finite();
    extent = bounded ? traits.bounds.radius() : 0.0;
    // Flat faces lie in the bounds: starting beyond them tells outside from inside. Bounds that are open on a side give no measure
    // of "beyond".
    if (bounded) clip = dilate(traits.bounds, 1e-3 * extent);
    lipschitz = traits.lipschitz * kDirectionSlack;
  }
  Field field;
  Box clip{glm::dvec3(-std::numeric_limits<double>::infinity()), glm::dvec3(std::numeric_limits<double>::infinity())};
  bool bounded = false;
  double extent = 0.0;
  double lipschitz = 1.0;
  int max_steps;
  mutable tbb::enumerable_thread_specific<FieldEvaluator> evaluators;
};

/// One ray on its way. `sign` turns f so that it is positive where the ray starts; `f` is the turned value at `t`.
struct Lane {
  int index = 0;
  int steps = 0;
  glm::dvec3 origin{0.0}, direction{0.0};
  double t = 0.0, t_end = 0.0;
  double sign = 0.0, f = 0.0;
  double extent = 0.0;
  // The root's bracket, and Newton's state.
  double a = 0.0, b = 0.0, step = 0.0;
  glm::dvec3 point() const { return origin + t * direction; }
};

struct Scratch {
  std::array<Lane, kRayBatchSize> lanes, found;
  std::array<glm::dvec3, kRayBatchSize> points, gradients;
  std::array<double, kRayBatchSize> values;
  int active = 0, found_count = 0;
};

bool clip_ray(const Box& box, const glm::dvec3& origin, const glm::dvec3& direction, double& t0, double& t1) {
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0) {
      if (origin[axis] < box.lower[axis] || origin[axis] > box.upper[axis]) return false;
      continue;
    }
    const double inverse = 1.0 / direction[axis];
    const double u = (box.lower[axis] - origin[axis]) * inverse, v = (box.upper[axis] - origin[axis]) * inverse;
    t0 = std::max(t0, std::min(u, v));
    t1 = std::min(t1, std::max(u, v));
  }
  return t0 < t1;
}

int start_lanes(const AnalyticState& state, const RayBatch& rays, Scratch& scratch) {
  int count = 0;
  for (int i = 0; i < rays.count; ++i) {
    const glm::dvec3 origin(rays.origin(i)), direction(rays.direction(i));
    double t0 = rays.t_min[i], t1 = rays.t_max[i];
    if (!(t0 < t1) || !clip_ray(state.clip, origin, direction, t0, t1)) continue;
    Lane& lane = scratch.lanes[static_cast<size_t>(count++)];
    lane = {};
    lane.index = i;
    lane.origin = origin;
    lane.direction = direction;
    lane.t = t0;
    lane.t_end = t1;
    lane.extent = state.bounded ? state.extent : std::max(glm::length(origin), 1e-5 * (t1 - t0));
  }
  return count;
}

void write_out_of_steps(const Lane& lane, HitBatch& hits) {
  hits.status[lane.index] = HitStatus::out_of_steps;
  hits.t[lane.index] = static_cast<float>(lane.t);
  hits.face[lane.index] = -1;
  hits.material[lane.index] = 0;
}

enum class Isolation { bracket, miss, out_of_steps };

/// Bounds of the turned function on [t, t + length]: Lipschitz constant and interval arithmetic, whichever is tighter.
RayBounds turned_bounds(FieldEvaluator& evaluator, const Lane& lane, double end, double lipschitz) {
  const RayBounds raw = evaluator.bounds_along(lane.origin, lane.direction, {lane.t, end});
  RayBounds turned = raw;
  if (lane.sign < 0.0) turned = {{-raw.value.upper, -raw.value.lower}, {-raw.slope.upper, -raw.slope.lower}};
  // The comparisons are false for NaN, which then bounds nothing.
  if (!(turned.slope.lower > -lipschitz)) turned.slope.lower = -lipschitz;
  if (!(turned.slope.upper < lipschitz)) turned.slope.upper = lipschitz;
  return turned;
}

/// True where f > 0 on the whole stretch: f lies above the line that falls from fa with the steepest slope and above the one that
/// rises to fb with it (the piecewise-linear bound of Lipschitz optimisation, Piyavskii 1972, with one constant for each side).
bool positive_between(double fa, double fb, double length, const Interval& slope) {
  if (slope.lower >= 0.0) return fa > 0.0;
  if (slope.upper <= 0.0) return fb > 0.0;
  const double x = std::clamp((slope.upper * length - fb + fa) / (slope.upper - slope.lower), 0.0, length);
  return fa + slope.lower * x > 0.0;
}

/// Finds a stretch [a, b] that holds the first root after lane.t and no other, by interval Newton steps from the left and bisection
/// (Moore 1966; for rays: Mitchell 1990). Nothing before lane.t holds a root at any time.
Isolation isolate(FieldEvaluator& evaluator, const AnalyticState& state, Lane& lane) {
  const double lipschitz = state.lipschitz;
  const double noise = kNoise * lipschitz * (lane.extent + std::abs(lane.t));
  const double resolution = kResolution * lane.extent + 1e-14 * std::abs(lane.t);
  const auto value_at = [&](double t) { return lane.sign * evaluator.value(lane.origin + t * lane.direction); };
  double length = std::max(4.0 * lane.f / lipschitz, resolution);
  while (lane.t < lane.t_end) {
    if (++lane.steps > state.max_steps) return Isolation::out_of_steps;
    lane.a = lane.t;
    lane.b = std::min(lane.t + length, lane.t_end);
    if (lane.f <= 0.0) {
      lane.b = lane.a;
      return Isolation::bracket;
    }
    const RayBounds bounds = turned_bounds(evaluator, lane, lane.b, lipschitz);
    const double fb = value_at(lane.b);
    if (bounds.value.lower > 0.0 || (fb > 0.0 && positive_between(lane.f, fb, lane.b - lane.a, bounds.slope))) {
      lane.t = lane.b;
      lane.f = std::max(fb, 0.0);
      length *= 2.0;
      continue;
    }
    if (bounds.slope.upper < 0.0 && fb <= 0.0) return Isolation::bracket;
    if (lane.b - lane.a <= resolution) {
      if (fb <= 0.0 || std::min(lane.f, fb) <= noise) return Isolation::bracket;
      lane.t = lane.b;
      lane.f = fb;
      length *= 2.0;
      continue;
    }
    length = 0.5 * (lane.b - lane.a);
    const double steepest = std::max(-bounds.slope.lower, 1e-30 * lipschitz);
    lane.t = std::min(lane.t + (1.0 - 1e-12) * lane.f / steepest, lane.b);
    lane.f = value_at(lane.t);
  }
  return Isolation::miss;
}

/// Sphere tracing (Hart 1996) of all lanes at once; those near the surface go on to be isolated one by one.
void isolate_all(const AnalyticState& state, FieldEvaluator& evaluator, Scratch& scratch, HitBatch& hits) {
  for (int step = 0; scratch.active > 0; ++step) {
    const auto count = static_cast<size_t>(scratch.active);
    for (size_t k = 0; k < count; ++k) scratch.points[k] = scratch.lanes[k].point();
    evaluator.values(std::span<const glm::dvec3>(scratch.points).first(count), std::span<double>(scratch.values).first(count));
    int kept = 0;
    for (size_t k = 0; k < count; ++k) {
      Lane lane = scratch.lanes[k];
      const double value = scratch.values[k];
      if (lane.sign == 0.0) lane.sign = value < 0.0 ? -1.0 : 1.0;
      lane.f = lane.sign * value;
      if (++lane.steps > state.max_steps) {
        write_out_of_steps(lane, hits);
      } else if (const double advance = lane.f / state.lipschitz; advance > kIsolationDistance * lane.extent && step < kMaxSphereSteps) {
        lane.t += advance;
        if (lane.t < lane.t_end) scratch.lanes[static_cast<size_t>(kept++)] = lane;
      } else {
        const Isolation outcome = isolate(evaluator, state, lane);
        if (outcome == Isolation::bracket) scratch.found[static_cast<size_t>(scratch.found_count++)] = lane;
        if (outcome == Isolation::out_of_steps) write_out_of_steps(lane, hits);
      }
    }
    scratch.active = kept;
  }
}

void write_hit(const Lane& lane, const glm::dvec3& gradient, const RayBatch& rays, HitBatch& hits) {
  const float t = static_cast<float>(lane.t);
  if (!(t < rays.t_max[lane.index])) return;
  const double length = glm::length(gradient);
  // Where the gradient vanishes (an apex, a double root) any side is as good; the ray's own shows the surface face on.
  const glm::vec3 normal(length > 0.0 && std::isfinite(length) ? gradient / length : -lane.sign * lane.direction);
  hits.status[lane.index] = HitStatus::hit;
  hits.t[lane.index] = t;
  hits.normal_x[lane.index] = normal.x;
  hits.normal_y[lane.index] = normal.y;
  hits.normal_z[lane.index] = normal.z;
  hits.face[lane.index] = -1;
  hits.material[lane.index] = 0;
}

/// The next point to try: Newton's where it stays in the bracket and shrinks its steps, else the middle.
double next_point(const Lane& lane, double f, double slope, double tolerance) {
  const double newton = lane.t - f / slope;
  const bool inside = newton >= lane.a - tolerance && newton <= lane.b + tolerance;
  return inside && 2.0 * std::abs(newton - lane.t) <= lane.step ? newton : 0.5 * (lane.a + lane.b);
}

/// Polishes the bracketed roots; the last gradient is the normal's.
void polish_all(FieldEvaluator& evaluator, const RayBatch& rays, Scratch& scratch, HitBatch& hits) {
  for (int k = 0; k < scratch.found_count; ++k) {
    Lane& lane = scratch.found[static_cast<size_t>(k)];
    lane.steps = 0;
    lane.t = 0.5 * (lane.a + lane.b);
    lane.step = 2.0 * (lane.b - lane.a);
  }
  while (scratch.found_count > 0) {
    const auto count = static_cast<size_t>(scratch.found_count);
    for (size_t k = 0; k < count; ++k) scratch.points[k] = scratch.found[k].point();
    evaluator.gradients(std::span<const glm::dvec3>(scratch.points).first(count), std::span<double>(scratch.values).first(count),
                        std::span<glm::dvec3>(scratch.gradients).first(count));
    int kept = 0;
    for (size_t k = 0; k < count; ++k) {
      Lane lane = scratch.found[k];
      const double f = lane.sign * scratch.values[k];
      (f > 0.0 ? lane.a : lane.b) = lane.t;
      const double tolerance = kRootTolerance * (lane.extent + std::abs(lane.t));
      const double next = next_point(lane, f, lane.sign * glm::dot(scratch.gradients[k], lane.direction), tolerance);
      const double moved = std::abs(next - lane.t);
      // 200 halvings exhaust any bracket; the bound only guards against NaN.
      if (moved <= tolerance || ++lane.steps > 200) {
        write_hit(lane, scratch.gradients[k], rays, hits);
        continue;
      }
      lane.step = moved;
      lane.t = next;
      scratch.found[static_cast<size_t>(kept++)] = lane;
    }
    scratch.found_count = kept;
  }
}

void trace(const void* opaque, const RayBatch& rays, HitBatch& hits) {
  const AnalyticState& state = *static_cast<const AnalyticState*>(opaque);
  Scratch scratch;
  scratch.active = start_lanes(state, rays, scratch);
  if (scratch.active == 0) return;
  FieldEvaluator& evaluator = state.evaluators.local();
  isolate_all(state, evaluator, scratch, hits);
  polish_all(evaluator, rays, scratch, hits);
}

void evaluate_curvatures(const void* opaque, std::span<const SurfacePoint> points, std::span<SurfaceCurvature> curvatures) {
  FieldEvaluator& evaluator = static_cast<const AnalyticState*>(opaque)->evaluators.local();
  for (size_t i = 0; i < points.size(); ++i) curvatures[i] = facing(curvature_of_jet(evaluator.jet(points[i].position)), points[i].normal);
}

std::string unsupported(const SceneObject& object) {
  return std::holds_alternative<Field>(object.source) ? "" : "it comes as a mesh or a volume, not as a formula";
}

Surface build(const SceneObject& object, const SurfaceSettings& settings, const glm::dvec3& render_origin) {
  const auto start = std::chrono::steady_clock::now();
  auto state = std::make_shared<AnalyticState>(translate(std::get<Field>(object.source), -render_origin), settings.max_steps);
  Surface surface;
  surface.bounds = state->field.traits().bounds;
  surface.state = state;
  surface.trace = trace;
  surface.curvature = {state, evaluate_curvatures, "Hessian of the field"};
  surface.offset = field_offset(state->field, settings.max_steps);
  surface.info.kind = "analytic";
  surface.info.build_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return surface;
}

}  // namespace

SurfaceDescriptor analytic_surface() {
  return {{"analytic", "the field itself, traced by interval bounds and polished in double precision",
           "Hart 1996 (sphere tracing); Mitchell 1990 (interval ray intersection)"},
          {},
          unsupported,
          build};
}

}  // namespace limn
