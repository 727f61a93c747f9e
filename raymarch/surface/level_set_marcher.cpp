#include "raymarch/surface/level_set_marcher.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "raymarch/curvature.h"
#include "raymarch/level_set/trace.h"
#include "sdf/level_set_data.h"

namespace limn {
namespace {

using Accessor = nanovdb::FloatGrid::AccessorType;
using Leaf = nanovdb::FloatGrid::TreeType::LeafNodeType;

struct State {
  LevelSet level_set;
  const GradientDescriptor* gradient;
  Affine index_from_render;
  Affine grid_world_from_render;  ///< Into the world that the grid was made in, where gradients are asked for.
  glm::dmat3 normal_from_grid;    ///< Grid's world gradients to render-space normals.
  glm::ivec3 lower, upper;        ///< Cells that may hold the surface: lower <= cell < upper, index coordinates.
  int max_steps;
  OffsetWidth level{};  ///< Taken from every value.
  double largest_level = 0.0;
  double grid_from_render_length = 1.0;
  Affine render_from_index{};
  std::shared_ptr<const RayBricks> bricks{};  ///< Null where rays only walk the grid.
  BrickGradient brick_gradient = BrickGradient::central;

  /// Taking it at the nodes is exact for a constant, and for pixels good to the second order of a voxel seen from the eye.
  void subtract_level(const glm::ivec3& cell, std::array<double, 8>& values) const {
    const auto [least, greatest] = std::minmax_element(values.begin(), values.end());
    // Far to either side only the sign counts.
    if (*greatest < 0.0 || *least > largest_level) {
      for (double& value : values) value -= *greatest < 0.0 ? 0.0 : largest_level;
      return;
    }
    for (size_t k = 0; k < values.size(); ++k) {
      const glm::ivec3 node = cell + glm::ivec3(k & 1, (k >> 1) & 1, (k >> 2) & 1);
      values[k] -= grid_from_render_length * level.at(render_from_index.point(glm::dvec3(node)));
    }
  }
};

/// A ray in index space. `t` keeps its meaning (world units along the render-space ray), so `direction` is not unit.
struct IndexRay {
  glm::dvec3 origin, direction, inverse;

  glm::dvec3 at(double t) const { return origin + t * direction; }
  /// Where the ray meets the plane of index `plane` across `axis`; never for a ray along the plane. Computed from the plane's number
  /// each time, so that nothing accumulates and neighbouring cells agree on the last bit.
  double meets(int axis, int plane) const {
    if (direction[axis] == 0.0) return std::numeric_limits<double>::infinity();
    return (static_cast<double>(plane) - origin[axis]) * inverse[axis];
  }
};

/// A stretch of the grid in which the ray is: cells from `lower` on, `size` to a side.
struct Block {
  glm::ivec3 lower;
  int size;
};

/// The walk's next whole step: leaves `block` at time `t` through a face of `axis`, towards the cell `next`.
struct Exit {
  double t;
  int axis;
};

Exit exit_of(const IndexRay& ray, const Block& block) {
  Exit exit{std::numeric_limits<double>::infinity(), 0};
  for (int axis = 0; axis < 3; ++axis) {
    const double t = ray.meets(axis, block.lower[axis] + (ray.direction[axis] > 0.0 ? block.size : 0));
    if (t < exit.t) exit = {t, axis};
  }
  return exit;
}

/// The cell at time `t` within `block`, exactly the one beyond the face on the axis just crossed.
glm::ivec3 cell_within(const IndexRay& ray, double t, const Block& block) {
  glm::ivec3 cell;
  const glm::dvec3 p = ray.at(t);
  for (int axis = 0; axis < 3; ++axis) {
    const auto lowest = static_cast<double>(block.lower[axis]);
    cell[axis] = static_cast<int>(glm::clamp(std::floor(p[axis]), lowest, lowest + block.size - 1));
  }
  return cell;
}

/// The trilinear interpolant along the ray's stretch [t0, t1] in a cell, as a cubic in s = (t - t0) / (t1 - t0) (Parker et al. 1998).
std::array<double, 4> cubic_along(const std::array<double, 8>& v, const glm::dvec3& from, const glm::dvec3& to) {
  const glm::dvec3 d = to - from;
  // Products of linear functions of s, one axis after the other: x joins pairs of corners, then y, then z.
  std::array<std::array<double, 4>, 4> line{};
  for (size_t k = 0; k < 4; ++k) {
    const double difference = v[2 * k + 1] - v[2 * k];
    line[k] = {v[2 * k] + from.x * difference, d.x * difference, 0.0, 0.0};
  }
  const auto join = [](const std::array<double, 4>& a, const std::array<double, 4>& b, double start, double slope) {
    std::array<double, 4> result{};
    for (size_t k = 0; k < 4; ++k) {
      const double difference = b[k] - a[k];
      result[k] += a[k] + start * difference;
      if (k < 3) result[k + 1] += slope * difference;
    }
    return result;
  };
  return join(join(line[0], line[1], from.y, d.y), join(line[2], line[3], from.y, d.y), from.z, d.z);
}

/// Walks one ray through the tree.
class Walk {
 public:
  Walk(const State& state, const Accessor& accessor, const glm::dvec3& origin, const glm::dvec3& direction, double t_min, double t_max)
      : state_(state), accessor_(accessor), t_(t_min), t_max_(t_max) {
    ray_.origin = state.index_from_render.point(origin);
    ray_.direction = state.index_from_render.vector(direction);
    ray_.inverse = 1.0 / ray_.direction;
  }

