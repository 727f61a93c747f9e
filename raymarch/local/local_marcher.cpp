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
#include "sdf/local_grid.h"
#include "sdf/shape.h"

namespace limn {
namespace {

struct State {
  std::optional<SurfacePart> whole{};  ///< Empty where a file has the bricks.
  glm::dvec3 part_origin{0.0};         ///< Render space: where the origin of `whole` stands.
  std::optional<LevelSet> largest{};   ///< Of a file: the grid of the largest voxels, which holds the whole surface.
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
  if (!state.whole) {
    const RayBricks& of_largest = *state.sizes.back().bricks;
    const glm::ivec3 node(glm::round(inverse(of_largest.world_from_index).point(point)));
    return state.largest->data().accessor().getValue(nanovdb::Coord(node.x, node.y, node.z)) < 0.0f;
  }
  if (!evaluator) evaluator.emplace(*state.whole);
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
  FieldEvaluator evaluator(std::get<Field>(*static_cast<const State*>(opaque)->whole));
  for (size_t i = 0; i < points.size(); ++i) curvatures[i] = facing(curvature_of_jet(evaluator.jet(points[i].position)), points[i].normal);
}

/// The bricks of one size; `grid()` makes what a spline is made from. Null where the surface crosses none of them.
template <class Grid>
std::shared_ptr<const RayBricks> ray_bricks(const NodeReader& nodes, std::span<const BrickPlace> places, float steps_per_unit,
                                            double voxel_size, double half_width_voxels, const Affine& render_from_index, bool spline,
                                            const Grid& grid_of) {
  const std::shared_ptr<RayBricks> bricks = make_bricks(nodes, places, steps_per_unit);
  if (!bricks || (spline && bricks->neighbors.size() > kMostSplineBricks))
    throw InputError({.file = {},
                      .field = "voxel size",
                      .value = std::to_string(voxel_size),
                      .problem = "more bricks than 31 bits number",
                      .expected = "larger voxels or a larger tolerance"});
  if (bricks->groups.empty()) return nullptr;
  bricks->voxel_size = voxel_size;
  bricks->half_width_voxels = half_width_voxels;
  bricks->world_from_index = render_from_index;
  if (spline) {
    const LevelSet grid = grid_of();
    std::vector<glm::ivec3> origins;
    for (const SurfaceBound& bound : bricks->groups.front().bounds) origins.emplace_back(bound.origin[0], bound.origin[1], bound.origin[2]);
    bricks->spline = make_spline_bricks(grid.data(), origins);
  }
  return bricks;
}

std::shared_ptr<const RayBricks> ray_bricks(const LevelNodes& nodes, const LocalChoice& choice, size_t level, double half_width_voxels,
                                            bool spline) {
  if (nodes.blocks.empty()) return nullptr;
  std::vector<BrickPlace> places;
  for (const LocalBrick& brick : choice.levels[level]) places.push_back({8 * brick.place, brick.covered});
  const double h = choice.voxel_of(level);
  return ray_bricks(nodes.reader(), places, nodes.steps_per_unit, h, half_width_voxels, {glm::dmat3(h), choice.origin}, spline,
                    [&] { return level_set_of(nodes, choice, level, half_width_voxels, "surface"); });
}

void add(const std::shared_ptr<const RayBricks>& bricks, State& state, SurfaceInfo& info) {
  SingleRayBricks size = for_single_rays(bricks, inverse(bricks->world_from_index));
  state.bounds = merge(state.bounds, transform(bricks->world_from_index, {glm::dvec3(bricks->lower), glm::dvec3(bricks->upper)}));
  info.ray_bytes += bricks->bytes() + size.tree.bytes();
  info.prepare_ms += bricks->prepare_ms;
  state.sizes.push_back(std::move(size));
}

void set_traced(const State& state, Surface& surface) {
  surface.trace = trace;
  surface.view = view_picture;
  surface.bounds = state.bounds;
  surface.info.bytes = surface.info.ray_bytes;
}

/// Of one choice of bricks. `part_origin`: where the origin of `whole` stands in the space of the surface.
Surface surface_of(const SurfacePart& whole, const LocalBrickSettings& settings, const glm::dvec3& part_origin) {
  auto state = std::make_shared<State>();
  state->whole = whole;
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
  set_traced(*state, surface);
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

/// Files hold no grid without a surface.
bool has_both_signs(const LevelNodes& nodes) {
  bool inside = false, outside = false;
  for (const NodeBlock& block : nodes.blocks)
    for (size_t n = 0; n < 512; ++n)
      if ((block.known[n >> 6] >> (n & 63) & 1) != 0) (block.values[n] < 0.0f ? inside : outside) = true;
  return inside && outside;
}

/// All grids of a local level set, and what the file says of each.
struct FileGrids {
  std::vector<LevelSet> grids;
  const std::vector<LocalGrid>& said;
};

[[noreturn]] void refuse(const LevelSet& grid, const std::string& file, const std::string& problem) {
  throw InputError({file, "grid", grid.info().name, problem, "a file as limn export --local writes it"});
}

/// How often the smallest voxels are doubled in a grid, whose lattice must be theirs.
int doublings_of(const LevelSet& grid, const LevelSet& smallest, const std::string& file) {
  const Affine &map = grid.info().world_from_index, &finest = smallest.info().world_from_index;
  const double times = glm::length(map.linear[0]) / glm::length(finest.linear[0]);
  const auto doublings = static_cast<int>(std::lround(std::log2(std::clamp(times, 1.0, 1e9))));
  const double scale = std::exp2(doublings), tolerance = 1e-9 * scale * glm::length(finest.linear[0]);
  bool same = glm::distance(map.translation, finest.translation) <= 1e-3 * tolerance + 1e-9 * glm::length(finest.linear[0]);
  for (int axis = 0; axis < 3; ++axis) same = same && glm::distance(map.linear[axis], scale * finest.linear[axis]) <= tolerance;
  if (!same) refuse(grid, file, "its voxels do not lie on the lattice of '" + smallest.info().name + "', of the same local level set");
  return doublings;
}

/// What smaller bricks hold of each: they lie in bricks of the next size.
std::vector<std::vector<BrickPlace>> places_of(const FileGrids& volume, const std::vector<int>& doublings, const std::string& file) {
  std::vector<std::vector<BrickPlace>> places;
  for (size_t k = 0; k < volume.said.size(); ++k) {
    KeyNumbers at;
    places.emplace_back();
    for (const glm::ivec3& place : volume.said[k].bricks) at.add(key_of(8 * place)), places.back().push_back({8 * place, 0});
    if (k == 0) continue;
    const int step = doublings[k] - doublings[k - 1];
    if (step != 1 && step != 2) refuse(volume.grids[k], file, "its voxels are not two or four times those of the size before");
    for (const glm::ivec3& smaller : volume.said[k - 1].bricks) {
      const size_t number = at.find(key_of(8 * (smaller >> step)));
      if (number == KeyNumbers::kNone)
        refuse(volume.grids[k], file, "no brick of it holds one of '" + volume.grids[k - 1].info().name + "'");
      places.back()[number].covered |= covered_by(smaller & ((1 << step) - 1), step);
    }
  }
  return places;
}

NodeReader reader_of(const LevelSetData& data) {
  return {&data,
          [](const void* of, const glm::ivec3& origin, NodeValues& values) {
            load_nodes(static_cast<const LevelSetData*>(of)->accessor(), origin, values);
          },
          [](const void* of, const glm::ivec3& node, const void*&) {
            const auto accessor = static_cast<const LevelSetData*>(of)->accessor();
            const nanovdb::Coord at(node.x, node.y, node.z);
            return accessor.isActive(at) ? accessor.getValue(at) : std::numeric_limits<float>::max();
          }};
}

/// All nodes of all bricks have values.
void check_nodes(const LevelSet& grid, std::span<const BrickPlace> places, const std::string& file) {
  const auto accessor = grid.data().accessor();
  for (const BrickPlace& place : places)
    for (int k = 0; k < 729; ++k)
      if (!accessor.isActive(nanovdb::Coord(place.origin.x + k / 81, place.origin.y + k / 9 % 9, place.origin.z + k % 9)))
        refuse(grid, file, "it lacks nodes of its bricks");
}

}  // namespace

Surface local_level_set_of_file(const LevelSet& local, const GradientDescriptor& gradient, const glm::dvec3& render_origin,
                                const std::string& file) {
  const auto started = std::chrono::steady_clock::now();
  const FileGrids volume{grids_of(local), local_volume(local)->said};
  auto state = std::make_shared<State>();
  state->gradient = brick_gradient(gradient);
  state->largest = volume.grids.back();
  const std::string& made_for = volume.said.front().gradient;
  if (find_gradient(made_for, file, "gradient").half_width_voxels < gradient.half_width_voxels)
    throw InputError({file, "gradient", gradient.about.name,
                      "its bricks hold no more nodes than the gradient '" + made_for + "' reads, for which they were made", made_for});
  std::vector<int> doublings;
  for (const LevelSet& grid : volume.grids) doublings.push_back(doublings_of(grid, volume.grids.front(), file));
  const std::vector<std::vector<BrickPlace>> places = places_of(volume, doublings, file);
  Surface surface;
  for (size_t k = 0; k < volume.grids.size(); ++k) {
    const LevelSet& grid = volume.grids[k];
    const LevelSetInfo& info = grid.info();
    check_nodes(grid, places[k], file);
    surface.info.voxels += info.active_voxels;
    const double half_width = volume.said[k].half_width;
    // As wide as a band can be asked for; the steps of 16 bits are counted by it.
    if (!(half_width > info.voxel_size && half_width < 1001.0 * info.voxel_size)) refuse(grid, file, "its band is not as wide as it says");
    Affine render_from_index = info.world_from_index;
    render_from_index.translation -= render_origin;
    const auto bricks =
        ray_bricks(reader_of(grid.data()), places[k], static_cast<float>(32767.0 / half_width), info.voxel_size,
                   half_width / info.voxel_size, render_from_index, state->gradient == BrickGradient::cubic, [&] { return grid; });
    if (!bricks) continue;
    if (surface.info.voxel_size == 0.0) surface.info.voxel_size = info.voxel_size;
    add(bricks, *state, surface.info);
  }
  if (state->sizes.empty() || state->sizes.size() > kMostBrickSizes) refuse(volume.grids.front(), file, "its bricks hold no surface");
  set_traced(*state, surface);
  surface.curvature.from = "a file's local level set has no curvature of its own";
  surface.state = std::move(state);
  surface.info.build_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - started).count();
  return surface;
}

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
  std::vector<size_t> there;
  for (size_t level = 0; level < levels.size(); ++level)
    if (has_both_signs(levels[level])) there.push_back(level);
  const Box bounds = bounds_of(whole);
  std::vector<LevelSet> grids;
  for (const size_t level : there) {
    LocalGrid said{.object = name,
                   .size = static_cast<int>(grids.size()),
                   .sizes = static_cast<int>(there.size()),
                   .gradient = settings.gradient->about.name,
                   .half_width = settings.half_width_voxels * choice.voxel_of(level),
                   .bounds = {bounds.lower + part_origin, bounds.upper + part_origin}};
    for (const LocalBrick& brick : choice.levels[level]) said.bricks.push_back(brick.place);
    grids.push_back(level_set_of(levels[level], choice, level, settings.half_width_voxels, name + "_" + std::to_string(level), inside,
                                 local_metadata(said)));
  }
  return grids;
}

}  // namespace limn
