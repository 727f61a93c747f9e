#include "raymarch/level_set/sized_bricks.h"

#include <algorithm>
#include <optional>

#include "sdf/error.h"
#include "sdf/level_set_data.h"

namespace limn {
namespace {

/// The interpolant's sign at a place (index coordinates) in a cell that is kept; nothing elsewhere.
std::optional<bool> inside_brick(const RayBricks& bricks, const glm::dvec3& place) {
  const glm::dvec3 node = glm::floor(place), local = place - node;
  const glm::ivec3 cell(node), origin = cell & ~7;
  const std::vector<SurfaceBound>& bounds = bricks.groups.front().bounds;
  const auto key = [](const SurfaceBound& b) { return key_of({b.origin[0], b.origin[1], b.origin[2]}); };
  const auto found =
      std::lower_bound(bounds.begin(), bounds.end(), key_of(origin), [&](const SurfaceBound& b, std::uint64_t k) { return key(b) < k; });
  if (found == bounds.end() || key(*found) != key_of(origin)) return std::nullopt;
  const glm::ivec3 in_brick = cell - origin;
  const auto brick = static_cast<size_t>(found - bounds.begin());
  if (!bricks.keeps(brick, in_brick.x << 6 | in_brick.y << 3 | in_brick.z)) return std::nullopt;
  double sum = 0.0;
  for (int k = 0; k < 8; ++k) {
    const glm::ivec3 side(k & 1, k >> 1 & 1, k >> 2), at = in_brick + side;
    const glm::dvec3 weight = glm::mix(1.0 - local, local, glm::dvec3(side));
    sum += weight.x * weight.y * weight.z * static_cast<double>(bricks.value(brick, brick_element(at.x, at.y, at.z)));
  }
  return sum < 0.0;
}

using Side = std::function<bool(const glm::dvec3&)>;

/// Beside the bricks the surface is not near, and what they were made of tells. `side`: empty, or as it was left.
bool is_inside(const LocalBricks& state, const glm::dvec3& point, Side& side) {
  if (glm::any(glm::lessThan(point, state.bounds.lower)) || glm::any(glm::greaterThan(point, state.bounds.upper))) return false;
  for (const SingleRayBricks& size : state.sizes)
    if (const auto inside = inside_brick(*size.bricks, size.outside.index_from_render.point(point))) return *inside;
  if (!side) side = state.sides();
  return side(point);
}

void trace(const void* opaque, const RayBatch& rays, HitBatch& hits) {
  const LocalBricks& state = *static_cast<const LocalBricks*>(opaque);
  Side side;
  std::vector<const SingleRayBricks*> sizes;
  for (const SingleRayBricks& size : state.sizes) sizes.push_back(&size);
  trace_single_rays(
      sizes, {.gradient = state.gradient}, [&](const glm::dvec3& place) { return is_inside(state, place, side); }, rays, hits);
}

struct PictureState {
  std::vector<std::shared_ptr<const BrickView>> views;
  std::vector<BrickTrace> sizes;
};

SurfaceView view_picture(const std::shared_ptr<const void>& opaque, const ViewRequest& request) {
  const auto state = std::static_pointer_cast<const LocalBricks>(opaque);
  auto picture = std::make_shared<PictureState>();
  Side side;
  const bool inside = is_inside(*state, request.camera.eye, side);
  for (const SingleRayBricks& size : state->sizes) {
    picture->views.push_back(view_bricks(size.bricks, size.outside.index_from_render, inside, request));
    if (!picture->views.back()) return {};
    picture->sizes.push_back({.view = picture->views.back().get(), .gradient = state->gradient});
  }
  return {.state = picture,
          .touches =
              [](const void* p, const PixelTile& tile) {
                const auto& views = static_cast<const PictureState*>(p)->views;
                return std::any_of(views.begin(), views.end(), [&](const auto& view) { return touches(*view, tile); });
              },
          .trace = [](const void* p, const PixelTile& tile, const RayBatch& rays,
                      HitBatch& hits) { trace_bricks(static_cast<const PictureState*>(p)->sizes, tile, rays, hits); }};
}

}  // namespace

BrickGradient brick_gradient(const GradientDescriptor& gradient) {
  if (gradient.about.name == "cell") return BrickGradient::cell;
  if (gradient.about.name == "central") return BrickGradient::central;
  if (gradient.about.name == "cubic") return BrickGradient::cubic;
  throw InputError({.file = {},
                    .field = "gradient",
                    .value = gradient.about.name,
                    .problem = "a local level set does not have it",
                    .expected = "cell, central or cubic, or a level set of one voxel size"});
}

std::shared_ptr<const RayBricks> bricks_of_size(const NodeReader& nodes, std::span<const BrickPlace> places, const BrickSize& size,
                                                BrickGradient gradient, const std::function<LevelSet()>& grid) {
  const bool spline = gradient == BrickGradient::cubic;
  const std::shared_ptr<RayBricks> bricks = make_bricks(nodes, places, size.steps_per_unit);
  if (!bricks || (spline && bricks->neighbors.size() > kMostSplineBricks))
    throw InputError({.file = {},
                      .field = "voxel size",
                      .value = std::to_string(size.voxel_size),
                      .problem = "more bricks than 31 bits number",
                      .expected = "larger voxels or a larger tolerance"});
  if (bricks->groups.empty()) return nullptr;
  bricks->voxel_size = size.voxel_size;
  bricks->half_width_voxels = size.half_width_voxels;
  bricks->world_from_index = size.render_from_index;
  if (spline) {
    const LevelSet of_spline = grid();
    std::vector<glm::ivec3> origins;
    for (const SurfaceBound& bound : bricks->groups.front().bounds) origins.emplace_back(bound.origin[0], bound.origin[1], bound.origin[2]);
    bricks->spline = make_spline_bricks(of_spline.data(), origins);
  }
  return bricks;
}

void add_size(const std::shared_ptr<const RayBricks>& bricks, LocalBricks& state, SurfaceInfo& info) {
  SingleRayBricks size = for_single_rays(bricks, inverse(bricks->world_from_index));
  state.bounds = merge(state.bounds, transform(bricks->world_from_index, {glm::dvec3(bricks->lower), glm::dvec3(bricks->upper)}));
  info.ray_bytes += bricks->bytes() + size.tree.bytes();
  info.prepare_ms += bricks->prepare_ms;
  state.sizes.push_back(std::move(size));
}

void set_traced(std::shared_ptr<const LocalBricks> local, Surface& surface) {
  LIMN_CHECK(!local->sizes.empty() && local->sizes.size() <= kMostBrickSizes);
  surface.trace = trace;
  surface.view = view_picture;
  surface.bounds = local->bounds;
  surface.info.bytes = surface.info.ray_bytes;
  surface.state = std::move(local);
}

}  // namespace limn
