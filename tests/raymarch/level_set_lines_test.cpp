// Lines of several level sets: what overlaps is one body, whose intersections are drawn and whose inside is not.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "raymarch/lines.h"
#include "sdf/level_set.h"
#include "sdf/segment.h"
#include "sdf/shape.h"
#include "tests/random_seed.h"
#include "tests/raymarch/line_views.h"

namespace limn {
namespace {

constexpr int kViews = 12;

SceneObject grid_of(const std::string& name, const Field& field, double voxel) {
  LevelSetSettings settings;
  settings.voxel_size = voxel;
  settings.half_width_voxels = 4.0;
  return {.name = name, .source = LevelSetSource{level_set_from_field(field, settings)}};
}

Field ball(double radius, const glm::dvec3& at) { return translate(make_shape("sphere", {{"radius", {radius}}}), at); }

Camera random_view(std::mt19937& random, const Box& box, bool perspective) {
  std::normal_distribution<double> normal;
  const glm::dvec3 direction = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
  return line_view(box, direction, std::uniform_real_distribution<double>(2.5, 6.0)(random), perspective);
}

/// Image lengths by class and invisibility.
std::map<std::pair<LineClass, int>, double> lengths_of(const ViewGraph& graph) {
  std::map<std::pair<LineClass, int>, double> lengths;
  for (const LineEdge& edge : graph.edges) {
    double& sum = lengths[{edge.line_class, edge.invisibility}];
    for (size_t i = 1; i < edge.points.size(); ++i) sum += glm::distance(edge.points[i - 1].px, edge.points[i].px);
  }
  return lengths;
}

TEST(LevelSetLines, BallsThatOverlapHaveTheirCirclesAndNothingWithin) {
  // Three balls, of two voxel sizes; the circle of two balls lies in the plane where their powers are the same.
  const std::vector<std::pair<double, glm::dvec3>> balls = {{0.6, {-0.3, 0.0, 0.1}}, {0.5, {0.35, 0.1, 0.0}}, {0.4, {0.0, 0.55, 0.2}}};
  Scene fields, grids;
  for (size_t i = 0; i < balls.size(); ++i) {
    const Field field = ball(balls[i].first, balls[i].second);
    fields.objects.push_back({.name = "ball", .source = field});
    grids.objects.push_back(grid_of("ball", field, i == 1 ? 0.006 : 0.005));
  }
  std::mt19937 random(random_seed());
  LineMemory memory;
  for (int view = 0; view < kViews; ++view) {
    const Camera camera = random_view(random, bounds(fields), view % 2 == 0);
    const ViewGraph graph = solve_lines(grids, camera, {}, {}, &memory), exact = solve_lines(fields, camera, {}, {});
    const std::string what = fmt::format("view {}", view);
    EXPECT_TRUE(graph.conflicts.empty()) << what << ": " << graph.conflicts.front().what;
    int intersections = 0;
    for (const LineEdge& edge : graph.edges) {
      for (const LinePoint& point : edge.points) {
        // On two of the balls, or on one and seen edge-on; inside none.
        const double px = 1.0 / pixels_per_unit_at(camera, point.depth);
        int on = 0;
        for (const auto& [radius, center] : balls) {
          const double off = glm::distance(point.position, center) - radius;
          EXPECT_GT(off, -0.05 * px) << what;
          on += std::fabs(off) < 0.05 * px;
        }
        EXPECT_GE(on, edge.line_class == LineClass::intersection ? 2 : 1) << what;
      }
      intersections += edge.line_class == LineClass::intersection;
    }
    EXPECT_GT(intersections, 2) << what;
    // As much of each class behind as many layers as the closed form has.
    const auto found = lengths_of(graph), wanted = lengths_of(exact);
    for (const auto& [key, length] : wanted) {
      const auto at = found.find(key);
      EXPECT_NEAR(at == found.end() ? 0.0 : at->second, length, 1.0) << what << ", " << name_of(key.first) << " behind " << key.second;
    }
    for (const auto& [key, length] : found)
      EXPECT_TRUE(length < 1.0 || wanted.contains(key)) << what << ", " << name_of(key.first) << " behind " << key.second;
  }
}

TEST(LevelSetLines, WhatOnlyTouchesStaysApart) {
  Scene scene;
  for (const double x : {-0.5, 0.5}) scene.objects.push_back(grid_of("ball", ball(0.5, {x, 0.0, 0.0}), 0.01));
  std::mt19937 random(random_seed());
  for (int view = 0; view < 4; ++view) {
    const ViewGraph graph = solve_lines(scene, random_view(random, bounds(scene), true), {}, {});
    for (const LineEdge& edge : graph.edges) EXPECT_EQ(edge.line_class, LineClass::contour) << view;
    EXPECT_GE(graph.chains.size(), 2u) << view;
  }
}

}  // namespace
}  // namespace limn
