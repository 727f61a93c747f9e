// Lines that are edges: of a box, of a mesh like it, and of triangles that the picture cuts.

#include <gtest/gtest.h>

#include <array>
#include <set>

#include "raymarch/surface.h"
#include "tests/random_seed.h"
#include "tests/raymarch/drawn_lines.h"

namespace limn {
namespace {

constexpr int kViews = 40;

TEST(Lines, ABoxHasTwelveEdgesOfWhichNineAtMostAreSeen) {
  std::mt19937 random(random_seed());
  const glm::dvec3 half(0.8, 0.6, 0.5);
  const Scene scene = scene_of(make_shape("box", {{"half", {half.x, half.y, half.z}}}));
  for (int view = 0; view < kViews; ++view) {
    const Camera camera = random_camera(random, scene, view % 2 == 0);
    const ViewGraph graph = lines_of(scene, camera);
    expect_sound(graph, fmt::format("view {}", view));
    std::vector<Polyline> edges;
    for (int axis = 0; axis < 3; ++axis) {
      for (int i = 0; i < 4; ++i) {
        glm::dvec3 a = half, b;
        a[(axis + 1) % 3] *= i & 1 ? -1.0 : 1.0;
        a[(axis + 2) % 3] *= i & 2 ? -1.0 : 1.0;
        b = a;
        b[axis] = -b[axis];
        Polyline line;
        for (int k = 0; k <= 300; ++k) line.emplace_back(project(camera, glm::mix(a, b, k / 300.0)));
        edges.push_back(line);
      }
    }
    std::vector<Polyline> found = drawn(graph, LineClass::contour, false), creases = drawn(graph, LineClass::crease, false);
    found.insert(found.end(), creases.begin(), creases.end());
    expect_same(edges, found, fmt::format("view {}", view));
    double seen = 0.0, all = 0.0;
    for (const LineEdge& edge : graph.edges) {
      double length = 0.0;
      for (size_t i = 0; i + 1 < edge.points.size(); ++i) length += glm::distance(edge.points[i].position, edge.points[i + 1].position);
      all += length;
      if (edge.invisibility == 0) seen += length;
    }
    EXPECT_NEAR(all, 8.0 * (half.x + half.y + half.z), 1e-3);
    EXPECT_LT(seen, all);
  }
}

TEST(Lines, AMeshOfACubeIsAsTheField) {
  std::mt19937 random(random_seed());
  Mesh cube;
  for (int i = 0; i < 8; ++i) cube.positions.emplace_back(i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0);
  cube.face_sizes = {4, 4, 4, 4, 4, 4};
  cube.corner_vertices = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
  Scene mesh;
  mesh.objects.push_back({.name = "cube", .source = MeshSource{cube}});
  const Scene field = scene_of(make_shape("box", {{"half", {1.0, 1.0, 1.0}}}));
  for (int view = 0; view < kViews; ++view) {
    const Camera camera = random_camera(random, field, view % 2 == 0);
    const ViewGraph a = lines_of(mesh, camera), b = lines_of(field, camera);
    expect_sound(a, fmt::format("view {}", view));
    for (const LineClass line_class : {LineClass::contour, LineClass::crease}) {
      for (const bool visible : {true, false}) {
        const std::vector<Polyline> one = drawn(a, line_class, visible), other = drawn(b, line_class, visible);
        for (const Polyline& line : one) {
          for (const glm::dvec2& p : line) EXPECT_LE(distance_to(other, p), 0.01);
        }
        for (const Polyline& line : other) {
          for (const glm::dvec2& p : line) EXPECT_LE(distance_to(one, p), 0.01);
        }
      }
    }
  }
}

/// What the picture shows of the edge from a to b, by brute force: image points, and their length.
struct ShownEdge {
  std::vector<glm::dvec2> px{};
  double length = 0.0;
  bool from_outside_to_outside = false;
  double flattest_cut = 1.0;  ///< Sine of the angle at which it meets a side of the picture that cuts it.
};
ShownEdge shown_edge(const Camera& camera, const glm::dvec3& a, const glm::dvec3& b) {
  // In front of the eye and within the picture's four sides: each a function that is linear along the edge, so that what is seen of it is
  // one stretch.
  const auto sides_at = [&camera](const glm::dvec3& point) {
    const glm::dvec3 image = project(camera, point);
    const double w = camera.projection == Projection::perspective ? image.z : 1.0;
    return std::array{image.z, w * image.x, w * image.y, w * (camera.width_px - image.x), w * (camera.height_px - image.y)};
  };
  const auto from = sides_at(a), to = sides_at(b);
  double first = 0.0, last = 1.0;
  size_t first_side = 0, last_side = 0;
  for (size_t side = 0; side < from.size(); ++side) {
    const double crossing = from[side] / (from[side] - to[side]);
    if (from[side] < 0.0 && to[side] < 0.0) return {};
    if (from[side] < 0.0 && crossing > first) first = crossing, first_side = side;
    if (to[side] < 0.0 && crossing < last) last = crossing, last_side = side;
  }
  ShownEdge edge;
  if (first >= last) return edge;
  const glm::dvec2 begin(project(camera, glm::mix(a, b, first))), end(project(camera, glm::mix(a, b, last)));
  constexpr int kSteps = 400;
  for (int step = 0; step <= kSteps; ++step) edge.px.push_back(glm::mix(begin, end, step / static_cast<double>(kSteps)));
  edge.length = glm::distance(begin, end);
  edge.from_outside_to_outside = first > 0.0 && last < 1.0;
  const glm::dvec2 along = glm::abs(end - begin) / edge.length;
  const auto across_side = [&along](size_t side) { return side == 1 || side == 3 ? along.x : side == 2 || side == 4 ? along.y : 1.0; };
  edge.flattest_cut = std::min(first > 0.0 ? across_side(first_side) : 1.0, last < 1.0 ? across_side(last_side) : 1.0);
  return edge;
}

// Across corners of the picture, and past the eye.
TEST(Lines, EdgesThatEndOutsideOfThePictureAreCutByIt) {
  std::mt19937 random(random_seed());
  constexpr double kTolerance_px = 0.005;  // LineSettings::tolerance_px
  int across = 0, far_from_eye = 0;
  for (int k = 0; k < 400; ++k) {
    CameraSettings settings{.eye = glm::dvec3(0.0, 0.0, 5.0), .target = glm::dvec3(0.0), .width_px = 640, .height_px = 480};
    if (k % 2 == 0) settings.projection = Projection::orthographic;
    if (k % 2 == 0) settings.ortho_height = 3.0;
    const Camera camera = resolve_camera(settings, {glm::dvec3(-3.0), glm::dvec3(3.0)});
    Mesh triangle;
    std::uniform_real_distribution<double> side(-4.0, 4.0), depth(-4.0, k % 4 == 1 ? 8.0 : 4.0);
    for (int i = 0; i < 3; ++i) triangle.positions.emplace_back(side(random), side(random), depth(random));
    triangle.face_sizes = {3};
    triangle.corner_vertices = {0, 1, 2};
    Scene scene;
    scene.objects.push_back({.name = "triangle", .source = MeshSource{triangle}});
    const ViewGraph graph = lines_of(scene, camera);
    const std::vector<Polyline> found = drawn(graph, LineClass::boundary, true);
    double length = 0.0, expected = 0.0, farthest = 0.0, flattest_cut = 1.0;
    for (const Polyline& line : found)
      for (size_t i = 0; i + 1 < line.size(); ++i) length += glm::distance(line[i], line[i + 1]);
    for (size_t i = 0; i < 3; ++i) {
      const ShownEdge edge = shown_edge(camera, triangle.positions[i], triangle.positions[(i + 1) % 3]);
      expected += edge.length;
      across += edge.from_outside_to_outside ? 1 : 0;
      flattest_cut = std::min(flattest_cut, edge.flattest_cut);
      for (const glm::dvec2& p : edge.px) farthest = std::max(farthest, distance_to(found, p));
    }
    // By what the view is turned on purpose, a tenth of the tolerance at most unless the bound says more, an end is farther off, the
    // flatter it meets the picture's side.
    const double turn_px = std::max(0.1 * kTolerance_px, graph.bound_px - kTolerance_px), end_px = 2.0 * turn_px / flattest_cut;
    EXPECT_LT(farthest, std::max(0.05, end_px)) << "triangle " << k;
    EXPECT_NEAR(length, expected, std::max(0.02, end_px)) << "triangle " << k;
    far_from_eye += graph.bound_px == kTolerance_px;
  }
  EXPECT_GT(across, 40);
  EXPECT_GT(far_from_eye, 300);
}

}  // namespace
}  // namespace limn
