// View graphs against closed forms: every curve is found and none besides, and what is hidden is hidden.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <set>

#include "raymarch/lines.h"
#include "raymarch/surface.h"
#include "sdf/level_set.h"
#include "sdf/segment.h"
#include "sdf/shape.h"
#include "tests/random_seed.h"
#include "tests/raymarch/line_views.h"

namespace limn {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kViews = 40;

Scene scene_of(const Field& field) {
  Scene scene;
  scene.objects.push_back({.name = "shape", .source = field});
  return scene;
}

/// A random direction, near or far, either projection.
Camera random_camera(std::mt19937& random, const Scene& scene, bool perspective) {
  std::normal_distribution<double> normal;
  const glm::dvec3 direction = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
  return line_view(bounds(scene), direction, std::uniform_real_distribution<double>(2.5, 6.0)(random), perspective);
}

ViewGraph lines_of(const Scene& scene, const Camera& camera) { return solve_lines(scene, camera, {}, {}); }

using Polyline = std::vector<glm::dvec2>;

double distance_to(const std::vector<Polyline>& lines, const glm::dvec2& p) {
  double least = 1e9;
  for (const Polyline& line : lines) {
    for (size_t i = 0; i + 1 < line.size(); ++i) {
      // The ends say how near a step can be.
      const double length = std::fabs(line[i + 1].x - line[i].x) + std::fabs(line[i + 1].y - line[i].y);
      if (std::max(std::fabs(p.x - line[i].x), std::fabs(p.y - line[i].y)) - length > least) continue;
      least = std::min(least, distance_to_segment(p, line[i], line[i + 1]));
    }
  }
  return least;
}

/// Lines of a graph's chains, those of one class, or with `visible` the visible ones alone.
std::vector<Polyline> drawn(const ViewGraph& graph, LineClass line_class, bool visible) {
  std::vector<Polyline> lines;
  for (const LineChain& chain : graph.chains) {
    if (chain.line_class != line_class || (visible && chain.invisibility > 0)) continue;
    Polyline line;
    for (const LinePoint& point : points_of(graph, chain)) line.push_back(point.px);
    if (chain.closed) line.push_back(line.front());
    lines.push_back(std::move(line));
  }
  return lines;
}

/// Both ways: everything of one near the other.
void expect_same(const std::vector<Polyline>& exact, const std::vector<Polyline>& found, const std::string& what) {
  const auto worst = [](const std::vector<Polyline>& lines, const std::vector<Polyline>& others) {
    std::pair<double, glm::dvec2> most(0.0, 0.0);
    for (const Polyline& line : lines) {
      for (const glm::dvec2& p : line) {
        if (const double off = distance_to(others, p); off > most.first) most = {off, p};
      }
    }
    return most;
  };
  const auto [beside, beside_at] = worst(found, exact);
  const auto [missing, missing_at] = worst(exact, found);
  EXPECT_LE(beside, 0.01) << what << fmt::format(": drawn where no line is, at {}, {}", beside_at.x, beside_at.y);
  EXPECT_LE(missing, 0.01) << what << fmt::format(": not drawn at {}, {}", missing_at.x, missing_at.y);
}

void expect_sound(const ViewGraph& graph, const std::string& what) {
  EXPECT_TRUE(graph.conflicts.empty()) << what << ": " << graph.conflicts.front().what;
  std::vector<int> uses(graph.edges.size(), 0);
  for (const LineChain& chain : graph.chains) {
    for (const ChainLink& link : chain.links) {
      ++uses[static_cast<size_t>(link.edge)];
      EXPECT_EQ(graph.edges[static_cast<size_t>(link.edge)].invisibility, chain.invisibility) << what;
    }
  }
  EXPECT_TRUE(std::all_of(uses.begin(), uses.end(), [](int n) { return n == 1; })) << what << ": an edge is not in just one chain";
  for (const LineEdge& edge : graph.edges) {
    EXPECT_GE(edge.points.size(), 2u) << what;
    EXPECT_GE(edge.invisibility, 0) << what;
  }
}

/// Points of an ellipsoid's contour: where the polar plane of the eye cuts it.
std::vector<Polyline> ellipsoid_contour(const Camera& camera, const glm::dvec3& axes) {
  // In the space where it is the unit ball the contour is the circle dot(q, e) = 1, or a great circle across the view.
  const glm::dvec3 e = camera.projection == Projection::perspective ? camera.eye / axes : camera.world_from_camera[2] / axes;
  const double length = glm::length(e);
  const glm::dvec3 axis = e / length;
  const double height = camera.projection == Projection::perspective ? 1.0 / length : 0.0, radius = std::sqrt(1.0 - height * height);
  const glm::dvec3 x = glm::normalize(glm::cross(axis, std::fabs(axis.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0))),
                   y = glm::cross(axis, x);
  Polyline line;
  constexpr int kSteps = 6000;
  for (int i = 0; i <= kSteps; ++i) {
    const double t = 2.0 * kPi * i / kSteps;
    line.emplace_back(project(camera, axes * (height * axis + radius * (std::cos(t) * x + std::sin(t) * y))));
  }
  return {line};
}

TEST(Lines, ContoursOfEllipsoidsAreTheirPolarConics) {
  std::mt19937 random(random_seed());
  for (int view = 0; view < kViews; ++view) {
    for (const bool perspective : {true, false}) {
      const glm::dvec3 axes = view % 2 == 0 ? glm::dvec3(1.0) : glm::dvec3(1.1, 0.6, 0.8);
      const Scene scene = scene_of(make_shape("ellipsoid", {{"radii", {axes.x, axes.y, axes.z}}}));
      const Camera camera = random_camera(random, scene, perspective);
      const ViewGraph graph = lines_of(scene, camera);
      const std::string what = fmt::format("view {}, {}", view, perspective ? "perspective" : "orthographic");
      ASSERT_EQ(graph.chains.size(), 1u) << what;
      EXPECT_TRUE(graph.chains[0].closed) << what;
      EXPECT_EQ(graph.chains[0].invisibility, 0) << what;
      expect_same(ellipsoid_contour(camera, axes), drawn(graph, LineClass::contour, false), what);
      expect_sound(graph, what);
    }
  }
}

constexpr double kMajor = 1.0, kMinor = 0.38;

/// The contour of a torus about the y axis: at every angle u around it N.V = 0 is A cos v + B sin v = C for the angle v around the tube.
/// Where its two solutions meet the curve turns back: there u is spaced so that points are as far apart as elsewhere.
std::vector<Polyline> torus_contour(const Camera& camera) {
  const bool perspective = camera.projection == Projection::perspective;
  const glm::dvec3 e = perspective ? camera.eye : camera.world_from_camera[2];
  const double c = perspective ? kMinor : 0.0;
  const auto parts = [&](double u) {
    const double across = e.x * std::cos(u) + e.z * std::sin(u);
    return glm::dvec2(perspective ? across - kMajor : across, e.y);
  };
  const auto exists = [&](double u) { return glm::length(parts(u)) >= c; };
  std::vector<glm::dvec2> ranges;
  constexpr int kSteps = 4000;
  const auto edge = [&](double in, double out) {
    for (int i = 0; i < 60; ++i) (exists(0.5 * (in + out)) ? in : out) = 0.5 * (in + out);
    return in;
  };
  for (int i = 0; i < kSteps; ++i) {
    const double before = 2.0 * kPi * (i - 1) / kSteps, u = 2.0 * kPi * i / kSteps, next = 2.0 * kPi * (i + 1) / kSteps;
    if (exists(u) && (i == 0 || !exists(before))) ranges.emplace_back(exists(before) ? u : edge(u, before), u);
    if (exists(u)) ranges.back().y = exists(next) ? next : edge(u, next);
  }
  std::vector<Polyline> lines;
  for (const glm::dvec2& range : ranges) {
    for (const double side : {1.0, -1.0}) {
      const auto at = [&](double share) {
        const double u = 0.5 * (range.x + range.y) - 0.5 * (range.y - range.x) * std::cos(kPi * share);
        const glm::dvec2 ab = parts(u);
        const double v = std::atan2(ab.y, ab.x) + side * std::acos(std::min(1.0, c / glm::length(ab))), r = kMajor + kMinor * std::cos(v);
        return glm::dvec2(project(camera, glm::dvec3(r * std::cos(u), kMinor * std::sin(v), r * std::sin(u))));
      };
      // Seen nearly from the side the angle around the tube changes all at once: steps are halved until they are short.
      Polyline line{at(0.0)};
      const auto add = [&](const auto& self, double from, double to, int depth) -> void {
        const glm::dvec2 p = at(to);
        if (depth > 0 && glm::distance(p, line.back()) > 0.3) {
          self(self, from, 0.5 * (from + to), depth - 1);
          self(self, 0.5 * (from + to), to, depth - 1);
          return;
        }
        line.push_back(p);
      };
      for (int i = 0; i < kSteps; ++i) add(add, static_cast<double>(i) / kSteps, (i + 1.0) / kSteps, 16);
      lines.push_back(std::move(line));
    }
  }
  return lines;
}

/// How often the torus' surface is gone through on the way to the eye, by sampling.
int torus_layers(const Camera& camera, const glm::dvec3& from) {
  const glm::dvec3 direction = view_vector(camera, from);
  const auto value = [&](double t) {
    const glm::dvec3 p = from + t * direction;
    return glm::length(glm::dvec2(std::hypot(p.x, p.z) - kMajor, p.y)) - kMinor;
  };
  int layers = 0;
  bool inside = value(1e-3) < 0.0;
  for (double t = 1e-3; t < 4.0; t += 2e-4) {
    if ((value(t) < 0.0) == inside) continue;
    inside = !inside;
    ++layers;
  }
  return layers;
}

TEST(Lines, ContoursOfTheTorusWithTheirCusps) {
  std::mt19937 random(random_seed());
  const Scene scene = scene_of(make_shape("torus", {{"major", {kMajor}}, {"minor", {kMinor}}}));
  int cusps = 0;
  for (int view = 0; view < kViews; ++view) {
    for (const bool perspective : {true, false}) {
      const Camera camera = random_camera(random, scene, perspective);
      const ViewGraph graph = lines_of(scene, camera);
      const std::string what = fmt::format("view {}, {}", view, perspective ? "perspective" : "orthographic");
      expect_same(torus_contour(camera), drawn(graph, LineClass::contour, false), what);
      expect_sound(graph, what);
      int here = 0;
      for (const LineVertex& vertex : graph.vertices) here += vertex.kind == VertexKind::cusp;
      EXPECT_EQ(here % 2, 0) << what;
      cusps += here;
      // A contour that bends towards the eye starts inside the torus: its ray is told by the parity alone. The other ones are counted.
      for (const LineEdge& edge : graph.edges) {
        const LinePoint& middle = edge.points[edge.points.size() / 2];
        if (glm::distance(middle.px, edge.points.front().px) < 2.0 || glm::distance(middle.px, edge.points.back().px) < 2.0) continue;
        // So near to 0 a swallowtail begins: its two cusps lie within 0.05 px, as near as a change is known.
        if (std::fabs(middle.radial_curvature) < 0.02) continue;
        EXPECT_EQ(edge.invisibility % 2, middle.radial_curvature < 0.0 ? 1 : 0) << what;
        if (middle.radial_curvature < 0.0) continue;
        EXPECT_EQ(edge.invisibility, torus_layers(camera, middle.position + 1e-6 * middle.normal)) << what;
      }
    }
  }
  EXPECT_GT(cusps, 50);
}

/// Andrew's monotone chain: the outline of what is convex.
Polyline convex_hull(std::vector<glm::dvec2> points) {
  std::sort(points.begin(), points.end(), [](const glm::dvec2& a, const glm::dvec2& b) { return std::tie(a.x, a.y) < std::tie(b.x, b.y); });
  Polyline hull;
  for (int pass = 0; pass < 2; ++pass) {
    const size_t start = hull.size();
    for (const glm::dvec2& p : points) {
      while (hull.size() >= start + 2) {
        const glm::dvec2 u = hull.back() - hull[hull.size() - 2], v = p - hull.back();
        if (u.x * v.y - u.y * v.x > 0.0) break;
        hull.pop_back();
      }
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  hull.push_back(hull.front());
  return hull;
}

std::vector<glm::dvec2> circle_px(const Camera& camera, double radius, double y) {
  std::vector<glm::dvec2> points;
  constexpr int kSteps = 8000;
  for (int i = 0; i < kSteps; ++i) {
    const double u = 2.0 * kPi * i / kSteps;
    points.emplace_back(project(camera, glm::dvec3(radius * std::cos(u), y, radius * std::sin(u))));
  }
  return points;
}

/// A convex solid of revolution: its outline is the hull of its circles, and each sharp circle is a line all around. Returns the number of
/// points of its circles that were looked for.
int expect_convex_solid(const Field& field, const std::vector<glm::dvec2>& circles, bool apex, double apex_y, std::mt19937& random) {
  const Scene scene = scene_of(field);
  int looked_for = 0;
  for (int view = 0; view < kViews; ++view) {
    const Camera camera = random_camera(random, scene, view % 2 == 0);
    std::vector<glm::dvec2> all;
    std::vector<Polyline> rings;
    for (const glm::dvec2& circle : circles) {
      const std::vector<glm::dvec2> points = circle_px(camera, circle.x, circle.y);
      all.insert(all.end(), points.begin(), points.end());
      rings.emplace_back(points);
      rings.back().push_back(points.front());
    }
    if (apex) all.emplace_back(project(camera, glm::dvec3(0.0, apex_y, 0.0)));
    const ViewGraph graph = lines_of(scene, camera);
    const std::string what = fmt::format("view {}", view);
    expect_sound(graph, what);
    expect_same({convex_hull(all)}, drawn(graph, LineClass::contour, true), what + ", outline");
    std::vector<Polyline> found = drawn(graph, LineClass::crease, false);
    for (const Polyline& line : found) {
      for (const glm::dvec2& p : line) EXPECT_LE(distance_to(rings, p), 0.01) << what;
    }
    const std::vector<Polyline> contours = drawn(graph, LineClass::contour, false);
    found.insert(found.end(), contours.begin(), contours.end());
    for (const Polyline& ring : rings) {
      for (size_t i = 0; i < ring.size(); i += 7) {
        EXPECT_LE(distance_to(found, ring[i]), 0.01) << what << ": a rim is not drawn";
        ++looked_for;
      }
    }
  }
  return looked_for;
}

TEST(Lines, CylindersConesAndTurnedPolygons) {
  std::mt19937 random(random_seed());
  constexpr int kPointsOfCircle = kViews * 8000 / 7;  // every seventh of 8,000
  EXPECT_GE(expect_convex_solid(make_shape("cylinder", {{"radius", {0.6}}, {"half_height", {0.8}}}), {{0.6, 0.8}, {0.6, -0.8}}, false, 0.0,
                                random),
            2 * kPointsOfCircle);
  const double radius = 1.6 * std::tan(25.0 * kPi / 180.0);
  EXPECT_GE(expect_convex_solid(make_shape("cone"), {{radius, -0.8}}, true, 0.8, random), kPointsOfCircle);
  EXPECT_GE(expect_convex_solid(make_shape("revolution", {{"profile", {0.0, -0.5, 0.4, -0.5, 0.7, 0.0, 0.5, 0.6, 0.0, 0.6}}}),
                                {{0.4, -0.5}, {0.7, 0.0}, {0.5, 0.6}}, false, 0.0, random),
            3 * kPointsOfCircle);
}

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
  for (size_t side = 0; side < from.size(); ++side) {
    const double crossing = from[side] / (from[side] - to[side]);
    if (from[side] < 0.0) first = to[side] < 0.0 ? 2.0 : std::max(first, crossing);
    if (from[side] >= 0.0 && to[side] < 0.0) last = std::min(last, crossing);
  }
  ShownEdge edge;
  if (first >= last) return edge;
  const glm::dvec2 begin(project(camera, glm::mix(a, b, first))), end(project(camera, glm::mix(a, b, last)));
  constexpr int kSteps = 400;
  for (int step = 0; step <= kSteps; ++step) edge.px.push_back(glm::mix(begin, end, step / static_cast<double>(kSteps)));
  edge.length = glm::distance(begin, end);
  edge.from_outside_to_outside = first > 0.0 && last < 1.0;
  return edge;
}

// Across corners of the picture, and past the eye.
TEST(Lines, EdgesThatEndOutsideOfThePictureAreCutByIt) {
  std::mt19937 random(random_seed());
  int across = 0;
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
    const std::vector<Polyline> found = drawn(lines_of(scene, camera), LineClass::boundary, true);
    double length = 0.0, expected = 0.0, farthest = 0.0;
    for (const Polyline& line : found)
      for (size_t i = 0; i + 1 < line.size(); ++i) length += glm::distance(line[i], line[i + 1]);
    for (size_t i = 0; i < 3; ++i) {
      const ShownEdge edge = shown_edge(camera, triangle.positions[i], triangle.positions[(i + 1) % 3]);
      expected += edge.length;
      across += edge.from_outside_to_outside ? 1 : 0;
      for (const glm::dvec2& p : edge.px) farthest = std::max(farthest, distance_to(found, p));
    }
    EXPECT_LT(farthest, 0.05) << "triangle " << k;
    EXPECT_NEAR(length, expected, 0.02) << "triangle " << k;
  }
  EXPECT_GT(across, 40);
}

TEST(Lines, ContoursOfLevelSetsConvergeWithOrderTwo) {
  const Field field = make_shape("ellipsoid", {{"radii", {1.0, 0.7, 0.85}}});
  CameraSettings settings;
  settings.direction = glm::dvec3(0.5, 0.4, 1.0);
  settings.width_px = 640;
  settings.height_px = 360;
  const Camera camera = resolve_camera(settings, field.traits().bounds);
  const std::vector<Polyline> exact = ellipsoid_contour(camera, {1.0, 0.7, 0.85});
  std::vector<double> worst;
  for (const int voxels : {32, 64, 128, 256}) {
    LevelSetSettings building;
    building.voxel_size = 2.0 / voxels;
    building.half_width_voxels = 4.0;
    Scene scene;
    scene.objects.push_back({.name = "grid", .source = LevelSetSource{level_set_from_field(field, building)}});
    const ViewGraph graph = lines_of(scene, camera);
    expect_sound(graph, fmt::format("{} voxels", voxels));
    ASSERT_EQ(graph.chains.size(), 1u) << voxels;
    double most = 0.0;
    for (const Polyline& line : drawn(graph, LineClass::contour, false)) {
      for (const glm::dvec2& p : line) most = std::max(most, distance_to(exact, p));
    }
    worst.push_back(most);
  }
  EXPECT_LE(worst[3], 0.05);
  // Until the tolerance of the tracing, 0.005 px, is reached.
  for (size_t i = 0; i + 1 < worst.size(); ++i)
    EXPECT_TRUE(worst[i + 1] < worst[i] / 3.0 || worst[i + 1] < 0.01) << worst[i] << " " << worst[i + 1];
}

TEST(Lines, TwoObjectsIntersect) {
  // Two balls that share a disc: their intersection is a circle.
  Scene scene;
  scene.objects.push_back({.name = "one", .source = translate(make_shape("sphere", {{"radius", {0.6}}}), {-0.3, 0.0, 0.0})});
  scene.objects.push_back({.name = "two", .source = translate(make_shape("sphere", {{"radius", {0.6}}}), {0.3, 0.0, 0.0})});
  CameraSettings settings;
  settings.direction = glm::dvec3(0.8, 0.5, 1.0);
  settings.width_px = 640;
  settings.height_px = 360;
  const Camera camera = resolve_camera(settings, bounds(scene));
  const ViewGraph graph = lines_of(scene, camera);
  expect_sound(graph, "balls");
  Polyline circle;
  const double radius = std::sqrt(0.36 - 0.09);
  for (int i = 0; i <= 4000; ++i) {
    const double u = 2.0 * kPi * i / 4000;
    circle.emplace_back(project(camera, glm::dvec3(0.0, radius * std::cos(u), radius * std::sin(u))));
  }
  expect_same({circle}, drawn(graph, LineClass::intersection, false), "intersection");
  EXPECT_EQ(std::count_if(graph.chains.begin(), graph.chains.end(), [](const LineChain& c) { return c.line_class == LineClass::crease; }),
            0);
}

TEST(Lines, WhereObjectsOfTwoMaterialsMeetIsAMaterialLine) {
  const std::vector<Field> balls = {translate(make_shape("sphere", {{"radius", {0.6}}}), {-0.3, 0.0, 0.0}),
                                    translate(make_shape("sphere", {{"radius", {0.6}}}), {0.3, 0.0, 0.0})};
  for (const std::string kind : {"field", "mesh", "level set"}) {
    Scene scene;
    for (const Field& ball : balls) {
      SceneObject object{.name = "ball", .source = ball};
      LevelSetSettings building;
      building.voxel_size = 0.04;
      if (kind == "level set") object.source = LevelSetSource{level_set_from_field(ball, building)};
      if (kind == "mesh") {
        SurfaceSettings settings;
        settings.kind = "mesh";
        settings.level = 3;
        const Scene one{"", {}, {object}};
        object = modelled_scene(one, build_model(one, settings)).objects[0];
      }
      scene.objects.push_back(object);
    }
    CameraSettings looking;
    looking.direction = glm::dvec3(0.8, 0.5, 1.0);
    const Camera camera = resolve_camera(looking, bounds(scene));
    const auto count = [&](const std::vector<LineClass>& classes, LineClass of) {
      LineSettings settings;
      settings.classes = classes;
      const ViewGraph graph = solve_lines(scene, camera, settings, {});
      return std::count_if(graph.edges.begin(), graph.edges.end(), [&](const LineEdge& edge) { return edge.line_class == of; });
    };
    EXPECT_EQ(count({LineClass::material}, LineClass::material), 0) << kind << ": one material";
    scene.objects[1].material = 3;
    EXPECT_GT(count({LineClass::material}, LineClass::material), 0) << kind;
    EXPECT_GT(count({LineClass::contour, LineClass::material}, LineClass::material), 0) << kind;
    // They are intersections where those are asked for.
    EXPECT_EQ(count({}, LineClass::material), 0) << kind;
    EXPECT_GT(count({}, LineClass::intersection), 0) << kind;
  }
}

TEST(Lines, SettingsOutOfRangeAreRefused) {
  const Scene scene = scene_of(make_shape("sphere"));
  const Camera camera = resolve_camera({}, bounds(scene));
  EXPECT_THROW(solve_lines(scene, camera, {.threshold = 0.0}, {}), InputError);
  EXPECT_THROW(solve_lines(scene, camera, {.threshold = 1.0}, {}), InputError);
  EXPECT_THROW(solve_lines(scene, camera, {.crease_angle_deg = 180.0}, {}), InputError);
  EXPECT_THROW(solve_lines(scene, camera, {.tolerance_px = 0.0}, {}), InputError);
}

}  // namespace
}  // namespace limn
