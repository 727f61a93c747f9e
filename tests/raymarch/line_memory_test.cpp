// What views of one scene share makes them faster and nothing else.

#include <gtest/gtest.h>

#include <string>

#include "raymarch/lines.h"
#include "sdf/shape.h"
#include "tests/raymarch/line_views.h"

namespace limn {
namespace {

void expect_same(const ViewGraph& one, const ViewGraph& other) {
  ASSERT_EQ(one.edges.size(), other.edges.size());
  for (size_t i = 0; i < one.edges.size(); ++i) {
    EXPECT_EQ(one.edges[i].invisibility, other.edges[i].invisibility);
    ASSERT_EQ(one.edges[i].points.size(), other.edges[i].points.size());
    for (size_t k = 0; k < one.edges[i].points.size(); ++k) EXPECT_EQ(one.edges[i].points[k].position, other.edges[i].points[k].position);
  }
  EXPECT_EQ(one.notes, other.notes);
}

TEST(LineMemory, ViewsOfFieldsAreTheSameWithoutIt) {
  const Field ball = make_shape("sphere", {{"radius", {0.6}}}),
              bar = make_shape("rounded_box", {{"half", {0.9, 0.3, 0.3}}, {"rounding", {0.1}}});
  const Field walls = make_shape("gyroid", {{"period", {1.4}}, {"bound", {0.7}}});
  for (const Field& field : {combine(Csg::union_, ball, translate(bar, {0.2, 0.1, 0.0})), walls}) {
    Scene scene;
    scene.objects.push_back({.name = "body", .source = field});
    LineSettings settings;
    settings.closed_forms = false;
    ExecutionSettings execution;
    execution.threads = 2;
    LineMemory memory;
    // Three views from one distance, so that they share their cells, and one from another.
    for (const auto& [direction, distance] : {std::pair(glm::dvec3(1.0, 0.3, 0.2), 4.0), std::pair(glm::dvec3(-0.2, 0.5, 1.0), 4.0),
                                              std::pair(glm::dvec3(0.1, -1.0, 0.4), 4.0), std::pair(glm::dvec3(1.0, 1.0, 1.0), 9.0)}) {
      const Camera camera = line_view(bounds(scene), glm::normalize(direction), distance, true);
      const ViewGraph graph = solve_lines(scene, camera, settings, execution, &memory);
      EXPECT_FALSE(graph.edges.empty());
      expect_same(graph, solve_lines(scene, camera, settings, execution));
    }
  }
}

TEST(LineMemory, ViewsOfClosedFormsAreTheSameWithoutIt) {
  const auto shape = [](const char* name, double size) {
    return std::string(name) == "cylinder" ? make_shape(name, {{"radius", {size}}, {"half_height", {0.5}}})
                                           : make_shape(name, {{"radii", {size, 0.8 * size, 0.5}}});
  };
  const Field disk = shape("cylinder", 0.9), bore = translate(shape("cylinder", 0.3), {0.2, 0.0, 0.1});
  Scene scene;
  // Two bodies, and one whose surfaces meet in a curve without closed form.
  scene.objects.push_back({.name = "disk", .source = combine(Csg::difference, disk, bore)});
  scene.objects.push_back({.name = "box", .source = translate(make_shape("box", {{"half", {0.2, 0.3, 0.4}}}), {1.5, 0.0, 0.0})});
  scene.objects.push_back(
      {.name = "blobs",
       .source =
           translate(combine(Csg::union_, shape("ellipsoid", 0.6), translate(shape("ellipsoid", 0.5), {0.4, 0.2, 0.1})), {0.0, 0.0, 1.5})});
  LineMemory memory;
  for (const bool perspective : {true, false}) {
    for (const glm::dvec3& direction : {glm::dvec3(1.0, 0.3, 0.2), {-0.2, 0.5, 1.0}}) {
      const Camera camera = line_view(bounds(scene), glm::normalize(direction), 8.0, perspective);
      const ViewGraph graph = solve_lines(scene, camera, {}, {}, &memory);
      EXPECT_GT(graph.edges.size(), 10u);
      expect_same(graph, solve_lines(scene, camera, {}, {}));
    }
  }
}

}  // namespace
}  // namespace limn
