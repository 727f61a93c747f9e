// Suggestive contours, ridges and valleys of meshes of facets, against those of the shapes that were sampled.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "sdf/error.h"
#include "sdf/shape.h"
#include "tests/random_seed.h"
#include "tests/raymarch/feature_drawings.h"

namespace limn {
namespace {

constexpr double kPi = std::numbers::pi;

/// Quads of a torus, n around the tube, twice as many around the axis; vertices lie off it by `noise` of the tube's radius, normally.
Mesh torus_mesh(int n, double noise, std::mt19937& random) {
  std::normal_distribution<double> normal;
  Mesh mesh;
  for (int i = 0; i < 2 * n; ++i) {
    for (int k = 0; k < n; ++k) {
      const double u = kPi * i / n, v = 2.0 * kPi * k / n, minor = kMinor * (1.0 + noise * normal(random)),
                   ring = kMajor + minor * std::cos(v);
      mesh.positions.emplace_back(ring * std::cos(u), minor * std::sin(v), ring * std::sin(u));
      const auto at = [&](int a, int b) { return a % (2 * n) * n + b % n; };
      mesh.face_sizes.push_back(4);
      for (const int corner : {at(i, k), at(i, k + 1), at(i + 1, k + 1), at(i + 1, k)}) mesh.corner_vertices.push_back(corner);
    }
  }
  return mesh;
}

Scene scene_of(const Mesh& mesh) {
  Scene scene;
  scene.objects.push_back({.name = "mesh", .source = mesh_source(mesh, {}, "")});
  return scene;
}

double length_px(const ViewGraph& graph, LineClass line_class, bool visible_alone = false) {
  double sum = 0.0;
  for (const LineEdge& edge : graph.edges) {
    if (edge.line_class != line_class || (visible_alone && edge.invisibility > 0)) continue;
    for (size_t i = 0; i + 1 < edge.points.size(); ++i) sum += glm::distance(edge.points[i].px, edge.points[i + 1].px);
  }
  return sum;
}

TEST(MeshFeatureLines, SuggestiveContoursOfATorusConvergeToTheFields) {
  std::mt19937 random(random_seed());
  const Scene exact = scene_of(make_shape("torus", {{"major", {kMajor}}, {"minor", {kMinor}}}));
  const Camera camera = camera_from({0.3, -0.9, 0.75}, bounds(exact), true);
  const LineSettings strict{.classes = {LineClass::suggestive}, .suggestive_angle_deg = 25.0, .suggestive_slope = 3.0};
  const LineSettings loose{.classes = {LineClass::suggestive}, .suggestive_angle_deg = 20.0, .suggestive_slope = 1.0};
  const ViewGraph exact_strict = solve_lines(exact, camera, strict, {}), exact_loose = solve_lines(exact, camera, loose, {});
  for (const bool smooth : {false, true}) {
    std::vector<double> off;
    for (const int n : {32, 64, 128}) {
      const Scene scene = scene_of(torus_mesh(n, 0.0, random));
      LineSettings found_strict = strict, found_loose = loose;
      found_strict.smooth_meshes = found_loose.smooth_meshes = smooth;
      const ViewGraph one = solve_lines(scene, camera, found_strict, {}), other = solve_lines(scene, camera, found_loose, {});
      EXPECT_GT(length_px(one, LineClass::suggestive), 0.8 * length_px(exact_strict, LineClass::suggestive));
      EXPECT_TRUE(one.conflicts.empty());
      off.push_back(std::max(farthest(exact_strict, other), farthest(one, exact_loose)));
    }
    const std::string all = fmt::format("{}: {:.3g} {:.3g} {:.3g} px", smooth ? "smooth" : "facets", off[0], off[1], off[2]);
    std::printf("%s\n", all.c_str());
    EXPECT_LE(off[1], off[0] / 1.8) << all;
    EXPECT_LE(off[2], off[1] / 1.8) << all;
    EXPECT_LE(off[2], 1.0) << all;
  }
}

TEST(MeshFeatureLines, RidgesOfAnEllipsoidLieInItsPlanesOfSymmetry) {
  std::mt19937 random(random_seed());
  const glm::dvec3 axes(1.1, 0.6, 0.8);
  Mesh mesh;
  constexpr int kRings = 60, kAround = 120;
  for (const double z : {-1.0, 1.0}) mesh.positions.emplace_back(0.0, 0.0, z * axes.z);
  for (int i = 1; i < kRings; ++i) {
    for (int k = 0; k < kAround; ++k) {
      const double v = kPi * i / kRings, u = 2.0 * kPi * (k + 0.25) / kAround;
      mesh.positions.push_back(axes * glm::dvec3(std::sin(v) * std::cos(u), std::sin(v) * std::sin(u), -std::cos(v)));
    }
  }
  const auto at = [&](int i, int k) { return 2 + (i - 1) * kAround + k % kAround; };
  const auto add = [&](std::initializer_list<int> corners) {
    mesh.face_sizes.push_back(static_cast<std::int32_t>(corners.size()));
    mesh.corner_vertices.insert(mesh.corner_vertices.end(), corners.begin(), corners.end());
  };
  for (int k = 0; k < kAround; ++k) {
    add({0, at(1, k + 1), at(1, k)});
    add({1, at(kRings - 1, k), at(kRings - 1, k + 1)});
    for (int i = 1; i + 1 < kRings; ++i) add({at(i, k), at(i, k + 1), at(i + 1, k + 1), at(i + 1, k)});
  }
  const Scene scene = scene_of(mesh);
  for (int round = 0; round < 4; ++round) {
    const Camera camera = camera_from(random_direction(random), bounds(scene), round % 2 == 0);
    const ViewGraph graph =
        solve_lines(scene, camera, {.classes = {LineClass::suggestive, LineClass::ridge, LineClass::valley}, .ridge_strength = 1.0}, {});
    EXPECT_TRUE(graph.conflicts.empty());
    EXPECT_EQ(length_px(graph, LineClass::valley), 0.0);
    EXPECT_EQ(length_px(graph, LineClass::suggestive), 0.0);
    EXPECT_GT(length_px(graph, LineClass::ridge), 200.0);
    double worst = 0.0;
    for (const Polyline& line : edges_of(graph, LineClass::ridge)) {
      for (const LinePoint& point : line) {
        const glm::dvec3 off = glm::abs(point.position / axes);
        // At the poles a hundred slivers meet.
        if (off.z < 0.9) worst = std::max(worst, std::min({off.x, off.y, off.z}));
      }
    }
    EXPECT_LE(worst, 0.05) << round;
  }
}

TEST(MeshFeatureLines, LinesLieOnTheFacetsAndRaysAgreeOnWhatHidesThem) {
  std::mt19937 random(random_seed());
  // Two of them, that go through each other.
  Scene scene = scene_of(torus_mesh(24, 0.02, random));
  const glm::dvec3 aside(0.9, 0.15, 0.1);
  scene.objects.push_back(scene_of(torus_mesh(24, 0.02, random)).objects[0]);
  scene.objects[1].world_from_object.translation = aside;
  const LineSettings settings{
      .classes = {LineClass::contour, LineClass::intersection, LineClass::suggestive, LineClass::ridge, LineClass::valley}};
  double drawn = 0.0;
  for (int round = 0; round < 12; ++round) {
    const Camera camera = camera_from(random_direction(random), bounds(scene), round % 2 == 0);
    const ViewGraph graph = solve_lines(scene, camera, settings, {});
    for (const LineConflict& conflict : graph.conflicts)
      ADD_FAILURE() << "view " << round << " at " << conflict.px.x << ", " << conflict.px.y << ": " << conflict.what;
    for (const LineClass line_class : {LineClass::suggestive, LineClass::ridge, LineClass::valley}) {
      drawn += length_px(graph, line_class, true);
      for (const Polyline& line : edges_of(graph, line_class)) {
        // The facets' chords lie beneath the torus by no more than a wave of noise and their height.
        for (const LinePoint& point : line) {
          const auto off = [](const glm::dvec3& p) { return std::fabs(std::hypot(std::hypot(p.x, p.z) - kMajor, p.y) - kMinor); };
          EXPECT_LE(std::min(off(point.position), off(point.position - aside)), 0.05);
        }
      }
    }
  }
  EXPECT_GT(drawn, 1000.0);
}

TEST(MeshFeatureLines, FairingTakesTheLinesOfNoiseAndLeavesTheShapes) {
  std::mt19937 random(random_seed());
  const Scene exact = scene_of(make_shape("torus", {{"major", {kMajor}}, {"minor", {kMinor}}})),
              noisy = scene_of(torus_mesh(96, 0.002, random));
  const Camera camera = camera_from({0.3, -0.9, 0.75}, bounds(exact), true);
  const LineSettings plain{.classes = {LineClass::suggestive}, .suggestive_angle_deg = 25.0, .suggestive_slope = 3.0};
  const double wanted = length_px(solve_lines(exact, camera, plain, {}), LineClass::suggestive);
  for (const bool smooth : {false, true}) {
    LineSettings settings = plain;
    settings.smooth_meshes = smooth;
    const ViewGraph raw = solve_lines(noisy, camera, settings, {});
    settings.fairing_edges = 12.0;
    const ViewGraph faired = solve_lines(noisy, camera, settings, {});
    LineSettings loose = plain;
    loose.suggestive_slope = 0.5, loose.suggestive_angle_deg = 15.0;
    EXPECT_GT(length_px(raw, LineClass::suggestive), 2.0 * wanted) << smooth;
    EXPECT_LT(length_px(faired, LineClass::suggestive), 1.2 * wanted) << smooth;
    EXPECT_LT(farthest(faired, solve_lines(exact, camera, loose, {})), 4.0) << smooth;
    const bool noted = std::any_of(faired.notes.begin(), faired.notes.end(),
                                   [](const std::string& note) { return note.find("fairing moved vertices") != std::string::npos; });
    EXPECT_EQ(noted, smooth);
  }
}

TEST(MeshFeatureLines, BoxesHaveNone) {
  Mesh box;
  for (int i = 0; i < 8; ++i) box.positions.emplace_back(i & 1, i >> 1 & 1, i >> 2 & 1);
  box.corner_vertices = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
  box.face_sizes.assign(6, 4);
  const Scene scene = scene_of(box);
  std::mt19937 random(random_seed());
  for (const bool smooth : {false, true}) {
    const LineSettings settings{.classes = {LineClass::suggestive, LineClass::ridge, LineClass::valley},
                                .smooth_meshes = smooth,
                                .suggestive_slope = 0.01,
                                .ridge_strength = 0.01};
    const ViewGraph graph = solve_lines(scene, camera_from(random_direction(random), bounds(scene), true), settings, {});
    EXPECT_TRUE(graph.edges.empty());
    EXPECT_TRUE(graph.conflicts.empty());
  }
}

TEST(MeshFeatureLines, MirroredAndScaledTheyAreTheSame) {
  std::mt19937 random(random_seed());
  const Mesh mesh = torus_mesh(32, 0.01, random);
  for (const bool smooth : {false, true}) {
    const LineSettings settings{.classes = {LineClass::suggestive, LineClass::ridge, LineClass::valley}, .smooth_meshes = smooth};
    Scene scene = scene_of(mesh), mirrored = scene;
    const Camera camera = camera_from({0.5, 0.8, 0.4}, bounds(scene), true);
    constexpr double kScale = 3.0;
    mirrored.objects[0].world_from_object.linear = glm::dmat3(-kScale, 0.0, 0.0, 0.0, kScale, 0.0, 0.0, 0.0, kScale);
    CameraSettings looking;
    looking.eye = kScale * camera.eye * glm::dvec3(-1.0, 1.0, 1.0);
    looking.target = glm::dvec3(0.0);
    looking.width_px = camera.width_px, looking.height_px = camera.height_px;
    Camera other = resolve_camera(looking, bounds(mirrored));
    other.focal_px = camera.focal_px;
    const ViewGraph one = solve_lines(scene, camera, settings, {}), two = solve_lines(mirrored, other, settings, {});
    for (const LineClass line_class : settings.classes) {
      const double length = length_px(one, line_class);
      EXPECT_NEAR(length_px(two, line_class), length, 0.01 * length + 2.0) << smooth << " " << name_of(line_class);
    }
    EXPECT_GT(length_px(one, LineClass::suggestive), 20.0);
  }
}

TEST(MeshFeatureLines, FairingOutOfRangeIsRefused) {
  std::mt19937 random(random_seed());
  const Scene scene = scene_of(torus_mesh(8, 0.0, random));
  const Camera camera = camera_from({0.5, 0.8, 0.4}, bounds(scene), true);
  for (const double edges : {-1.0, 1001.0, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THROW(solve_lines(scene, camera, {.smooth_meshes = true, .fairing_edges = edges}, {}), InputError) << edges;
  // Contours of facets are as they are.
  EXPECT_THROW(solve_lines(scene, camera, {.fairing_edges = 6.0}, {}), InputError);
  EXPECT_NO_THROW(solve_lines(scene, camera, {.classes = {LineClass::valley}, .fairing_edges = 6.0}, {}));
  EXPECT_NO_THROW(solve_lines(scene, camera, {.smooth_meshes = true, .fairing_edges = 6.0}, {}));
}

}  // namespace
}  // namespace limn
