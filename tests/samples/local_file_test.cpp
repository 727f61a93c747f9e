// Local level sets written to a .vdb and read back: the same picture, and a clear error for files that do not fit together.

#include <gtest/gtest.h>

#include <cstring>

#include "raymarch/gbuffer.h"
#include "raymarch/local_model.h"
#include "samples/experiment/job.h"
#include "samples/input/input.h"
#include "sdf/error.h"
#include "sdf/level_set_data.h"
#include "sdf/level_set_grids.h"
#include "sdf/local_grid.h"
#include "sdf/shape.h"
#include "tests/plan_check.h"
#include "tests/samples/scene_camera.h"
#include "tests/temporary_folder.h"

namespace limn {
namespace {

Scene ellipsoid() {
  Scene scene;
  scene.objects.push_back({.name = "an ellipsoid", .source = make_shape("ellipsoid", {{"radii", {1.0, 0.7, 0.5}}})});
  return scene;
}

struct Written {
  Scene scene = ellipsoid();
  Camera camera = camera_of(scene, 1, 4, {150, 150});
  SurfaceSettings settings{.kind = "level_set", .voxels = 160};
  LocalSettings local{{camera}, 0.05, {0.4}};
  std::vector<LevelSet> grids = local_level_sets(scene, settings, local);
};

SceneInput read(const std::filesystem::path& file) {
  ExperimentSpec spec;
  spec.input = file.string();
  return load_input(spec);
}

/// What reading the file says; empty where it is read.
std::string refusal(const std::filesystem::path& file) {
  try {
    read(file);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

TEST(LocalFile, IsReadBackAsOneObjectThatDrawsTheSamePicture) {
  const TemporaryFolder folder;
  for (const char* gradient : {"cell", "central", "cubic"}) {
    Written written;
    written.settings.gradient = gradient;
    const SceneModel made = build_local_model(written.scene, written.settings, written.local);
    const std::vector<LevelSet> grids = local_level_sets(written.scene, written.settings, written.local);
    ASSERT_GE(grids.size(), 3u);
    write_level_sets(grids, folder.path() / "x.vdb");
    const SceneInput input = read(folder.path() / "x.vdb");
    ASSERT_EQ(input.scene.objects.size(), 1u);
    EXPECT_EQ(input.scene.objects.front().name, "an ellipsoid");
    EXPECT_EQ(bounds(input.scene).lower, bounds(written.scene).lower);
    EXPECT_EQ(bounds(input.scene).upper, bounds(written.scene).upper);
    const SceneModel again = build_model(input.scene, {.kind = "level_set", .gradient = gradient});
    std::vector<glm::dvec2> points;
    for (int y = 0; y < 150; ++y)
      for (int x = 0; x < 150; ++x) points.emplace_back(x + 0.5, y + 0.5);
    const std::vector<PointSample> ours = test::seen_at(made, written.camera, points),
                                   theirs = test::seen_at(again, written.camera, points);
    int hits = 0, differ = 0;
    for (size_t i = 0; i < points.size(); ++i) {
      const bool hit = ours[i].status == HitStatus::hit;
      hits += hit;
      differ +=
          ours[i].status != theirs[i].status || (hit && (ours[i].position != theirs[i].position || ours[i].normal != theirs[i].normal));
    }
    EXPECT_GT(hits, 3000) << gradient;
    EXPECT_EQ(differ, 0) << gradient;
    // From the middle of the body, which no brick holds.
    for (const SceneModel* model : {&made, &again}) {
      RayBatch rays;
      HitBatch hit;
      rays.count = 1;
      rays.set(0, glm::dvec3(0.0), glm::dvec3(0.0, 0.0, 1.0), 0.0, 10.0);
      std::fill_n(hit.status, kRayBatchSize, HitStatus::miss);
      const Surface& surface = model->surfaces.front();
      surface.trace(surface.state.get(), rays, hit);
      ASSERT_EQ(hit.status[0], HitStatus::hit) << gradient;
      EXPECT_NEAR(static_cast<double>(hit.t[0]), 0.5, 0.05) << gradient;
    }
  }
}

TEST(LocalFile, IsWrittenAgainAsItIs) {
  const TemporaryFolder folder;
  const Written written;
  write_level_sets(written.grids, folder.path() / "x.vdb");
  const LevelSet once = std::get<LevelSetSource>(read(folder.path() / "x.vdb").scene.objects.front().source).level_set;
  write_level_sets(grids_of(once), folder.path() / "y.vdb");
  const LevelSet twice = std::get<LevelSetSource>(read(folder.path() / "y.vdb").scene.objects.front().source).level_set;
  ASSERT_NE(local_volume(once), nullptr);
  ASSERT_NE(local_volume(twice), nullptr);
  ASSERT_EQ(local_volume(twice)->said.size(), written.grids.size());
  for (size_t k = 0; k < written.grids.size(); ++k) {
    EXPECT_EQ(local_volume(twice)->said[k].bricks, local_volume(once)->said[k].bricks);
    EXPECT_EQ(grids_of(twice)[k].info().active_voxels, written.grids[k].info().active_voxels);
  }
}

TEST(LocalFile, AMissingSizeIsRefusedByName) {
  const TemporaryFolder folder;
  Written written;
  const std::string first = written.grids.front().info().name, last = written.grids.back().info().name;
  std::vector<LevelSet> rest(written.grids.begin() + 1, written.grids.end());
  write_level_sets(rest, folder.path() / "no_first.vdb");
  EXPECT_NE(refusal(folder.path() / "no_first.vdb").find(rest.front().info().name), std::string::npos)
      << refusal(folder.path() / "no_first.vdb");
  rest = {written.grids.begin(), written.grids.end() - 1};
  write_level_sets(rest, folder.path() / "no_last.vdb");
  EXPECT_NE(refusal(folder.path() / "no_last.vdb").find(first), std::string::npos) << refusal(folder.path() / "no_last.vdb");
  write_level_sets(std::span(&written.grids.back(), 1), folder.path() / "only.vdb");
  EXPECT_NE(refusal(folder.path() / "only.vdb").find(last), std::string::npos) << refusal(folder.path() / "only.vdb");
  // By its name it is a grid as any other.
  EXPECT_EQ(local_volume(read_level_set(folder.path() / "no_last.vdb", first)), nullptr);
}

TEST(LocalFile, MetadataThatAreNotInOrderAreRefusedByName) {
  const TemporaryFolder folder;
  Written written;
  LevelSet& grid = written.grids[1];
  // Made by local_level_sets, which hands out no constants.
  GridMetadata& entry = const_cast<LevelSetData&>(grid.data()).file.metadata.back();
  const std::optional<LocalGrid> said = local_grid_of(grid, "");
  ASSERT_TRUE(said.has_value());
  const auto refused = [&](const std::string& what, const auto& change, bool at_reading) {
    LocalGrid changed = *said;
    change(changed);
    entry = local_metadata(changed);
    write_level_sets(written.grids, folder.path() / "x.vdb");
    std::string problem = refusal(folder.path() / "x.vdb");
    if (!at_reading) {
      ASSERT_EQ(problem, "") << what;
      try {
        build_model(read(folder.path() / "x.vdb").scene, {.kind = "level_set"});
      } catch (const InputError& error) {
        problem = error.what();
      }
    }
    EXPECT_NE(problem.find(grid.info().name), std::string::npos) << what << ": " << problem;
  };
  refused(
      "no bricks", [](LocalGrid& g) { g.bricks.clear(); }, true);
  refused(
      "a brick twice", [](LocalGrid& g) { g.bricks.push_back(g.bricks.back()); }, true);
  refused(
      "a brick far away", [](LocalGrid& g) { g.bricks.emplace_back(1 << 30, 0, 0); }, true);
  refused(
      "no band", [](LocalGrid& g) { g.half_width = 0.0; }, true);
  refused(
      "another gradient", [](LocalGrid& g) { g.gradient = "cell"; }, true);
  refused(
      "a size too many", [](LocalGrid& g) { g.sizes = 40; }, true);
  refused(
      "a brick without nodes", [](LocalGrid& g) { g.bricks.emplace_back(1000, 0, 0); }, false);
  refused(
      "a band far too wide", [](LocalGrid& g) { g.half_width = 1e300; }, false);
  refused(
      "a band far too thin", [](LocalGrid& g) { g.half_width = 1e-300; }, false);
  entry = local_metadata(*said);
  entry.bytes.resize(entry.bytes.size() / 2);
  const auto length = static_cast<std::uint32_t>(entry.bytes.size() - 4);
  std::memcpy(entry.bytes.data(), &length, sizeof length);
  write_level_sets(written.grids, folder.path() / "x.vdb");
  EXPECT_NE(refusal(folder.path() / "x.vdb").find(grid.info().name), std::string::npos) << "cut off";
}

TEST(LocalFile, OtherGridsOfTheFileStayObjectsOfTheirOwn) {
  const TemporaryFolder folder;
  Written written;
  const LevelSet ball = level_set_from_field(make_shape("sphere", {{"radius", {0.5}}}), {.voxel_size = 0.05});
  std::vector<LevelSet> grids = written.grids;
  grids.insert(grids.begin() + 2, ball);
  write_level_sets(grids, folder.path() / "x.vdb");
  EXPECT_EQ(read(folder.path() / "x.vdb").scene.objects.size(), 2u);
  write_level_sets(std::vector{ball, ball}, folder.path() / "balls.vdb");
  EXPECT_EQ(read(folder.path() / "balls.vdb").scene.objects.size(), 2u);
}

TEST(LocalFile, IsRefusedWhereOneVoxelSizeIsNeeded) {
  const TemporaryFolder folder;
  const Written written;
  write_level_sets(written.grids, folder.path() / "x.vdb");
  const Scene scene = read(folder.path() / "x.vdb").scene;
  EXPECT_THROW(build_model(scene, {.kind = "mesh"}), InputError);
  EXPECT_THROW(build_model(scene, {.kind = "mesh_level_set"}), InputError);
  EXPECT_THROW(build_model(scene, {.kind = "level_set", .resample_volumes = true}), InputError);
  EXPECT_THROW(build_model(scene, {.kind = "level_set", .gradient = "cubic"}), InputError);
}

}  // namespace
}  // namespace limn
