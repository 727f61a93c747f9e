// Lines of built-in scenes from sides that were wrong once.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "raymarch/frames.h"
#include "raymarch/lines.h"
#include "samples/experiment/job.h"
#include "samples/scenes/scenes.h"
#include "tests/bench/lines_oracle.h"

namespace limn {
namespace {

Camera camera_from(const Scene& scene, const glm::dvec3& direction) {
  const Box box = bounds(scene);
  CameraSettings settings;
  settings.target = box.center();
  settings.eye = box.center() + 2.0 * box.radius() * glm::normalize(direction);
  settings.vertical_fov = 2.0 * std::asin(0.5) * 1.02;
  settings.width_px = 640;
  settings.height_px = 360;
  return resolve_camera(settings, box);
}

Scene level_set_of(const Scene& scene) {
  SurfaceSettings settings;
  settings.kind = std::holds_alternative<MeshSource>(scene.objects[0].source) ? "mesh_level_set" : "level_set";
  settings.level = 5;
  settings.gradient = "cubic";
  settings.voxels = 256;
  return modelled_scene(scene, build_model(scene, settings));
}

// Beside a cusp, before a jump of curvature, polylines of the two arms cross and the arms only touch: all rays deny the crossing.
TEST(LinesOfScenes, MachinedPartFromACornerHasNoConflict) {
  const Scene scene = find_scene("machined_part")->make();
  const ViewGraph graph = solve_lines(scene, camera_from(scene, {-1.0, 1.0, 1.0}), {}, {});
  EXPECT_GT(graph.chains.size(), 100u);
  for (const LineConflict& conflict : graph.conflicts)
    ADD_FAILURE() << fmt::format("{}, {}: {}", conflict.px.x, conflict.px.y, conflict.what);
}

// Flat walls of voxels seen edge-on: many contours lie within a thousandth of a pixel of each other.
TEST(LinesOfScenes, RookAsALevelSetSeenAlongItsAxesHasNoConflict) {
  const Scene scene = find_scene("rook")->make(), voxels = level_set_of(scene);
  LineMemory memory;
  for (const glm::dvec3& direction : {glm::dvec3(0.0, 0.0, -1.0), {-1.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 0.0, 1.0}}) {
    const ViewGraph graph = solve_lines(voxels, camera_from(scene, direction), {}, {}, &memory);
    EXPECT_GT(graph.chains.size(), 30u);
    for (const LineConflict& conflict : graph.conflicts)
      ADD_FAILURE() << fmt::format("{}, {}: {}", conflict.px.x, conflict.px.y, conflict.what);
  }
}

// A hidden piece whose polyline crossed a nearer one's was seen all along: contours are known between their samples, too.
TEST(LinesOfScenes, GyroidAsALevelSetFromACornerAgreesWithRays) {
  const Scene scene = find_scene("gyroid")->make(), voxels = level_set_of(scene);
  const Camera camera = camera_from(scene, {-1.0, -1.0, -1.0});
  const ViewGraph graph = solve_lines(voxels, camera, {}, {});
  EXPECT_TRUE(graph.conflicts.empty());
  const bench::OracleCount count = bench::ask_oracle(bench::make_oracle(voxels), camera, graph);
  EXPECT_GT(count.visible, 500);
  for (const glm::dvec2& place : count.places) ADD_FAILURE() << fmt::format("rays disagree at {}, {}", place.x, place.y);
}

// Two frames of 240 around the rook, small: visible lines were hidden by mistake, without a conflict.
TEST(LinesOfScenes, RookInFramesThatWereWrong) {
  const Scene scene = find_scene("rook")->make();
  CameraSettings settings = scene.camera;
  settings.width_px = 240;
  settings.height_px = 135;
  const Camera first = camera_of_view(settings, {bounds(scene), {}}, {}, 0, 1);
  const bench::Oracle oracle = bench::make_oracle(scene);
  for (const int frame : {1, 2}) {
    const Camera camera = turned_camera(first, *settings.target, settings.up, 2.0 * std::numbers::pi * frame / 240.0);
    const ViewGraph graph = solve_lines(scene, camera, {}, {});
    for (const LineConflict& conflict : graph.conflicts)
      ADD_FAILURE() << fmt::format("{}, {}: {}", conflict.px.x, conflict.px.y, conflict.what);
    const bench::OracleCount count = bench::ask_oracle(oracle, camera, graph);
    EXPECT_GT(count.visible, 100);
    EXPECT_EQ(count.occluded, 0);
    EXPECT_EQ(count.seen, 0);
    for (const glm::dvec2& place : count.places) ADD_FAILURE() << fmt::format("frame {}: rays disagree at {}, {}", frame, place.x, place.y);
  }
}

}  // namespace
}  // namespace limn
