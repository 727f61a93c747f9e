// The field itself: a tape (sdf/tape.h), marched by sixteen SIMD lanes.

#include <tbb/enumerable_thread_specific.h>

#include <chrono>
#include <memory>
#include <mutex>

#include "raymarch/analytic/long_tape.h"
#include "raymarch/analytic/tile.h"
#include "raymarch/scene/curvature.h"
#include "raymarch/surface.h"
#include "raymarch/surface/offset.h"
#include "sdf/error.h"

namespace limn {
namespace {

// Directions are unit to float precision only.
constexpr double kDirectionSlack = 1.0 + 1e-6;

struct AnalyticState {
  AnalyticState(const Field& render_field, int max_steps, std::shared_ptr<FieldScratch> memory)
      : tape(render_field), scratch(memory ? std::move(memory) : std::make_shared<FieldScratch>()) {
    const FieldTraits& traits = tape.field.traits();
    if (traits.bounds.empty()) clip = {};
    const bool bounded = traits.bounds.finite();
    // Flat faces lie in the bounds: starting beyond them tells outside from inside. Bounds that are open on a side give no measure
    // of "beyond".
    if (bounded) clip = dilate(traits.bounds, 1e-3 * traits.bounds.radius());
    limits = {.lipschitz = traits.lipschitz * kDirectionSlack,
              .direction_length = kDirectionSlack,
              .extent = bounded ? traits.bounds.radius() : 0.0,
              .max_steps = max_steps};
  }
  FieldTape tape;
  MarchLimits limits;
  Box clip{glm::dvec3(-std::numeric_limits<double>::infinity()), glm::dvec3(std::numeric_limits<double>::infinity())};
  std::shared_ptr<FieldScratch> scratch;
  mutable std::once_flag evaluators_made;  ///< For curvatures, which few pictures ask for.
  mutable std::unique_ptr<tbb::enumerable_thread_specific<FieldEvaluator>> evaluators;
};

/// `clip_ray` with one division an axis instead of two, which every ray of a picture takes; its last bits differ from that one's.
bool clip_ray_by_inverse(const Box& box, const glm::dvec3& origin, const glm::dvec3& direction, double& t0, double& t1) {
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

void trace(const void* opaque, const RayBatch& rays, HitBatch& hits) {
  const AnalyticState& state = *static_cast<const AnalyticState*>(opaque);
  StretchList list;
  for (int i = 0; i < rays.count; ++i) {
    double t0 = rays.t_min[i], t1 = rays.t_max[i];
    if (t0 < t1 && clip_ray_by_inverse(state.clip, glm::dvec3(rays.origin(i)), glm::dvec3(rays.direction(i)), t0, t1))
      list.add({i, 0, t0, t1, 0.0});
  }
  if (list.count == 0) return;
  ViewScratch& view = state.scratch->views.local();
  TapeScratch& scratch = view.tape;
  const MarchTape march{&state.tape, state.tape.steps};
  sphere_trace(march, state.limits, rays, scratch, list, hits);
  if (state.tape.leaves.size() >= kLongTape) return isolate_in_parts(state.tape, state.limits, rays, view, list, hits);
  isolate(march, state.limits, rays, scratch, list, hits);
  polish(march, state.limits, rays, scratch, list, hits);
}

SurfaceView view(const std::shared_ptr<const void>& opaque, const ViewRequest& request) {
  const AnalyticState& state = *static_cast<const AnalyticState*>(opaque.get());
  return view_field(opaque, state.tape, state.limits, {&state, trace}, state.scratch, request);
}

void evaluate_curvatures(const void* opaque, std::span<const SurfacePoint> points, std::span<SurfaceCurvature> curvatures) {
  const AnalyticState& state = *static_cast<const AnalyticState*>(opaque);
  std::call_once(state.evaluators_made,
                 [&state] { state.evaluators = std::make_unique<tbb::enumerable_thread_specific<FieldEvaluator>>(state.tape.field); });
  FieldEvaluator& evaluator = state.evaluators->local();
  for (size_t i = 0; i < points.size(); ++i) curvatures[i] = facing(curvature_of_jet(evaluator.jet(points[i].position)), points[i].normal);
}

std::string unsupported(const SceneObject& object) {
  return std::holds_alternative<Field>(object.source) ? "" : "it comes as a mesh or a volume, not as a formula";
}

Surface build(const SceneObject& object, const SurfaceSettings& settings, const glm::dvec3& render_origin) {
  const auto start = std::chrono::steady_clock::now();
  auto state = std::make_shared<AnalyticState>(translate(std::get<Field>(object.source), -render_origin), settings.max_steps,
                                               settings.field_scratch);
  Surface surface;
  surface.bounds = state->tape.field.traits().bounds;
  surface.state = state;
  surface.trace = trace;
  // Without bounds there is no depth to divide.
  if (state->limits.extent > 0.0) surface.view = view, surface.traces_samples = true;
  surface.curvature = {state, evaluate_curvatures, "Hessian of the field"};
  surface.offset = field_offset(state->tape.field, settings.max_steps);
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
