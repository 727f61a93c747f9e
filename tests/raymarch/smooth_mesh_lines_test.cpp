// Contours of the smooth surface through a mesh's vertices, against the closed forms of what was tessellated.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "raymarch/lines.h"
#include "sdf/error.h"
#include "sdf/segment.h"
#include "tests/random_seed.h"

namespace limn {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kMost_px = 0.01;  // contours are drawn to 0.005

/// A grid of u by v vertices on a surface that closes both ways, as quads.
template <class Position>
Mesh closed_grid(int u, int v, const Position& position) {
  Mesh mesh;
  for (int i = 0; i < u; ++i) {
    for (int k = 0; k < v; ++k) mesh.positions.push_back(position(2.0 * kPi * i / u, 2.0 * kPi * k / v));
  }
  const auto at = [&](int i, int k) { return (i % u) * v + k % v; };
  for (int i = 0; i < u; ++i) {
    for (int k = 0; k < v; ++k) {
      mesh.face_sizes.push_back(4);
      for (const int corner : {at(i, k), at(i, k + 1), at(i + 1, k + 1), at(i + 1, k)}) mesh.corner_vertices.push_back(corner);
    }
  }
  return mesh;
}

Mesh torus(int n, double major, double minor) {
  return closed_grid(2 * n, n, [&](double u, double v) {
    const double r = major + minor * std::cos(v);
    return glm::dvec3(r * std::cos(u), minor * std::sin(v), r * std::sin(u));
  });
}

/// Rings of vertices and a pole at either end.
Mesh turned(const std::vector<glm::dvec2>& rings, int around, double south, double north) {
  Mesh mesh;
  mesh.positions.emplace_back(0.0, south, 0.0);
  for (const glm::dvec2& ring : rings) {
    for (int k = 0; k < around; ++k) {
      const double angle = 2.0 * kPi * k / around;
      mesh.positions.emplace_back(ring.x * std::cos(angle), ring.y, ring.x * std::sin(angle));
    }
  }
  mesh.positions.emplace_back(0.0, north, 0.0);
  const int last = static_cast<int>(mesh.positions.size()) - 1;
  const auto at = [&](int ring, int k) { return 1 + ring * around + k % around; };
  const auto add = [&](const std::vector<int>& corners) {
    mesh.face_sizes.push_back(static_cast<std::int32_t>(corners.size()));
    for (const int corner : corners) mesh.corner_vertices.push_back(corner);
  };
  const int count = static_cast<int>(rings.size());
  for (int k = 0; k < around; ++k) {
    add({0, at(0, k), at(0, k + 1)});
    for (int ring = 0; ring + 1 < count; ++ring) add({at(ring, k), at(ring + 1, k), at(ring + 1, k + 1), at(ring, k + 1)});
    add({at(count - 1, k + 1), at(count - 1, k), last});
  }
  return mesh;
}

Mesh ball(int n) {
  std::vector<glm::dvec2> rings;
  for (int i = 1; i < n; ++i) rings.emplace_back(std::sin(kPi * i / n), -std::cos(kPi * i / n));
  return turned(rings, 2 * n, -1.0, 1.0);
}

Camera camera_at(const glm::dvec3& eye, bool perspective) {
  CameraSettings settings;
  settings.eye = eye;
  settings.target = glm::dvec3(0.0);
  settings.projection = perspective ? Projection::perspective : Projection::orthographic;
  settings.ortho_height = 3.6;
  settings.width_px = settings.height_px = 480;
  return resolve_camera(settings, {glm::dvec3(-1.5), glm::dvec3(1.5)});
}

ViewGraph lines_of(const Mesh& mesh, const Camera& camera) {
  Scene scene;
  scene.objects.push_back({.name = "mesh", .source = MeshSource{mesh}});
  LineSettings settings;
  settings.smooth_meshes = true;
  return solve_lines(scene, camera, settings, {});
}

/// How far the contours' points lie from the exact lines, and these from the contours, px: the worst.
double worst_px(const ViewGraph& graph, const std::vector<std::vector<glm::dvec2>>& exact) {
  std::vector<std::vector<glm::dvec2>> found;
  for (const LineChain& chain : graph.chains) {
    found.emplace_back();
    for (const LinePoint& point : points_of(graph, chain)) found.back().push_back(point.px);
    if (chain.closed) found.back().push_back(found.back().front());
  }
  const auto farthest = [](const auto& lines, const auto& others) {
    double most = 0.0;
    for (const auto& line : lines) {
      for (const glm::dvec2& p : line) {
        double least = 1e9;
        for (const auto& other : others) {
          for (size_t i = 0; i + 1 < other.size(); ++i) least = std::min(least, distance_to_segment(p, other[i], other[i + 1]));
        }
        most = std::max(most, least);
      }
    }
    return most;
  };
  return std::max(farthest(found, exact), farthest(exact, found));
}

TEST(SmoothMeshLines, ContoursOfTessellatedBallsNearTheBalls) {
  for (const bool perspective : {true, false}) {
    const Camera camera = camera_at({1.7, 2.3, 3.1}, perspective);
    // The tangent cone touches the unit ball in a circle across the view.
    const double distance = glm::length(camera.eye), height = perspective ? 1.0 / distance : 0.0, radius = std::sqrt(1.0 - height * height);
    const glm::dvec3 axis = glm::normalize(camera.eye), x = camera.world_from_camera[0], y = glm::cross(axis, x);
    std::vector<glm::dvec2> circle;
    for (int i = 0; i <= 2000; ++i) {
      const double t = 2.0 * kPi * i / 2000.0;
      circle.emplace_back(project(camera, height * axis + radius * (std::cos(t) * x + std::sin(t) * y)));
    }
    std::vector<double> errors;
    for (const int n : {16, 32, 64}) {
      const ViewGraph graph = lines_of(ball(n), camera);
      EXPECT_EQ(graph.chains.size(), 1u) << n;
      EXPECT_TRUE(graph.chains[0].closed) << n;
      EXPECT_EQ(graph.chains[0].invisibility, 0) << n;
      EXPECT_TRUE(graph.conflicts.empty()) << n;
      errors.push_back(worst_px(graph, {circle}));
    }
    EXPECT_LT(errors[0], 0.2);
    for (size_t k = 1; k < errors.size(); ++k)
      EXPECT_LT(errors[k], std::max(kMost_px, errors[k - 1] / 4.0)) << fmt::format("{} px, {} px", errors[k - 1], errors[k]);
  }
}

/// The curve at the tube's radius from the ellipse that the torus' circle is seen as, on its outer side and on its inner one.
std::vector<std::vector<glm::dvec2>> torus_outlines(const Camera& camera, double major, double minor) {
  std::vector<std::vector<glm::dvec2>> lines;
  for (const double side : {1.0, -1.0}) {
    lines.emplace_back();
    for (int i = 0; i <= 4000; ++i) {
      const double t = 2.0 * kPi * i / 4000.0;
      const auto at = [&](double u) { return glm::dvec2(project(camera, {major * std::cos(u), 0.0, major * std::sin(u)})); };
      const glm::dvec2 along = at(t + 1e-5) - at(t - 1e-5);
      const glm::dvec2 out = glm::normalize(glm::dvec2(along.y, -along.x)), middle = at(0.5 * kPi) + 0.5 * (at(1.5 * kPi) - at(0.5 * kPi));
      const double sign = glm::dot(out, at(t) - middle) > 0.0 ? side : -side;
      lines.back().push_back(at(t) + sign * minor * camera.pixels_per_unit * out);
    }
  }
  return lines;
}

TEST(SmoothMeshLines, ContoursOfTessellatedToriNearTheirs) {
  constexpr double kMajor = 1.0, kMinor = 0.4;
  for (const double tilt_deg : {30.0, 60.0}) {
    const double tilt = tilt_deg * kPi / 180.0;
    const Camera camera = camera_at(4.0 * glm::dvec3(0.0, std::cos(tilt), std::sin(tilt)), false);
    std::vector<double> errors;
    for (const int n : {24, 48, 96}) {
      const ViewGraph graph = lines_of(torus(n, kMajor, kMinor), camera);
      errors.push_back(worst_px(graph, torus_outlines(camera, kMajor, kMinor)));
      const auto cusps =
          std::count_if(graph.vertices.begin(), graph.vertices.end(), [](const LineVertex& v) { return v.kind == VertexKind::cusp; });
      // Cusps where the ellipse bends more than the tube: the square of the cosine is below minor / major.
      EXPECT_EQ(cusps, tilt_deg == 30.0 ? 0 : 4) << n;
      if (n == 96) {
        EXPECT_TRUE(graph.conflicts.empty()) << graph.conflicts.front().what;
      }
    }
    EXPECT_LT(*std::max_element(errors.begin(), errors.end()), kMost_px) << fmt::format("{} {} {} px", errors[0], errors[1], errors[2]);
  }
}

TEST(SmoothMeshLines, AContourEndsOnTheCreasesOfACan) {
  // A capped cylinder: its sides are smooth, its rims sharp.
  constexpr int kAround = 64;
  const Mesh can = turned({{0.7, -1.0}, {0.7, -0.3}, {0.7, 0.4}, {0.7, 1.0}}, kAround, -1.0, 1.0);
  const Camera camera = camera_at({0.0, 1.5, 4.0}, false);
  const ViewGraph graph = lines_of(can, camera);
  EXPECT_TRUE(graph.conflicts.empty()) << graph.conflicts.front().what;
  size_t contours = 0, creases = 0;
  double length = 0.0;
  for (const LineChain& chain : graph.chains) {
    if (chain.invisibility > 0) continue;
    contours += chain.line_class == LineClass::contour;
    creases += chain.line_class == LineClass::crease;
    EXPECT_TRUE(chain.line_class != LineClass::contour || chain.closed);
    const std::vector<LinePoint> points = points_of(graph, chain);
    if (chain.line_class != LineClass::contour) continue;
    for (size_t i = 0; i + 1 < points.size(); ++i) length += glm::distance(points[i].px, points[i + 1].px);
    length += glm::distance(points.back().px, points.front().px);
  }
  // The outline goes down both sides and round the far half of the upper rim and the near half of the lower one; the near half of the upper
  // rim is a crease inside it.
  EXPECT_EQ(contours, 1u);
  EXPECT_EQ(creases, 1u);
  const double scale = camera.pixels_per_unit, sine = 1.5 / std::hypot(1.5, 4.0), cosine = 4.0 / std::hypot(1.5, 4.0);
  double ellipse = 0.0;
  for (int i = 0; i < 1000; ++i) {
    const double t = 2.0 * kPi * (i + 0.5) / 1000.0;
    ellipse += 2.0 * kPi / 1000.0 * 0.7 * std::hypot(std::sin(t), sine * std::cos(t));
  }
  EXPECT_NEAR(length, scale * (ellipse + 2.0 * 2.0 * cosine), 0.005 * length);
}

TEST(SmoothMeshLines, AMeshThatTakesMoreMemoryThanAllowedIsRefused) {
  Scene scene;
  scene.objects.push_back({.name = "mesh", .source = MeshSource{ball(16)}});
  const auto triangles = std::int64_t{2} * 32 * 15;
  LineSettings settings;
  settings.smooth_meshes = true;
  settings.max_bytes = triangles * kSmoothBytes - 1;
  EXPECT_THROW(solve_lines(scene, camera_at({1.7, 2.3, 3.1}, true), settings, {}), InputError);
  settings.smooth_meshes = false;
  EXPECT_NO_THROW(solve_lines(scene, camera_at({1.7, 2.3, 3.1}, true), settings, {}));
}

/// Many of their lines run beside nearer ones, where no ray starts clear of these.
TEST(SmoothMeshLines, RoughMeshesAreDrawnFromAllSides) {
  std::mt19937 random(random_seed());
  std::uniform_real_distribution<double> real(-1.0, 1.0);
  std::int64_t hidden = 0, visible = 0;
  for (int k = 0; k < 16; ++k) {
    Mesh rough = ball(8);
    for (glm::dvec3& p : rough.positions) p *= 1.0 + 0.35 * real(random);
    const ViewGraph graph =
        lines_of(rough, camera_at(4.0 * glm::normalize(glm::dvec3(real(random), real(random), real(random))), k % 2 == 0));
    for (const LineEdge& edge : graph.edges) {
      ASSERT_GE(edge.invisibility, 0);
      ASSERT_LT(edge.invisibility, 40);
      ++(edge.invisibility > 0 ? hidden : visible);
    }
  }
  EXPECT_GT(visible, 400);
  EXPECT_GT(hidden, 400);
}

}  // namespace
}  // namespace limn