  HitStatus run(double& t_hit) {
    if (!enter()) return HitStatus::miss;
    while (t_ < t_max_) {
      if (++steps_ > state_.max_steps) return HitStatus::out_of_steps;
      const nanovdb::Coord at(cell_.x, cell_.y, cell_.z);
      const Leaf* leaf = accessor_.probeLeaf(at);
      // getDim takes a ray that it does not look at.
      const int size = leaf ? Leaf::DIM : static_cast<int>(accessor_.getDim(at, 0));
      const Block block{{cell_.x & ~(size - 1), cell_.y & ~(size - 1), cell_.z & ~(size - 1)}, size};
      if (leaf) {
        const HitStatus status = walk_cells(block, t_hit);
        if (status != HitStatus::miss) return status;
        if (t_ >= t_max_) break;
      } else {
        known_ = false;
      }
      if (!leave(block)) return HitStatus::miss;
    }
    return HitStatus::miss;
  }

 private:
  /// Clips to the cells that may hold the surface; the first cell.
  bool enter() {
    double exit = t_max_;
    for (int axis = 0; axis < 3; ++axis) {
      const int lower = state_.lower[axis], upper = state_.upper[axis];
      if (ray_.direction[axis] == 0.0) {
        if (ray_.origin[axis] < lower || ray_.origin[axis] > upper) return false;
        continue;
      }
      const bool forward = ray_.direction[axis] > 0.0;
      t_ = std::max(t_, ray_.meets(axis, forward ? lower : upper));
      exit = std::min(exit, ray_.meets(axis, forward ? upper : lower));
    }
    if (!(t_ <= exit)) return false;
    const glm::dvec3 p = glm::floor(ray_.at(t_));
    cell_ = glm::ivec3(glm::clamp(p, glm::dvec3(state_.lower), glm::dvec3(state_.upper - 1)));
    return true;
  }

  /// To the cell beyond the face through which the ray leaves `block`. The crossed axis moves by whole numbers, the others stay within
  /// the block, so that every step makes headway whatever the rounding.
  bool leave(const Block& block) {
    const Exit exit = exit_of(ray_, block);
    if (!std::isfinite(exit.t)) return false;
    t_ = std::max(t_, exit.t);
    cell_ = cell_within(ray_, t_, block);
    // Only the axis just crossed tells that the range lies behind: on the others a ray that starts on the range's very border may stand
    // one cell outside it for no length at all.
    if (ray_.direction[exit.axis] > 0.0) {
      cell_[exit.axis] = block.lower[exit.axis] + block.size;
      return cell_[exit.axis] < state_.upper[exit.axis];
    }
    cell_[exit.axis] = block.lower[exit.axis] - 1;
    return cell_[exit.axis] >= state_.lower[exit.axis];
  }

