// The offset of a field, by sphere tracing (Hart 1996) of distance minus width.

#include <tbb/enumerable_thread_specific.h>

#include <array>

#include "raymarch/analytic/clip_ray.h"
#include "raymarch/surface/offset.h"
#include "sdf/level_set_distance.h"

namespace limn {
namespace {

// Shares of the width: a ray enters the shell where it comes this near to the offset surface, and leaves it where it is twice as far
// beyond, to the least step within.
constexpr double kTouch = 1e-3;
constexpr double kLeast = 1.0 / 32.0;

struct State {
  State(const Field& render_field, const OffsetWidth& w, int steps) : field(render_field), width(w), max_steps(steps), evaluators(field) {}
  Field field;
  OffsetWidth width;
  int max_steps;
  double largest_width = 0.0;
  Box clip{};
  mutable tbb::enumerable_thread_specific<DistanceEvaluator> evaluators;
};

struct Lane {
  int index = 0, steps = 0;
  glm::dvec3 origin{0.0}, direction{0.0};
  double t = 0.0, t_end = 0.0;
  double side = 0.0;  ///< 1 where the ray started beyond the offset surface, -1 within; 0 unknown.
};

enum class Fate { going, missed, hit };

/// The distance bounds how far the surface is, and the width changes no faster than its slope: a step that reaches no farther misses
/// nothing. Distances that are right to third order only get shorter steps.
Fate advance(const State& state, double distance, Lane& lane) {
  const double width = state.width.at(lane.origin + lane.t * lane.direction);
  const double beyond = distance - width, touch = kTouch * width;
  // A ray that grazes the surface hovers about it; between entering and leaving lies as much again, or it would do both at every step.
  if (lane.side == 0.0) lane.side = beyond <= touch ? -1.0 : 1.0;
  const double left = lane.side > 0.0 ? beyond - touch : 2.0 * touch - beyond;
  if (left <= 0.0) return Fate::hit;
  if (++lane.steps > state.max_steps) return Fate::hit;  // it has crept along the surface all the way
  const double trust = state.field.traits().exact_distance ? 1.0 : 0.8;
  const double least = lane.side > 0.0 ? 0.5 * touch : kLeast * width;
  lane.t += std::max(trust * left / (1.0 + state.width.slope_bound()), least);
  return lane.t < lane.t_end ? Fate::going : Fate::missed;
}

void write_hits(FieldEvaluator& evaluator, std::span<const Lane> found, const RayBatch& rays, HitBatch& hits) {
  for (const Lane& lane : found) {
    const int i = lane.index;
    if (!(static_cast<float>(lane.t) < rays.t_max[i])) continue;
    const glm::dvec3 gradient = evaluator.jet(lane.origin + lane.t * lane.direction).gradient;
    const double length = glm::length(gradient);
    const glm::vec3 normal(length > 0.0 && std::isfinite(length) ? gradient / length : -lane.side * lane.direction);
    hits.status[i] = HitStatus::hit;
    hits.t[i] = static_cast<float>(lane.t);
    hits.normal_x[i] = normal.x;
    hits.normal_y[i] = normal.y;
    hits.normal_z[i] = normal.z;
    hits.face[i] = -1;
    hits.material[i] = 0;
  }
}

void trace(const void* opaque, const RayBatch& rays, HitBatch& hits) {
  const State& state = *static_cast<const State*>(opaque);
  std::array<Lane, kRayBatchSize> lanes, found;
  std::array<glm::dvec3, kRayBatchSize> points;
  std::array<double, kRayBatchSize> distances;
  size_t active = 0, found_count = 0;
  for (int i = 0; i < rays.count; ++i) {
    Lane lane{i, 0, glm::dvec3(rays.origin(i)), glm::dvec3(rays.direction(i)), rays.t_min[i], rays.t_max[i], 0.0};
    if (lane.t < lane.t_end && clip_ray(state.clip, lane.origin, lane.direction, lane.t, lane.t_end)) lanes[active++] = lane;
  }
  DistanceEvaluator& distance = state.evaluators.local();
  while (active > 0) {
    for (size_t k = 0; k < active; ++k) points[k] = lanes[k].origin + lanes[k].t * lanes[k].direction;
    signed_distances(distance, std::span<const glm::dvec3>(points).first(active), 2.0 * state.largest_width,
                     std::span(distances).first(active));
    size_t kept = 0;
    for (size_t k = 0; k < active; ++k) {
      Lane lane = lanes[k];
      const Fate fate = advance(state, distances[k], lane);
      if (fate == Fate::going) lanes[kept++] = lane;
      if (fate == Fate::hit) found[found_count++] = lane;
    }
    active = kept;
  }
  write_hits(distance.evaluator, std::span<const Lane>(found).first(found_count), rays, hits);
}

struct Maker {
  Field field;
  int max_steps;
};

/// The largest width anywhere on the offset surface of what lies in `bounds`.
double largest_width(const OffsetWidth& width, const Box& bounds) {
  if (!bounds.finite()) return width.world > 0.0 ? width.world : width.per_depth * glm::length(width.eye);
  // No farther from the eye than the far side of the bounds, and the offset itself.
  const double reach = glm::length(width.eye - bounds.center()) + bounds.radius();
  return width.world + width.per_depth * reach / std::max(0.1, 1.0 - width.slope_bound());
}

Surface make(const void* opaque, const OffsetWidth& width) {
  const Maker& maker = *static_cast<const Maker*>(opaque);
  auto state = std::make_shared<State>(maker.field, width, maker.max_steps);
  const FieldTraits& traits = maker.field.traits();
  state->largest_width = largest_width(width, traits.bounds);
  // With room for the last step, which leaves the shell by up to kLeast.
  state->clip = traits.bounds.empty() ? traits.bounds : dilate(traits.bounds, 1.1 * state->largest_width);
  Surface surface;
  surface.bounds = state->clip;
  surface.trace = trace;
  surface.info.kind = "offset";
  surface.state = std::move(state);
  return surface;
}

}  // namespace

SurfaceOffset field_offset(const Field& render_field, int max_steps) {
  return {std::make_shared<const Maker>(Maker{render_field, max_steps}), make};
}

}  // namespace limn
