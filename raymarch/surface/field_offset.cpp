// The offset of a field, by sphere tracing (Hart 1996) of distance minus width.

#include <tbb/enumerable_thread_specific.h>

#include "raymarch/analytic/clip_ray.h"
#include "raymarch/surface/cell_distances.h"
#include "raymarch/surface/offset.h"
#include "raymarch/surface/shell_lanes.h"

namespace limn {
namespace {

// Shares of the width: a ray enters the shell where it comes this near to the offset surface, and leaves it where it is twice as far
// beyond, to the least step within.
constexpr double kTouch = 1e-3;
constexpr double kLeast = 1.0 / 32.0;

struct State {
  State(const Field& render_field, const OffsetWidth& w, int steps) : field(render_field), width(w), max_steps(steps) {}
  Field field;
  OffsetWidth width;
  int max_steps;
  double largest_width = 0.0;
  Box clip{};
  mutable tbb::enumerable_thread_specific<std::optional<CellDistances>> distances{};

  CellDistances& own_distances() const {
    std::optional<CellDistances>& own = distances.local();
    if (!own) own.emplace(field, clip);
    return *own;
  }
};

void write_hits(CellDistances& distance, const FoundLanes& found, const RayBatch& rays, HitBatch& hits) {
  for (size_t k = 0; k < found.count; ++k) {
    const auto& [i, t, side] = found.lanes[k];
    if (!(static_cast<float>(t) < rays.t_max[i])) continue;
    const glm::dvec3 origin(rays.origin(i)), direction(rays.direction(i));
    const glm::dvec3 gradient = distance.jet(origin + t * direction).gradient;
    const double length = glm::length(gradient);
    const glm::vec3 normal(length > 0.0 && std::isfinite(length) ? gradient / length : -side * direction);
    hits.status[i] = HitStatus::hit;
    hits.t[i] = static_cast<float>(t);
    hits.normal_x[i] = normal.x;
    hits.normal_y[i] = normal.y;
    hits.normal_z[i] = normal.z;
    hits.face[i] = -1;
    hits.material[i] = 0;
  }
}

/// The rays that come near the field.
void start_lanes(const Box& clip, const RayBatch& rays, ShellLanes& lanes) {
  for (int i = 0; i < rays.count; ++i) {
    const glm::dvec3 origin(rays.origin(i)), direction(rays.direction(i));
    double t = rays.t_min[i], t_end = rays.t_max[i];
    if (!(t < t_end && clip_ray(clip, origin, direction, t, t_end))) continue;
    const size_t to = lanes.count++;
    for (int axis = 0; axis < 3; ++axis) lanes.origin[axis][to] = origin[axis], lanes.direction[axis][to] = direction[axis];
    lanes.t[to] = t, lanes.t_end[to] = t_end, lanes.side[to] = 0.0, lanes.index[to] = i;
  }
}

void trace(const void* opaque, const RayBatch& rays, HitBatch& hits) {
  const State& state = *static_cast<const State*>(opaque);
  ShellLanes lanes;
  start_lanes(state.clip, rays, lanes);
  FoundLanes found;
  LanePoints points;
  LaneNumbers distances;
  CellDistances& distance = state.own_distances();
  ShellSteps how{.width = state.width,
                 .touch = kTouch,
                 .least = kLeast,
                 .trust = state.field.traits().exact_distance ? 1.0 : 0.8,
                 .are_the_last = false};
  for (int step = 1; lanes.count > 0; ++step) {
    how.are_the_last = step > state.max_steps;
    place_lanes(lanes, points);
    distance.find(points, 2.0 * state.largest_width, distances);
    advance_lanes(how, points, distances, lanes, found);
  }
  write_hits(distance, found, rays, hits);
}

std::vector<Box> where_met(const void* opaque, const MeetingRequest& request) {
  const State& state = *static_cast<const State*>(opaque);
  return field_meeting_places(state.field, state.clip, state.width, request);
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
  surface.where_met = where_met;
  surface.info.kind = "offset";
  surface.state = std::move(state);
  return surface;
}

}  // namespace

SurfaceOffset field_offset(const Field& render_field, int max_steps) {
  return {std::make_shared<const Maker>(Maker{render_field, max_steps}), make};
}

}  // namespace limn