  HitStatus walk_cells(const Block& leaf, double& t_hit) {
    while (true) {
      const Block cell{cell_, 1};
      const Exit exit = exit_of(ray_, cell);
      if (hit_in_cell(std::max(t_, std::min(exit.t, t_max_)), t_hit)) return t_hit < t_max_ ? HitStatus::hit : HitStatus::miss;
      t_ = std::max(t_, exit.t);
      if (t_ >= t_max_) return HitStatus::miss;
      glm::ivec3 next = cell_;
      next[exit.axis] += ray_.direction[exit.axis] > 0.0 ? 1 : -1;
      if (next[exit.axis] < leaf.lower[exit.axis] || next[exit.axis] >= leaf.lower[exit.axis] + leaf.size) return HitStatus::miss;
      cell_ = next;
      if (++steps_ > state_.max_steps) return HitStatus::out_of_steps;
    }
  }

  /// A change of sign in [t_, t1]. The side is carried from cell to cell: were it asked for anew at every face, a root that rounding
  /// puts on neither side of the face would be lost.
  bool hit_in_cell(double t1, double& t_hit) {
    std::array<double, 8> v = cell_values(accessor_, nanovdb::Coord(cell_.x, cell_.y, cell_.z));
    if (!state_.level.zero()) state_.subtract_level(cell_, v);
    bool any_inside = false, any_outside = false;
    for (const double value : v) (value < 0.0 ? any_inside : any_outside) = true;
    if (known_ && !(inside_ ? any_outside : any_inside)) return false;
    const glm::dvec3 corner(cell_), zero(0.0), one(1.0);
    const std::array<double, 4> c =
        cubic_along(v, glm::clamp(ray_.at(t_) - corner, zero, one), glm::clamp(ray_.at(t1) - corner, zero, one));
    if (!known_) {
      inside_ = c[0] < 0.0;
      known_ = true;
    }
    const double s = first_sign_change(c, inside_);
    if (s < 0.0) return false;
    t_hit = t_ + s * (t1 - t_);
    return true;
  }

