// Lines of built-in scenes from sides that were wrong once.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "raymarch/frames.h"
#include "raymarch/lines.h"
#include "samples/experiment/job.h"
#include "samples/input/input.h"
#include "samples/scenes/scenes.h"
#include "tests/bench/lines_oracle.h"

namespace limn {
namespace {

Camera camera_from(const Scene& scene, const glm::dvec3& direction) {
  const Box box = bounds(scene);
  CameraSettings settings;
  settings.target = box.center();
  settings.eye = box.center() + 2.0 * box.radius() * glm::normalize(direction);
  if (direction.x == 0.0 && direction.z == 0.0) settings.up = {0.0, 0.0, 1.0};
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

std::string places_of(const std::vector<LineConflict>& conflicts) {
  std::string text;
  for (const LineConflict& conflict : conflicts) text += fmt::format("{}, {}: {}; ", conflict.px.x, conflict.px.y, conflict.what);
  return text;
}

std::string places_of(const std::vector<glm::dvec2>& rays_disagree_px) {
  std::string text = "rays disagree at";
  for (const glm::dvec2& place : rays_disagree_px) text += fmt::format(" {}, {};", place.x, place.y);
  return text;
}

// Beside a cusp, before a jump of curvature, polylines of the two arms cross and the arms only touch: all rays deny the crossing.
TEST(LinesOfScenes, MachinedPartFromACornerHasNoConflict) {
  const Scene scene = find_scene("machined_part")->make();
  const ViewGraph graph = solve_lines(scene, camera_from(scene, {-1.0, 1.0, 1.0}), {}, {});
  EXPECT_GT(graph.chains.size(), 100u);
  EXPECT_EQ(graph.conflicts.size(), 0u) << places_of(graph.conflicts);
}

// A swallowtail 0.04 px wide at the seam of a blend: one of its cusps is where the curvature jumps, and the arms cross beside it.
TEST(LinesOfScenes, TwoMetalsFromBelowHasNoConflict) {
  ExperimentSpec spec;
  spec.input = LIMN_SOURCE_DIR "/samples/scenes/two_metals.toml";
  const Scene scene = load_input(spec).scene;
  CameraSettings settings;
  settings.eye = {-2.9783287662796418, -0.99436892510232711, 1.6997085066869675};
  settings.target = *settings.eye - glm::dvec3(-0.83918915078046297, -0.28470742987512043, 0.46336081900206971);
  settings.vertical_fov = std::numbers::pi / 6.0;
  const ViewGraph graph = solve_lines(scene, resolve_camera(settings, bounds(scene)), {}, {});
  EXPECT_EQ(graph.conflicts.size(), 0u) << places_of(graph.conflicts);
  const auto beside_it = [&](VertexKind kind) {
    return std::count_if(graph.vertices.begin(), graph.vertices.end(), [&](const LineVertex& vertex) {
      return vertex.kind == kind && glm::distance(vertex.px, {908.17, 269.796}) < 0.1;
    });
  };
  EXPECT_EQ(beside_it(VertexKind::cusp), 2);
  EXPECT_EQ(beside_it(VertexKind::crossing), 1);
}

// Flat walls of voxels seen edge-on: many contours lie within a thousandth of a pixel of each other.
TEST(LinesOfScenes, RookAsALevelSetSeenAlongItsAxesHasNoConflict) {
  const Scene scene = find_scene("rook")->make(), voxels = level_set_of(scene);
  LineMemory memory;
  for (const glm::dvec3& direction : {glm::dvec3(0.0, 0.0, -1.0), {-1.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 0.0, 1.0}}) {
    const ViewGraph graph = solve_lines(voxels, camera_from(scene, direction), {}, {}, &memory);
    EXPECT_GT(graph.chains.size(), 30u);
    EXPECT_EQ(graph.conflicts.size(), 0u) << places_of(graph.conflicts);
  }
}

// A hidden piece whose polyline crossed a nearer one's was seen all along: contours are known between their samples, too.
TEST(LinesOfScenes, GyroidAsALevelSetFromACornerAgreesWithRays) {
  const Scene scene = find_scene("gyroid")->make(), voxels = level_set_of(scene);
  const Camera camera = camera_from(scene, {-1.0, -1.0, -1.0});
  const ViewGraph graph = solve_lines(voxels, camera, {}, {});
  EXPECT_EQ(graph.conflicts.size(), 0u) << places_of(graph.conflicts);
  const bench::OracleCount count = bench::ask_oracle(bench::make_oracle(voxels), camera, graph);
  EXPECT_GT(count.visible, 500);
  EXPECT_EQ(count.places.size(), 0u) << places_of(count.places);
}

// Seen from above its walls are edge-on: contours on them hide each other by 0.0002 px over 9 px. The oracle finds the contours' own
// points, though they are known badly along the rays, and tells with every visibility exchanged, too.
TEST(LinesOfScenes, RookAsALevelSetFromAboveAgreesWithRays) {
  const Scene scene = find_scene("rook")->make(), voxels = level_set_of(scene);
  const bench::Oracle oracle = bench::make_oracle(voxels);
  LineMemory memory;
  for (const glm::dvec3& direction : {glm::dvec3(0.0, 1.0, 0.0), {0.0, 1.0, -1.0}}) {
    const Camera camera = camera_from(scene, direction);
    ViewGraph graph = solve_lines(voxels, camera, {}, {}, &memory);
    EXPECT_EQ(graph.conflicts.size(), 0u) << places_of(graph.conflicts);
    const bench::OracleCount count = bench::ask_oracle(oracle, camera, graph);
    EXPECT_GT(count.points, 1000);
    EXPECT_EQ(count.places.size(), 0u) << places_of(count.places);
    EXPECT_EQ(count.undecided, 0);
    for (LineEdge& edge : graph.edges) edge.invisibility = edge.invisibility == 0 ? 1 : 0;
    const bench::OracleCount exchanged = bench::ask_oracle(oracle, camera, graph);
    EXPECT_GT(static_cast<double>(exchanged.seen), 0.95 * static_cast<double>(exchanged.points - exchanged.visible));
  }
}

// A hidden contour beside a visible crease: a ray 0.0002 px beside it passes the sheet that hides it, which is 0.15 px thick.
TEST(LinesOfScenes, GyroidFromAnEdgeAgreesWithRays) {
  const Scene scene = find_scene("gyroid")->make();
  const Camera camera = camera_from(scene, {1.0, 1.0, 0.0});
  const bench::Oracle oracle = bench::make_oracle(scene);
  ViewGraph graph = solve_lines(scene, camera, {}, {});
  EXPECT_EQ(graph.conflicts.size(), 0u) << places_of(graph.conflicts);
  const bench::OracleCount count = bench::ask_oracle(oracle, camera, graph);
  EXPECT_GT(count.points, 4000);
  EXPECT_EQ(count.places.size(), 0u) << places_of(count.places);
  for (LineEdge& edge : graph.edges) edge.invisibility = edge.invisibility == 0 ? 1 : 0;
  const bench::OracleCount exchanged = bench::ask_oracle(oracle, camera, graph);
  EXPECT_GT(static_cast<double>(exchanged.occluded), 0.95 * static_cast<double>(exchanged.visible));
  EXPECT_GT(static_cast<double>(exchanged.seen), 0.95 * static_cast<double>(exchanged.points - exchanged.visible));
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
    EXPECT_EQ(graph.conflicts.size(), 0u) << places_of(graph.conflicts);
    const bench::OracleCount count = bench::ask_oracle(oracle, camera, graph);
    EXPECT_GT(count.visible, 100);
    EXPECT_EQ(count.occluded, 0);
    EXPECT_EQ(count.seen, 0);
    EXPECT_EQ(count.places.size(), 0u) << "frame " << frame << ", " << places_of(count.places);
  }
}

}  // namespace
}  // namespace limn
