// Local level sets of meshes: at shared nodes the values of the uniform level set of their smallest voxels, its border, and no hit through
// it.

#include <gtest/gtest.h>

#include <random>

#include "raymarch/level_set/bricks.h"
#include "raymarch/surface/object_mesh.h"
#include "samples/experiment/job.h"
#include "samples/experiment/local_request.h"
#include "samples/scenes/scenes.h"
#include "sdf/error.h"
#include "sdf/level_set_data.h"
#include "sdf/shape.h"
#include "subdiv/mesh_level_set.h"
#include "tests/local_check.h"
#include "tests/random_seed.h"
#include "tests/samples/scene_camera.h"

namespace limn {
namespace {

/// A small tolerance: the border takes the smallest voxels.
constexpr double kFinest_px = 1e-6;

const SurfaceSettings kSettings{.kind = "mesh_level_set", .voxels = 240, .level = 2};

Scene scene_of(Mesh mesh) {
  Scene scene;
  scene.objects.push_back({.name = "mesh", .source = MeshSource{std::move(mesh)}});
  return scene;
}

/// A tessellated ellipsoid; `open`: with a hole of a few faces.
Scene ellipsoid_mesh(bool open) {
  const Scene shape = find_scene("ellipsoid")->make();
  Mesh mesh = tessellate(std::get<Field>(shape.objects.front().source), {.level = 2});
  mesh.corner_normals.clear();
  if (open) {
    // All faces about one vertex.
    Mesh rest = mesh;
    rest.face_sizes.clear(), rest.corner_vertices.clear();
    size_t corner = 0;
    for (const std::int32_t size : mesh.face_sizes) {
      glm::dvec3 middle(0.0);
      for (size_t k = 0; k < static_cast<size_t>(size); ++k)
        middle += mesh.positions[static_cast<size_t>(mesh.corner_vertices[corner + k])] / static_cast<double>(size);
      if (glm::distance(middle, mesh.positions.front()) > 0.25) {
        rest.face_sizes.push_back(size);
        for (size_t k = 0; k < static_cast<size_t>(size); ++k) rest.corner_vertices.push_back(mesh.corner_vertices[corner + k]);
      }
      corner += static_cast<size_t>(size);
    }
    EXPECT_LT(rest.face_count(), mesh.face_count());
    EXPECT_GT(2 * rest.face_count(), mesh.face_count());
    mesh = std::move(rest);
  }
  return scene_of(std::move(mesh));
}

struct NamedScene {
  std::string name;
  Scene scene;
};

std::vector<NamedScene> tried_scenes() {
  return {{"rook", find_scene("rook")->make()}, {"ellipsoid", ellipsoid_mesh(false)}, {"open ellipsoid", ellipsoid_mesh(true)}};
}

TEST(LocalMeshLevelSet, NodesOfTheSmallestVoxelsHaveTheBitsOfTheUniformLevelSet) {
  for (const auto& [name, scene] : tried_scenes()) {
    const Camera camera = camera_of(scene, 1, 4, {150, 150});
    const std::vector<LevelSet> grids = local_level_sets(scene, kSettings, {{camera}, kFinest_px, {0.4}});
    ASSERT_GE(grids.size(), 3u) << name;
    const SceneModel uniform = build_model(scene, kSettings);
    ASSERT_TRUE(uniform.surfaces.front().level_set.has_value()) << name;
    const LevelSetData &ours = grids.front().data(), &theirs = uniform.surfaces.front().level_set->data();
    ASSERT_EQ(ours.info.voxel_size, theirs.info.voxel_size) << name;
    EXPECT_EQ(ours.info.half_width_voxels, theirs.info.half_width_voxels) << name;
    const auto in_world = ours.info.world_from_index.translation, in_render = theirs.info.world_from_index.translation;
    EXPECT_LT(glm::distance(in_world, in_render + uniform.render_origin), 1e-12) << name;
    const auto steps = static_cast<float>(32767.0 / (ours.info.half_width_voxels * ours.info.voxel_size));
    const auto of_ours = ours.accessor(), of_theirs = theirs.accessor();
    int same = 0, differ = 0, on_faces = 0, differ_on_faces = 0;
    for (auto leaf = ours.grid->tree().getFirstLeaf(); leaf != ours.grid->tree().getFirstLeaf() + ours.grid->tree().nodeCount(0); ++leaf)
      for (std::uint32_t n = 0; n < 512; ++n) {
        if (!leaf->isActive(n)) continue;
        const nanovdb::Coord at = leaf->offsetToGlobalCoord(n);
        const float stored = static_cast<float>(quantised(of_theirs.getValue(at), steps)) / steps;
        const bool equal = of_ours.getValue(at) == stored;
        // Nodes on the faces of larger bricks have those bricks' interpolant.
        const bool face = (at[0] & 7) == 0 || (at[1] & 7) == 0 || (at[2] & 7) == 0;
        ++(face ? on_faces : same);
        (face ? differ_on_faces : differ) += !equal;
      }
    EXPECT_GT(same, 10000) << name;
    EXPECT_EQ(differ, 0) << name << " of " << same;
    EXPECT_LT(2 * differ_on_faces, on_faces) << name;
  }
}

TEST(LocalMeshLevelSet, NoRayPassesThroughItWhereTheUniformOneStopsIt) {
  std::mt19937 random(random_seed());
  for (const auto& [name, scene] : tried_scenes()) {
    const SceneModel uniform = build_model(scene, kSettings);
    const Camera made_for = camera_of(scene, 0, 4, {150, 150});
    const SceneModel local = build_local_model(scene, kSettings, {{made_for}, kFinest_px, {0.4}});
    const test::ComparedModel of_local(local), of_uniform(uniform);
    const double bound = test::bound_of(scene, made_for);
    std::uniform_real_distribution<double> at(0.0, 150.0);
    test::LocalRays count;
    for (int view = 0; view < 4; ++view) {
      const Camera camera = camera_of(scene, view, 4, {150, 150});
      std::vector<glm::dvec2> points;
      for (int k = 0; k < 10000; ++k) points.emplace_back(at(random), at(random));
      test::cast_at_both(of_local, of_uniform, camera, points, bound, test::around_of(scene, camera, bound), count);
    }
    EXPECT_GT(count.hits, 5000) << name;
    EXPECT_EQ(count.through, 0) << name;
  }
}

TEST(LocalMeshLevelSet, ItsBorderIsThatOfTheUniformOneInFewerBytes) {
  for (const auto& [name, scene] : tried_scenes()) {
    const Camera camera = camera_of(scene, 0, 4, {150, 150});
    SurfaceSettings settings = kSettings;
    settings.voxels = 512;
    const SceneModel uniform = build_model(scene, settings);
    const SceneModel local = build_local_model(scene, settings, {{camera}, kFinest_px, {0.4}});
    std::vector<glm::dvec2> points;
    for (int y = 0; y < 150; ++y)
      for (int x = 0; x < 150; ++x) points.emplace_back(x + 0.5, y + 0.5);
    const std::vector<PointSample> ours = test::seen_at(local, camera, points), theirs = test::seen_at(uniform, camera, points);
    const auto kind = [](const PointSample& sample) { return sample.status != HitStatus::hit ? 0 : sample.n_dot_v < 0.4f ? 1 : 2; };
    int differ = 0, ink = 0;
    for (size_t i = 0; i < points.size(); ++i) differ += kind(ours[i]) != kind(theirs[i]), ink += kind(theirs[i]) == 1;
    EXPECT_GT(ink, 100) << name;
    EXPECT_LE(differ, 5) << name;
    EXPECT_LT(3 * total(local).bytes, total(uniform).bytes) << name;
  }
}

TEST(LocalMeshLevelSet, ALargerToleranceTakesFewerVoxelsAndKeepsTheBorderWithinIt) {
  const Scene scene = find_scene("rook")->make();
  const Camera camera = camera_of(scene, 0, 4, {150, 150});
  SurfaceSettings settings = kSettings;
  settings.voxels = 512;
  const SceneModel finest = build_local_model(scene, settings, {{camera}, kFinest_px, {0.4}});
  const SceneModel local = build_local_model(scene, settings, {{camera}, 1.5, {0.4}});
  EXPECT_LT(2 * total(local).voxels, total(finest).voxels);
  // Pixels whose middle and surroundings 1.5 pixels about are alike in one model have it so in the other.
  std::vector<glm::dvec2> points;
  for (int y = 2; y < 148; ++y)
    for (int x = 2; x < 148; ++x)
      for (int k = 0; k < 9; ++k) points.emplace_back(x + 1.5 * (k / 3 - 1), y + 1.5 * (k % 3 - 1));
  const std::vector<PointSample> ours = test::seen_at(local, camera, points), theirs = test::seen_at(finest, camera, points);
  const auto kind = [](const PointSample& sample) { return sample.status != HitStatus::hit ? 0 : sample.n_dot_v < 0.4f ? 1 : 2; };
  int sure = 0, ink = 0, wrong = 0;
  for (size_t first = 0; first < points.size(); first += 9) {
    bool uniform = true;
    for (size_t k = 1; k < 9; ++k) uniform = uniform && kind(theirs[first + k]) == kind(theirs[first]);
    sure += uniform && kind(theirs[first]) != 0, ink += uniform && kind(theirs[first]) == 1;
    wrong += uniform && kind(ours[first + 4]) != kind(theirs[first]);
  }
  EXPECT_GT(sure, 1000);
  EXPECT_GT(ink, 5);
  EXPECT_LE(wrong, 3);
}

TEST(LocalMeshLevelSet, ASheetIsAsFineEverywhereAndSaysSo) {
  Mesh sheet;
  sheet.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  sheet.face_sizes = {4};
  sheet.corner_vertices = {0, 1, 2, 3};
  const Scene scene = scene_of(sheet);
  const SurfaceSettings settings{.kind = "mesh_level_set", .voxels = 64};
  const LocalSettings asked{{camera_of(scene, 0, 4, {100, 100})}, 0.25, {0.4}};
  const SceneModel model = build_local_model(scene, settings, asked);
  EXPECT_TRUE(model.surfaces.front().level_set.has_value());
  const std::vector<std::string>& warnings = model.surfaces.front().info.warnings;
  EXPECT_NE(warnings.back().find("no inside"), std::string::npos) << warnings.back();
  EXPECT_THROW(local_level_sets(scene, settings, asked), InputError);
}

TEST(LocalMeshLevelSet, HasTheMeshsCurvatureAndAnOffset) {
  const double radius = 0.8;
  Scene scene;
  scene.objects.push_back({.name = "ball", .source = make_shape("sphere", {{"radius", {radius}}})});
  const Camera camera = camera_of(scene, 0, 4, {100, 100});
  const SceneModel model = build_local_model(scene, {.kind = "mesh_level_set", .voxels = 150, .level = 3}, {{camera}, 0.25, {0.4}});
  const Surface& surface = model.surfaces.front();
  ASSERT_NE(surface.curvature.evaluate, nullptr) << surface.curvature.from;
  const glm::dvec3 towards = glm::normalize(camera.eye - model.render_origin);
  const SurfacePoint point{radius * towards, towards, -1};
  SurfaceCurvature curvature;
  surface.curvature.evaluate(surface.curvature.state.get(), {&point, 1}, {&curvature, 1});
  EXPECT_NEAR(std::abs(curvature.k1), 1.0 / radius, 0.02);
  EXPECT_NEAR(std::abs(curvature.k2), 1.0 / radius, 0.02);
  ASSERT_NE(surface.offset.make, nullptr);
  const double width = 0.05;
  const Surface offset = surface.offset.make(surface.offset.state.get(), {.world = width});
  RayBatch rays;
  HitBatch hits;
  rays.count = 1;
  rays.set(0, 3.0 * towards, -towards, 0.0, 10.0);
  std::fill_n(hits.status, kRayBatchSize, HitStatus::miss);
  offset.trace(offset.state.get(), rays, hits);
  ASSERT_EQ(hits.status[0], HitStatus::hit);
  EXPECT_NEAR(static_cast<double>(hits.t[0]), 3.0 - radius - width, 0.005);
}

TEST(LocalMeshLevelSet, ALevelIsThatOfItsMeshAndRefusedForALocalMesh) {
  const Scene scene = find_scene("teacup")->make();
  ExperimentSpec spec;
  spec.surface.level = 3;
  EXPECT_NO_THROW(refuse_local_without_effect(spec, scene, kSettings, {"mesh_level_set"}));
  EXPECT_THROW(refuse_local_without_effect(spec, scene, kSettings, {"mesh"}), InputError);
  EXPECT_THROW(refuse_local_without_effect({}, scene, kSettings, {"analytic"}), InputError);
}

}  // namespace
}  // namespace limn