  const State& state_;
  const Accessor& accessor_;
  IndexRay ray_;
  double t_, t_max_;
  glm::ivec3 cell_{0};
  bool inside_ = false;
  bool known_ = false;  ///< Whether inside_ has been told, since the ray came out of empty space.
  int steps_ = 0;
};

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

void trace(const void* opaque, const RayBatch& rays, HitBatch& hits) {
  const State& state = *static_cast<const State*>(opaque);
  const Accessor accessor = state.level_set.data().accessor();
  std::array<glm::dvec3, kRayBatchSize> points, gradients;
  std::array<int, kRayBatchSize> lanes;
  size_t count = 0;
  for (int i = 0; i < rays.count; ++i) {
    const glm::dvec3 origin(rays.origin(i)), direction(rays.direction(i));
    double t = 0.0;
    Walk walk(state, accessor, origin, direction, static_cast<double>(rays.t_min[i]), static_cast<double>(rays.t_max[i]));
    const HitStatus status = walk.run(t);
    if (status == HitStatus::miss) continue;
    hits.status[i] = status;
    if (status != HitStatus::hit) continue;
    hits.t[i] = static_cast<float>(t);
    hits.face[i] = -1;
    hits.material[i] = 0;
    points[count] = state.grid_world_from_render.point(origin + t * direction);
    lanes[count++] = i;
  }
  state.gradient->gradients(state.level_set.data(), std::span(points).first(count), std::span(gradients).first(count));
  for (size_t k = 0; k < count; ++k) {
    const int i = lanes[k];
    const glm::vec3 normal(unit_normal(state, gradients[k], points[k], glm::dvec3(rays.direction(i))));
    hits.normal_x[i] = normal.x;
    hits.normal_y[i] = normal.y;
    hits.normal_z[i] = normal.z;
  }
}

/// What a picture's tiles are traced with.
struct PictureState {
  std::shared_ptr<const BrickView> view;
  BrickTrace trace;
};

bool eye_inside(const State& state, const Camera& camera) {
  const glm::dvec3 eye = state.index_from_render.point(camera.eye);
  const CellPoint at = cell_point(eye);
  const std::array<double, 8> v = cell_values(state.level_set.data().accessor(), at.node);
  return cubic_along(v, at.local, at.local)[0] < 0.0;
}

SurfaceView view_picture(const std::shared_ptr<const void>& opaque, const ViewRequest& request) {
  const auto state = std::static_pointer_cast<const State>(opaque);
  if (!state->bricks) return {};
  auto picture = std::make_shared<PictureState>();
  picture->view = view_bricks(state->bricks, state->index_from_render, eye_inside(*state, request.camera), request);
  if (!picture->view) return {};
  picture->trace.view = picture->view.get();
  picture->trace.gradient = state->brick_gradient;
  const glm::dmat3 normal_from_index = state->normal_from_grid * glm::transpose(state->level_set.data().index_from_world.linear);
  for (int k = 0; k < 9; ++k) picture->trace.normal_from_index[k] = static_cast<float>(normal_from_index[k / 3][k % 3]);
  return {.state = picture,
          .touches = [](const void* p, const PixelTile& tile) { return touches(*static_cast<const PictureState*>(p)->view, tile); },
          .trace = [](const void* p, const PixelTile& tile, const RayBatch& rays,
                      HitBatch& hits) { trace_bricks(static_cast<const PictureState*>(p)->trace, tile, rays, hits); }};
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

CurvatureSource curvature_source(const std::shared_ptr<const State>& state) {
  const double needed = find_gradient("cubic").half_width_voxels, there = state->level_set.info().half_width_voxels;
  if (there >= needed - 1e-2) return {state, evaluate_curvatures, "Hessian of the cubic spline through the voxels"};
  return {{},
          nullptr,
          fmt::format("the band's half width of {:.2f} voxels is too thin for the cubic spline's Hessian: {:.2f} are needed "
                      "(--gradient cubic, or --half-width)",
                      there, needed)};
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
  auto state = std::make_shared<State>(State{.level_set = level_set,
                                             .gradient = &gradient,
                                             .index_from_render = compose(data.index_from_world, object_from_render),
                                             .grid_world_from_render = object_from_render,
                                             .normal_from_grid = glm::transpose(object_from_world.linear),
                                             .lower = glm::ivec3(0),
                                             .upper = glm::ivec3(0),
                                             .max_steps = max_steps,
                                             .level = level.width,
                                             .largest_level = 1.01 * level.largest_voxels * data.info.voxel_size,
                                             .grid_from_render_length = 1.0 / length_scale,
                                             .render_from_index = inverse(compose(data.index_from_world, object_from_render))});
  if (!cells.empty()) {
    state->lower = glm::ivec3(glm::floor(cells.lower));
    state->upper = glm::ivec3(glm::ceil(cells.upper));
  }
  const std::optional<BrickGradient> packed = brick_gradient(gradient);
  if (level.width.zero() && packed) {
    state->brick_gradient = *packed;
    state->bricks = make_bricks(level_set, *packed == BrickGradient::cubic);
  }
  Surface surface;
  surface.trace = trace;
  surface.view = view_picture;
  const Box world = transform(world_from_object, transform(data.info.world_from_index, cells));
  surface.bounds = {world.lower - render_origin, world.upper - render_origin};
  surface.info.voxel_size = data.info.voxel_size * length_scale;
  surface.info.voxels = data.info.active_voxels;
  surface.info.bytes = data.info.bytes;
  surface.info.build_ms = data.info.build_ms;
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
