#include "raymarch/level_set/level_set_marcher.h"

#include <fmt/format.h>

#include <cmath>
#include <mutex>
#include <optional>
#include <utility>

#include "raymarch/level_set/level_places.h"
#include "raymarch/level_set/single_rays.h"
#include "raymarch/level_set/walk.h"
#include "raymarch/scene/curvature.h"
#include "sdf/level_set_data.h"
#include "sdf/level_set_lower.h"
#include "sdf/once_alone.h"

namespace limn {
namespace {

using Accessor = nanovdb::FloatGrid::AccessorType;

struct State {
  explicit State(LevelSet walked_grid) : level_set(std::move(walked_grid)) {}
  LevelSet level_set;
  const GradientDescriptor* gradient = nullptr;
  WalkedGrid walked{};
  Affine grid_world_from_render{};            ///< Into the world that the grid was made in, where gradients are asked for.
  glm::dmat3 normal_from_grid{1.0};           ///< Grid's world gradients to render-space normals.
  std::shared_ptr<const RayBricks> bricks{};  ///< Null where rays only walk the grid.
  BrickGradient brick_gradient = BrickGradient::central;
  std::vector<LoweredBlock> lowered{};            ///< Cells that take a lower gradient; none in a band that is whole.
  std::vector<std::uint8_t> lowered_in_bricks{};  ///< The same as BrickTrace has it.
  // Of the grid's leaves, for rays that walk it: found when the first of them does, which in most calls none does.
  mutable std::once_flag crossed_once{};
  mutable CrossedLeaves crossed{};
  // For packets of points asked for singly: made when the first of them comes.
  mutable std::once_flag singles_once{};
  mutable SingleRayBricks singles{};
};

/// Null where there are no bricks to know it from.
const CrossedLeaves* crossed_of(const State& state) {
  if (!state.crossed.cells.empty()) return &state.crossed;
  if (!state.bricks || state.bricks->groups.empty()) return nullptr;
  once_alone(state.crossed_once,
             [&] { state.crossed = crossed_leaves(*state.level_set.data().grid, state.bricks->groups.front().bounds); });
  return &state.crossed;
}

/// A unit vector whatever the gradient is: a hit on a kink that cancels out falls back on the cell's own gradient, then on the ray.
glm::dvec3 unit_normal(const State& state, const glm::dvec3& gradient, const glm::dvec3& point, const glm::dvec3& direction) {
  glm::dvec3 normal = state.normal_from_grid * gradient;
  double length = glm::length(normal);
  if (!(length > 0.0) || !std::isfinite(length)) {
    glm::dvec3 of_cell(0.0);
    find_gradient("cell").gradients(state.level_set.data(), std::span(&point, 1), std::span(&of_cell, 1));
    normal = state.normal_from_grid * of_cell;
    length = glm::length(normal);
  }
  return length > 0.0 && std::isfinite(length) ? normal / length : -direction;
}

/// Roots of the trilinear interpolant along some of a batch's rays.
struct Roots {
  size_t count = 0;
  std::array<int, kRayBatchSize> lanes;
  std::array<double, kRayBatchSize> t;
  std::array<bool, kRayBatchSize> from_inside;
  std::array<glm::dvec3, kRayBatchSize> points;  ///< Of the world that the grid was made in.

