// The bench's oracle of lines: it finds nothing where lines are right, and finds lines that are not.

#include "tests/bench/lines_oracle.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "sdf/shape.h"

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
  settings.width_px = 480;
  settings.height_px = 320;
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

}  // namespace
}  // namespace limn::bench
