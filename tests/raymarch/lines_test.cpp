// View graphs against closed forms: every curve is found and none besides, and what is hidden is hidden.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "raymarch/lines.h"
#include "raymarch/surface.h"
#include "sdf/level_set.h"
#include "sdf/segment.h"
#include "sdf/shape.h"
#include "tests/random_seed.h"
#include "tests/raymarch/drawn_lines.h"

namespace limn {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kViews = 40;

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
