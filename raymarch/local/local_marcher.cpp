#include "raymarch/local/local_marcher.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "raymarch/level_set/brick_layout.h"
#include "raymarch/level_set/single_rays.h"
#include "raymarch/local/local_nodes.h"
#include "raymarch/local/mesh_part.h"
#include "raymarch/scene/curvature.h"
#include "sdf/error.h"
#include "sdf/level_set_data.h"
#include "sdf/shape.h"

namespace limn {
namespace {

struct State {
  explicit State(SurfacePart of) : whole(std::move(of)) {}
  SurfacePart whole;
  glm::dvec3 part_origin{0.0};  ///< Render space: where the origin of `whole` stands.
  BrickGradient gradient = BrickGradient::central;
  std::vector<SingleRayBricks> sizes{};  ///< The smallest voxels first.
  Box bounds{};                          ///< Render space.
};

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

/// The interpolant's sign in the brick that holds the place (index coordinates); nothing where no brick does.
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
  if (!bricks.covered.empty() && (bricks.covered[brick] >> covered_bit(in_brick.x, in_brick.y, in_brick.z) & 1) != 0) return std::nullopt;
  const std::int16_t* const values = bricks.values.data() + brick * kBrickStride;
  double sum = 0.0;
  for (int k = 0; k < 8; ++k) {
    const glm::ivec3 side(k & 1, k >> 1 & 1, k >> 2), at = in_brick + side;
    const glm::dvec3 weight = glm::mix(1.0 - local, local, glm::dvec3(side));
    sum += weight.x * weight.y * weight.z * static_cast<double>(values[brick_element(at.x, at.y, at.z)]);
  }
  return sum < 0.0;
}

/// Beside the bricks the surface is not near, and what they were made of tells.
bool is_inside(const State& state, const glm::dvec3& point, std::optional<PartEvaluator>& evaluator) {
  if (glm::any(glm::lessThan(point, state.bounds.lower)) || glm::any(glm::greaterThan(point, state.bounds.upper))) return false;
  for (const SingleRayBricks& size : state.sizes)
    if (const auto inside = inside_brick(*size.bricks, size.outside.index_from_render.point(point))) return *inside;
  if (!evaluator) evaluator.emplace(state.whole);
  return evaluator->is_inside(point - state.part_origin);
}

void trace(const void* opaque, const RayBatch& rays, HitBatch& hits) {
  const State& state = *static_cast<const State*>(opaque);
  std::optional<PartEvaluator> evaluator;
  std::vector<const SingleRayBricks*> sizes;
  for (const SingleRayBricks& size : state.sizes) sizes.push_back(&size);
  trace_single_rays(
      sizes, {.gradient = state.gradient}, [&](const glm::dvec3& place) { return is_inside(state, place, evaluator); }, rays, hits);
}

struct PictureState {
  std::vector<std::shared_ptr<const BrickView>> views;
  std::vector<BrickTrace> sizes;
};

SurfaceView view_picture(const std::shared_ptr<const void>& opaque, const ViewRequest& request) {
  const auto state = std::static_pointer_cast<const State>(opaque);
  auto picture = std::make_shared<PictureState>();
  std::optional<PartEvaluator> evaluator;
  const bool inside = is_inside(*state, request.camera.eye, evaluator);
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

void evaluate_curvatures(const void* opaque, std::span<const SurfacePoint> points, std::span<SurfaceCurvature> curvatures) {
  FieldEvaluator evaluator(std::get<Field>(static_cast<const State*>(opaque)->whole));
  for (size_t i = 0; i < points.size(); ++i) curvatures[i] = facing(curvature_of_jet(evaluator.jet(points[i].position)), points[i].normal);
}

/// Null where the surface crosses none of the chosen bricks of that size.
std::shared_ptr<const RayBricks> ray_bricks(const LevelNodes& nodes, const LocalChoice& choice, size_t level, double half_width_voxels,
                                            bool spline) {
  if (nodes.blocks.empty()) return nullptr;
  std::vector<BrickPlace> places;
  for (const LocalBrick& brick : choice.levels[level]) places.push_back({8 * brick.place, brick.covered});
  const std::shared_ptr<RayBricks> bricks = make_bricks(nodes.reader(), places, nodes.steps_per_unit);
  if (!bricks || (spline && bricks->neighbors.size() > kMostSplineBricks))
    throw InputError({.file = {},
                      .field = "voxel size",
                      .value = std::to_string(choice.voxel_of(level)),
                      .problem = "more bricks than 31 bits number",
                      .expected = "larger voxels or a larger tolerance"});
  if (bricks->groups.empty()) return nullptr;
  bricks->voxel_size = choice.voxel_of(level);
  bricks->half_width_voxels = half_width_voxels;
  bricks->world_from_index = {glm::dmat3(bricks->voxel_size), choice.origin};
  if (spline) {
    const LevelSet grid = level_set_of(nodes, choice, level, half_width_voxels, "surface");
    std::vector<glm::ivec3> origins;
    for (const SurfaceBound& bound : bricks->groups.front().bounds) origins.emplace_back(bound.origin[0], bound.origin[1], bound.origin[2]);
    bricks->spline = make_spline_bricks(grid.data(), origins);
  }
  return bricks;
}

void add(const std::shared_ptr<const RayBricks>& bricks, State& state, SurfaceInfo& info) {
  SingleRayBricks size = for_single_rays(bricks, inverse(bricks->world_from_index));
  state.bounds = merge(state.bounds, transform(bricks->world_from_index, {glm::dvec3(bricks->lower), glm::dvec3(bricks->upper)}));
  info.ray_bytes += bricks->bytes() + size.tree.bytes();
  info.prepare_ms += bricks->prepare_ms;
  state.sizes.push_back(std::move(size));
}

/// Of one choice of bricks. `part_origin`: where the origin of `whole` stands in the space of the surface.
Surface surface_of(const SurfacePart& whole, const LocalBrickSettings& settings, const glm::dvec3& part_origin) {
  auto state = std::make_shared<State>(whole);
  state->part_origin = part_origin;
  state->gradient = brick_gradient(*settings.gradient);
  const double half_width_voxels = settings.half_width_voxels;
  LocalChoice choice = choose_bricks(whole, settings);
  std::vector<LevelNodes> levels = sample_bricks(choice, *settings.gradient, half_width_voxels);
  choice.origin += part_origin;
  Surface surface;
  for (size_t level = 0; level < levels.size(); ++level) {
    surface.info.voxels += levels[level].known();
    if (auto bricks = ray_bricks(levels[level], choice, level, half_width_voxels, state->gradient == BrickGradient::cubic)) {
      if (surface.info.voxel_size == 0.0) surface.info.voxel_size = choice.voxel_of(level);
      add(bricks, *state, surface.info);
    }
    levels[level] = {};
  }
  LIMN_CHECK(state->sizes.size() <= kMostBrickSizes);
  if (state->sizes.empty())
    throw InputError({.file = {},
                      .field = "voxel size",
                      .value = std::to_string(settings.voxel_size),
                      .problem = "no voxel lies inside the surface: it is thinner than a voxel, or empty",
                      .expected = "smaller voxels"});
  surface.trace = trace;
  surface.view = view_picture;
  surface.bounds = state->bounds;
  surface.info.bytes = surface.info.ray_bytes;
  if (std::holds_alternative<Field>(whole))
    surface.curvature = {state, evaluate_curvatures, "Hessian of the field that the voxels were sampled from"};
  surface.state = std::move(state);
  return surface;
}

/// With what a coarse surface hides in the pictures.
LocalBrickSettings with_hidden(const SurfacePart& whole, const LocalBrickSettings& settings) {
  if (const MeshPart* const mesh = std::get_if<MeshPart>(&whole)) prepare_trees(*mesh, settings.half_width_voxels);
  LocalBrickSettings result = settings;
  result.border = false;
  result.half_width_voxels = std::min(settings.half_width_voxels, 2.0);
  const GradientDescriptor& cell = find_gradient("cell");
  result.gradient = &cell;
  const Surface coarse = surface_of(whole, result, glm::dvec3(0.0));
  for (const Camera& camera : settings.local.cameras) result.hidden.push_back(small_picture(coarse, camera));
  result.border = true;
  result.half_width_voxels = settings.half_width_voxels;
  result.gradient = settings.gradient;
  return result;
}

}  // namespace

Surface local_level_set(const SurfacePart& whole, const LocalBrickSettings& settings, const glm::dvec3& part_origin) {
  const auto started = std::chrono::steady_clock::now();
  Surface surface = surface_of(whole, with_hidden(whole, settings), part_origin);
  surface.info.build_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - started).count();
  return surface;
}

std::vector<LevelSet> local_level_set_grids(const SurfacePart& whole, const LocalBrickSettings& settings, const std::string& name,
                                            const glm::dvec3& part_origin) {
  LocalChoice choice = choose_bricks(whole, with_hidden(whole, settings));
  const std::vector<LevelNodes> levels = sample_bricks(choice, *settings.gradient, settings.half_width_voxels);
  choice.origin += part_origin;
  const auto inside = [&](const glm::dvec3& place) { return PartEvaluator(whole).is_inside(place - part_origin); };
  std::vector<LevelSet> grids;
  for (size_t level = 0; level < levels.size(); ++level)
    if (!levels[level].blocks.empty())
      grids.push_back(level_set_of(levels[level], choice, level, settings.half_width_voxels, name + "_" + std::to_string(level), inside));
  return grids;
}

}  // namespace limn
