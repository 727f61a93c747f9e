// The bench's oracle of lines: it finds nothing where lines are right, and finds lines that are not.

#include "tests/bench/lines_oracle.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "sdf/shape.h"
#include "subdiv/import.h"

namespace limn::bench {
namespace {

/// Long straight edges, bores whose far rims lie close behind near ones, and a torus with cusps.
Scene pierced_plate() {
  std::vector<Field> all = {make_shape("box", {{"half", {1.2, 0.1, 0.4}}})};
  for (int i = -2; i <= 2; ++i)
    all.push_back(translate(make_shape("cylinder", {{"radius", {0.15}}, {"half_height", {1.0}}}), glm::dvec3(0.4 * i, 0.0, 0.1)));
  Scene scene;
  scene.objects.push_back({.name = "plate", .source = combine(Csg::difference, all)});
  scene.objects.push_back(
      {.name = "torus", .source = translate(make_shape("torus", {{"major", {0.5}}, {"minor", {0.2}}}), glm::dvec3(0.0, -0.6, 0.0))});
  return scene;
}

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

TEST(LinesOracle, AgreesWithRightLinesInPerspective) {
  const Scene scene = pierced_plate();
  const SceneModel model = oracle_model(scene);
  for (const glm::dvec3& direction : {glm::dvec3(1.0, 1.0, 1.0), {1.0, 0.6, 0.1}, {-1.0, 0.2, 0.4}, {0.3, -1.0, 0.5}}) {
    const Camera camera = camera_from(scene, direction);
    const ViewGraph graph = solve_lines(scene, camera, {}, {});
    EXPECT_TRUE(graph.conflicts.empty());
    const OracleCount count = ask_oracle(model, camera, graph);
    EXPECT_GT(count.points, 300);
    EXPECT_EQ(count.occluded + count.seen, 0) << fmt::format("from {}, {}, {}: the first at {}, {}", direction.x, direction.y, direction.z,
                                                             count.places[0].x, count.places[0].y);
  }
}

TEST(LinesOracle, FindsLinesThatAreHiddenOrShownByMistake) {
  const Scene scene = pierced_plate();
  const Camera camera = camera_from(scene, {1.0, 0.6, 0.3});
  ViewGraph graph = solve_lines(scene, camera, {}, {});
  for (LineEdge& edge : graph.edges) edge.invisibility = edge.invisibility == 0 ? 1 : 0;
  const OracleCount count = ask_oracle(oracle_model(scene), camera, graph);
  EXPECT_GT(count.points, 300);
  EXPECT_GT(static_cast<double>(count.occluded), 0.95 * static_cast<double>(count.visible));
  EXPECT_GT(static_cast<double>(count.seen), 0.95 * static_cast<double>(count.points - count.visible));
}

// A cage with cuspidal edges, along which sheets go through each other beside cusps. From the first side a piece of two pixels was visible
// by mistake, from the second there was a conflict, and from the third a piece along which other lines run was visible by mistake.
TEST(LinesOracle, AgreesWithTheOgreFromThreeSides) {
  const std::filesystem::path file = std::filesystem::path(LIMN_TEST_DATA) / "ogre_controlmesh.obj";
  Scene scene;
  scene.objects.push_back({.name = "ogre", .source = MeshSource{load_mesh(file), Scheme::catmark, file.string()}});
  const SceneModel model = oracle_model(scene);
  LineMemory memory;
  for (const glm::dvec3& direction : {glm::dvec3(-1.0, 1.0, 0.0), {-1.0, -1.0, 1.0}, {0.0, -1.0, 1.0}}) {
    const Camera camera = camera_from(scene, direction);
    const ViewGraph graph = solve_lines(scene, camera, {}, {}, &memory);
    for (const LineConflict& conflict : graph.conflicts)
      ADD_FAILURE() << fmt::format("{}, {}: {}", conflict.px.x, conflict.px.y, conflict.what);
    const OracleCount count = ask_oracle(model, camera, graph);
    for (const glm::dvec2& place : count.places) ADD_FAILURE() << fmt::format("rays disagree at {}, {}", place.x, place.y);
  }
}

}  // namespace
}  // namespace limn::bench
