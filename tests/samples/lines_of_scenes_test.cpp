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

// Beside a cusp, before a jump of curvature, polylines of the two arms cross and the arms only touch: all rays deny the crossing.
TEST(LinesOfScenes, MachinedPartFromACornerHasNoConflict) {
  const Scene scene = find_scene("machined_part")->make();
  const Box box = bounds(scene);
  CameraSettings settings;
  settings.target = box.center();
  settings.eye = box.center() + 2.0 * box.radius() * glm::normalize(glm::dvec3(-1.0, 1.0, 1.0));
  settings.vertical_fov = 2.0 * std::asin(0.5) * 1.02;
  settings.width_px = 640;
  settings.height_px = 360;
  const ViewGraph graph = solve_lines(scene, resolve_camera(settings, box), {}, {});
  EXPECT_GT(graph.chains.size(), 100u);
  for (const LineConflict& conflict : graph.conflicts)
    ADD_FAILURE() << fmt::format("{}, {}: {}", conflict.px.x, conflict.px.y, conflict.what);
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