  std::span<const glm::dvec3> places() const { return std::span(points).first(count); }
};

Roots find_roots(const State& state, const Accessor& accessor, const RayBatch& rays, HitBatch& hits) {
  Roots roots;
  const CrossedLeaves* const crossed = crossed_of(state);
  for (int i = 0; i < rays.count; ++i) {
    const glm::dvec3 origin(rays.origin(i)), direction(rays.direction(i));
    GridRoot root;
    const HitStatus status = walk_grid(state.walked, accessor, crossed, origin, direction, static_cast<double>(rays.t_min[i]),
                                       static_cast<double>(rays.t_max[i]), root);
    if (status == HitStatus::miss) continue;
    hits.status[i] = status;
    if (status != HitStatus::hit) continue;
    roots.t[roots.count] = root.t;
    roots.from_inside[roots.count] = root.from_inside;
    roots.points[roots.count] = state.grid_world_from_render.point(origin + root.t * direction);
    roots.lanes[roots.count++] = i;
  }
  return roots;
}

/// Calls `visit(gradient, first, count)` for runs of roots that take the same gradient: all of them at once in a band that is whole.
template <class Visit>
void by_gradient(const State& state, const Roots& roots, const Visit& visit) {
  if (state.lowered.empty()) return visit(*state.gradient, size_t{0}, roots.count);
  for (size_t k = 0; k < roots.count; ++k) {
    const nanovdb::Coord node = cell_point(state.level_set.data().index_from_world.point(roots.points[k])).node;
    visit(gradient_in_cell(state.lowered, {node[0], node[1], node[2]}, *state.gradient), k, size_t{1});
  }
}

/// One step of Newton's iteration towards the root of the gradient's own reconstruction, by a quarter of a voxel at most; as packets take
/// it (newton_step in raymarch/level_set/gradients-inl.h).
void settle(const State& state, const GradientDescriptor& gradient, const Accessor& accessor, const RayBatch& rays, size_t first,
            size_t count, Roots& roots) {
  if (!gradient.values) return;
  std::array<glm::dvec3, kRayBatchSize> gradients;
  std::array<double, kRayBatchSize> values;
  const LevelSetData& data = state.level_set.data();
  const auto places = roots.places().subspan(first, count);
  gradient.values(data, places, std::span(values).subspan(first, count));
  gradient.gradients(data, places, std::span(gradients).subspan(first, count));
  for (size_t k = first; k < first + count; ++k) {
    const int i = roots.lanes[k];
    const glm::dvec3 direction(rays.direction(i)), along = state.grid_world_from_render.vector(direction);
    const glm::dvec3 place = data.index_from_world.point(roots.points[k]);
    const glm::dvec3 product = gradients[k] * along;
    const double side = roots.from_inside[k] ? -1.0 : 1.0, rest = side * (values[k] - interpolated(accessor, place));
    const double fall = -side * (product.x + product.y + product.z);
    const double most_fall = std::abs(product.x) + std::abs(product.y) + std::abs(product.z);
    if (most_fall == 0.0) continue;
    const double step = rest / std::max(fall, most_fall / 16.0), share = std::min(1.0 + fall / most_fall, 1.0);
    const glm::dvec3 way = state.walked.index_from_render.vector(direction);
    const double most = 0.25 / std::max({std::abs(way.x), std::abs(way.y), std::abs(way.z)});
    const double move = share * std::clamp(step, -most, most), t = roots.t[k] + move;
    if (t < static_cast<double>(rays.t_min[i]) || t >= static_cast<double>(rays.t_max[i])) continue;
    roots.t[k] = t;
    roots.points[k] += move * along;
  }
}

void trace(const void* opaque, const RayBatch& rays, HitBatch& hits) {
  const State& state = *static_cast<const State*>(opaque);
  const Accessor accessor = state.level_set.data().accessor();
  Roots roots = find_roots(state, accessor, rays, hits);
  by_gradient(state, roots, [&](const GradientDescriptor& gradient, size_t first, size_t count) {
    settle(state, gradient, accessor, rays, first, count, roots);
  });
  std::array<glm::dvec3, kRayBatchSize> gradients;
  by_gradient(state, roots, [&](const GradientDescriptor& gradient, size_t first, size_t count) {
    gradient.gradients(state.level_set.data(), roots.places().subspan(first, count), std::span(gradients).subspan(first, count));
  });
  for (size_t k = 0; k < roots.count; ++k) {
    const int i = roots.lanes[k];
    const glm::vec3 normal(unit_normal(state, gradients[k], roots.points[k], glm::dvec3(rays.direction(i))));
    hits.t[i] = static_cast<float>(roots.t[k]);
    hits.face[i] = -1;
    hits.material[i] = 0;
    hits.normal_x[i] = normal.x;
    hits.normal_y[i] = normal.y;
    hits.normal_z[i] = normal.z;
  }
}

std::vector<Box> where_met(const void* opaque, const MeetingRequest& request) {
  const State& state = *static_cast<const State*>(opaque);
  return level_meeting_places(state.level_set.data(), state.walked, state.crossed, request);
}

/// What is the same for all packets, but for the view.
BrickTrace brick_trace(const State& state) {
  BrickTrace how;
  how.gradient = state.brick_gradient;
  if (!state.lowered_in_bricks.empty()) how.lowered = state.lowered_in_bricks.data();
  const glm::dmat3 normal_from_index = state.normal_from_grid * glm::transpose(state.level_set.data().index_from_world.linear);
  for (int k = 0; k < 9; ++k) how.normal_from_index[k] = static_cast<float>(normal_from_index[k / 3][k % 3]);
  return how;
}

const SingleRayBricks& singles_of(const State& state) {
  once_alone(state.singles_once, [&] { state.singles = for_single_rays(state.bricks, state.walked.index_from_render); });
  return state.singles;
}

void trace_packets(const void* opaque, const RayBatch& rays, HitBatch& hits) {
  const State& state = *static_cast<const State*>(opaque);
  const Accessor accessor = state.level_set.data().accessor();
  const auto starts_inside = [&](const glm::dvec3& place) { return is_inside(accessor, state.walked.index_from_render.point(place)); };
  const SingleRayBricks* const size = &singles_of(state);
  trace_single_rays({&size, 1}, brick_trace(state), starts_inside, rays, hits);
}

/// What a picture's tiles are traced with.
struct PictureState {
  std::shared_ptr<const BrickView> view;
  BrickTrace trace;
};

bool eye_inside(const State& state, const Camera& camera) {
  const glm::dvec3 eye = state.walked.index_from_render.point(camera.eye);
  return is_inside(state.level_set.data().accessor(), eye);
}

SurfaceView view_picture(const std::shared_ptr<const void>& opaque, const ViewRequest& request) {
  const auto state = std::static_pointer_cast<const State>(opaque);
  if (!state->bricks) return {};
  auto picture = std::make_shared<PictureState>();
  picture->view = view_bricks(state->bricks, state->walked.index_from_render, eye_inside(*state, request.camera), request);
  if (!picture->view) return {};
  picture->trace = brick_trace(*state);
  picture->trace.view = picture->view.get();
  return {.state = picture,
          .touches = [](const void* p, const PixelTile& tile) { return touches(*static_cast<const PictureState*>(p)->view, tile); },
          .trace =
              [](const void* p, const PixelTile& tile, const RayBatch& rays, HitBatch& hits) {
                trace_bricks({&static_cast<const PictureState*>(p)->trace, 1}, tile, rays, hits);
              }};
}

/// From the cubic gradient's Hessian, whatever the gradient of the normals: no other has one worth having.
void evaluate_curvatures(const void* opaque, std::span<const SurfacePoint> points, std::span<SurfaceCurvature> curvatures) {
  const State& state = *static_cast<const State*>(opaque);
  const glm::dmat3& linear = state.grid_world_from_render.linear;
  std::vector<glm::dvec3> at(points.size());
  std::vector<FieldJet> jets(points.size());
  for (size_t i = 0; i < points.size(); ++i) at[i] = state.grid_world_from_render.point(points[i].position);
  find_gradient("cubic").hessians(state.level_set.data(), at, jets);
  for (size_t i = 0; i < points.size(); ++i) {
    jets[i].gradient = state.normal_from_grid * jets[i].gradient;
    jets[i].hessian = glm::transpose(linear) * jets[i].hessian * linear;
    curvatures[i] = facing(curvature_of_jet(jets[i]), points[i].normal);
  }
}

/// Empty for a gradient that only the walk knows: every ray walks then.
std::optional<BrickGradient> brick_gradient(const GradientDescriptor& gradient) {
  if (gradient.about.name == "cell") return BrickGradient::cell;
  if (gradient.about.name == "central") return BrickGradient::central;
  if (gradient.about.name == "cubic") return BrickGradient::cubic;
  return std::nullopt;
}

/// 512 cells a brick, each 0 or 1 + the BrickGradient that it takes instead.
std::vector<std::uint8_t> lowered_in(const RayBricks& bricks, const std::vector<LoweredBlock>& lowered, const GradientDescriptor& asked) {
  std::vector<std::uint8_t> cells;
  if (lowered.empty() || bricks.groups.empty()) return cells;
  const std::vector<SurfaceBound>& bounds = bricks.groups.front().bounds;
  cells.assign(bounds.size() * 512, 0);
  for (size_t brick = 0; brick < bounds.size(); ++brick) {
    const glm::ivec3 origin(bounds[brick].origin[0], bounds[brick].origin[1], bounds[brick].origin[2]);
    for (int k = 0; k < 512; ++k) {
      const GradientDescriptor& taken = gradient_in_cell(lowered, origin + glm::ivec3(k >> 6, k >> 3 & 7, k & 7), asked);
      const std::optional<BrickGradient> packed = brick_gradient(taken);
      if (&taken != &asked && packed)
        cells[brick * 512 + static_cast<size_t>(k)] = static_cast<std::uint8_t>(1 + static_cast<int>(*packed));
    }
  }
  return cells;
}

CurvatureSource curvature_source(const std::shared_ptr<const State>& state) {
  const GradientDescriptor& cubic = find_gradient("cubic");
  const double there = state->level_set.info().half_width_voxels;
  if (there >= cubic.half_width_voxels - 1e-2 || cells_lacking(state->level_set, cubic) == 0)
    return {state, evaluate_curvatures, "Hessian of the cubic spline through the voxels"};
  return {{},
          nullptr,
          fmt::format("the band's half width of {:.2f} voxels is too thin for the cubic spline's Hessian: {:.2f} are needed "
                      "(gradient = cubic, or a wider band)",
                      there, cubic.half_width_voxels)};
}

}  // namespace

Surface level_set_marcher(const LevelSet& level_set, const Affine& world_from_object, const GradientDescriptor& gradient,
                          const glm::dvec3& render_origin, int max_steps, const MarchedLevel& level) {
  const LevelSetData& data = level_set.data();
  const Affine object_from_world = inverse(world_from_object);
  const Affine object_from_render = {object_from_world.linear, object_from_world.point(render_origin)};
  // One cell around the crossings of the grid's edges: the interpolant changes sign in no cell without such an edge.
  const Box cells = dilate(transform(data.index_from_world, data.info.bounds), 1.0 + level.largest_voxels);

  const double length_scale = std::cbrt(std::abs(glm::determinant(world_from_object.linear)));
  const Affine index_from_render = compose(data.index_from_world, object_from_render);
  WalkedGrid walked{.index_from_render = index_from_render,
                    .render_from_index = inverse(index_from_render),
                    .max_steps = max_steps,
                    .level = level.width,
                    .largest_level = 1.01 * level.largest_voxels * data.info.voxel_size,
                    .grid_from_render_length = 1.0 / length_scale};
  if (!cells.empty()) {
    walked.lower = glm::ivec3(glm::floor(cells.lower));
    walked.upper = glm::ivec3(glm::ceil(cells.upper));
  }
  auto state = std::make_shared<State>(level_set);
  state->gradient = &gradient;
  state->walked = walked;
  state->grid_world_from_render = object_from_render;
  state->normal_from_grid = glm::transpose(object_from_world.linear);
  if (!level.width.zero()) state->crossed = leaves_of_level(data, walked);
  if (level.width.zero()) state->lowered = lowered_cells(level_set, gradient);
  const std::optional<BrickGradient> packed = brick_gradient(gradient);
  if (level.width.zero() && packed) {
    state->brick_gradient = *packed;
    state->bricks = make_bricks(level_set, *packed == BrickGradient::cubic);
    if (state->bricks) state->lowered_in_bricks = lowered_in(*state->bricks, state->lowered, gradient);
  }
  Surface surface;
  surface.trace = trace;
  if (!state->crossed.cells.empty()) surface.where_met = where_met;
  if (state->bricks) {
    surface.trace_packets = trace_packets;
    surface.prepare = [](const void* opaque) { static_cast<void>(singles_of(*static_cast<const State*>(opaque))); };
  }
  surface.view = view_picture;
  const Box world = transform(world_from_object, transform(data.info.world_from_index, cells));
  surface.bounds = {world.lower - render_origin, world.upper - render_origin};
  surface.info.voxel_size = data.info.voxel_size * length_scale;
  surface.info.voxels = data.info.active_voxels;
  surface.info.bytes = data.info.bytes;
  surface.info.build_ms = data.info.build_ms;
  surface.bricks = state->bricks;
  if (state->bricks) {
    surface.info.ray_bytes = state->bricks->bytes();
    surface.info.prepare_ms = state->bricks->prepare_ms;
    surface.info.bytes += surface.info.ray_bytes;
    surface.info.build_ms += surface.info.prepare_ms;
  }
  surface.info.warnings = data.info.warnings;
  surface.curvature = curvature_source(state);
  surface.state = std::move(state);
  return surface;
}

}  // namespace limn
