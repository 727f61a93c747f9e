#include "raymarch/local/local_marcher.h"

#include <algorithm>
#include <chrono>

#include "raymarch/level_set/sized_bricks.h"
#include "raymarch/local/local_nodes.h"
#include "raymarch/local/mesh_part.h"
#include "raymarch/scene/curvature.h"
#include "sdf/error.h"
#include "sdf/local_grid.h"

namespace limn {
namespace {

void evaluate_curvatures(const void* opaque, std::span<const SurfacePoint> points, std::span<SurfaceCurvature> curvatures) {
  FieldEvaluator evaluator(*static_cast<const Field*>(opaque));
  for (size_t i = 0; i < points.size(); ++i) curvatures[i] = facing(curvature_of_jet(evaluator.jet(points[i].position)), points[i].normal);
}

/// `origin`: of the lattices, in the space of the surface.
std::shared_ptr<const RayBricks> bricks_of_level(const LevelNodes& nodes, const LocalChoice& choice, size_t level, const glm::dvec3& origin,
                                                 double half_width_voxels, BrickGradient gradient) {
  if (nodes.blocks.empty()) return nullptr;
  std::vector<BrickPlace> places;
  for (const LocalBrick& brick : choice.levels[level]) places.push_back({8 * brick.place, brick.covered, &nodes.crossed[places.size()]});
  const double h = choice.voxel_of(level);
  return bricks_of_size(nodes.reader(), places, {h, half_width_voxels, nodes.steps_per_unit, {glm::dmat3(h), origin}}, gradient,
                        [&] { return level_set_of(nodes, choice, level, half_width_voxels, "surface"); });
}

/// Of one choice of bricks. `part_origin`: where the origin of `whole` stands in the space of the surface.
Surface surface_of(const SurfacePart& whole, const LocalBrickSettings& settings, const glm::dvec3& part_origin) {
  auto state = std::make_shared<LocalBricks>();
  state->sides = [whole, part_origin] {
    const auto evaluator = std::make_shared<PartEvaluator>(whole);
    return [evaluator, part_origin](const glm::dvec3& place) { return evaluator->is_inside(place - part_origin); };
  };
  state->gradient = brick_gradient(*settings.gradient);
  const double half_width_voxels = settings.half_width_voxels;
  const LocalChoice choice = choose_bricks(whole, settings);
  Surface surface;
  std::vector<std::shared_ptr<const RayBricks>> bricks(choice.levels.size());
  sample_bricks(choice, *settings.gradient, half_width_voxels, [&](size_t level, const LevelNodes& nodes) {
    surface.info.voxels += nodes.known();
    bricks[level] = bricks_of_level(nodes, choice, level, choice.origin + part_origin, half_width_voxels, state->gradient);
  });
  for (size_t level = 0; level < bricks.size(); ++level) {
    if (!bricks[level]) continue;
    if (surface.info.voxel_size == 0.0) surface.info.voxel_size = choice.voxel_of(level);
    add_size(bricks[level], *state, surface.info);
  }
  if (state->sizes.empty())
    throw InputError({.file = {},
                      .field = "voxel size",
                      .value = std::to_string(settings.voxel_size),
                      .problem = "no voxel lies inside the surface: it is thinner than a voxel, or empty",
                      .expected = "smaller voxels"});
  if (const Field* const field = std::get_if<Field>(&whole))
    surface.curvature = {std::make_shared<const Field>(*field), evaluate_curvatures,
                         "Hessian of the field that the voxels were sampled from"};
  set_traced(std::move(state), surface);
  return surface;
}

/// Bricks as fine as any part of the surface has to be.
Surface coarse_surface(const SurfacePart& whole, const LocalBrickSettings& settings) {
  LocalBrickSettings coarse = settings;
  coarse.border = false;
  coarse.half_width_voxels = std::min(settings.half_width_voxels, 2.0);
  coarse.gradient = &find_gradient("cell");
  return surface_of(whole, coarse, glm::dvec3(0.0));
}

/// For more pictures than this bricks that are made once are quicker than to ask a field for each.
constexpr size_t kFewPictures = 32;

/// Draws what hides what in a picture. A field tells it itself, and so do the facets of a mesh that is closed: bricks would have to be made
/// for that alone, as they are for many pictures and where a mesh has holes that its level set closes.
std::function<SmallPicture(const Camera&)> hiding(const SurfacePart& whole, const LocalBrickSettings& settings) {
  const auto traced = [](Surface surface) {
    return [surface = std::move(surface)](const Camera& camera) { return small_picture(surface, camera); };
  };
  if (const Field* const field = std::get_if<Field>(&whole)) {
    if (settings.local.cameras.size() > kFewPictures) return traced(coarse_surface(whole, settings));
    return traced(find_surface("analytic").build({.name = "whole", .source = *field}, {}, glm::dvec3(0.0)));
  }
  const MeshPart& mesh = std::get<MeshPart>(whole);
  prepare_trees(mesh, settings.half_width_voxels);
  if (mesh.body->length_of_holes() == 0.0 && mesh.body->warnings().empty())
    return [body = mesh.body](const Camera& camera) { return small_picture(body->mesh(), camera); };
  return traced(coarse_surface(whole, settings));
}

LocalBrickSettings with_hidden(const SurfacePart& whole, const LocalBrickSettings& settings) {
  const std::function<SmallPicture(const Camera&)> picture_of = hiding(whole, settings);
  LocalBrickSettings result = settings;
  for (const Camera& camera : settings.local.cameras) result.hidden.push_back(picture_of(camera));
  return result;
}

/// Files hold no grid without a surface.
bool has_both_signs(const LevelNodes& nodes) {
  bool inside = false, outside = false;
  for (size_t i = 0; i < nodes.blocks.size(); ++i) {
    const NodeBlock& block = nodes.blocks[i];
    for (size_t n = 0; n < 512; ++n)
      if (block.is_known(n)) (block.step(n) < 0 ? inside : outside) = true;
  }
  return inside && outside;
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
  const LocalChoice choice = choose_bricks(whole, with_hidden(whole, settings));
  const std::vector<LevelNodes> levels = sample_bricks(choice, *settings.gradient, settings.half_width_voxels);
  std::vector<size_t> there;
  for (size_t level = 0; level < levels.size(); ++level)
    if (has_both_signs(levels[level])) there.push_back(level);
  const Box bounds = bounds_of(whole);
  // Beyond the bounds, which hold the surface, all is on one side.
  const bool beyond = PartEvaluator(whole).is_inside(bounds.upper + bounds.longest_side());
  const auto inside = [&](const glm::dvec3& place) {
    const bool within = glm::all(glm::greaterThanEqual(place, bounds.lower)) && glm::all(glm::lessThanEqual(place, bounds.upper));
    return within ? PartEvaluator(whole).is_inside(place) : beyond;
  };
  std::vector<LevelSet> grids;
  for (const size_t level : there) {
    LocalGrid said{.object = name,
                   .size = static_cast<int>(grids.size()),
                   .sizes = static_cast<int>(there.size()),
                   .gradient = settings.gradient->about.name,
                   .half_width = settings.half_width_voxels * choice.voxel_of(level),
                   .bounds = {bounds.lower + part_origin, bounds.upper + part_origin}};
    for (const LocalBrick& brick : choice.levels[level]) said.bricks.push_back(brick.place);
    const FiledLevel filed{inside, local_metadata(said), part_origin};
    grids.push_back(level_set_of(levels[level], choice, level, settings.half_width_voxels, name + "_" + std::to_string(level), &filed));
  }
  return grids;
}

}  // namespace limn
