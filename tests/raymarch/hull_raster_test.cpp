// The rasteriser behind extruded meshes, and the normals along which they grow.

#include "raymarch/border/hull_raster.h"

#include <fmt/core.h>

#include <array>
#include <random>

#include "subdiv/edge_topology.h"
#include "tests/random_seed.h"
#include "tests/raymarch/image_buffers.h"

namespace limn::test {
namespace {

constexpr glm::uvec3 kWhole(0, 1, 2);

TEST(HullRaster, TrianglesThatShareAnEdgeShareNoPixelAndLeaveNone) {
  const std::uint32_t seed = random_seed();
  fmt::print("seed {}\n", seed);
  std::mt19937 random(seed);
  Camera camera = straight_camera(40, 30, Projection::orthographic, 1.0);
  for (int round = 0; round < 300; ++round) {
    // Corners on whole and half pixels meet samples exactly.
    const auto corner = [&] {
      return glm::dvec3(std::round(std::uniform_real_distribution(-50.0, 50.0)(random)) * 0.5,
                        std::round(std::uniform_real_distribution(-50.0, 50.0)(random)) * 0.5, 1.0);
    };
    const glm::dvec3 a = corner(), b = corner();
    glm::dvec3 c = corner();
    // Of corners on one line the middle, rounded to 1/1024 px, is beside the line, and so are the three triangles; of all others it is
    // inside.
    const auto on_one_line = [&] { return (b.x - a.x) * (c.y - a.y) == (b.y - a.y) * (c.x - a.x); };
    if (a == b) continue;
    while (on_one_line()) c = corner();
    const glm::dvec3 inside = (a + b + c) / 3.0;
    const auto covered = [&](const glm::dvec3& p, const glm::dvec3& q, const glm::dvec3& r) {
      const std::array<glm::dvec3, 3> corners{p, q, r};
      return rasterize_hull({corners, {&kWhole, 1}}, HullFaces::all, camera, 0.0, {0.5, 0.5});
    };
    const WindowImage<double> whole = covered(a, b, c), first = covered(a, b, inside), second = covered(b, c, inside),
                              third = covered(c, a, inside);
    const auto is_covered = [](const WindowImage<double>& depth, int x, int y) {
      return depth.inside(x, y) && std::isfinite(depth.at(x, y));
    };
    for (int y = 0; y < camera.height_px; ++y) {
      for (int x = 0; x < camera.width_px; ++x) {
        const int count = is_covered(first, x, y) + is_covered(second, x, y) + is_covered(third, x, y);
        // `inside` is rounded to 1/1024 px, which the whole triangle's edges do not see.
        ASSERT_EQ(count, is_covered(whole, x, y) ? 1 : 0) << "round " << round << ", pixel " << x << ' ' << y;
      }
    }
  }
}

TEST(HullRaster, DepthIsThatOfThePlaneAndTheNearPlaneCuts) {
  const Camera camera = straight_camera(64, 48, Projection::perspective, 60.0);
  // The plane Z = 2 + x / 2, from before the eye to far behind it.
  const std::array<glm::dvec3, 3> corners{{{-8.0, -6.0, -2.0}, {10.0, -6.0, 7.0}, {1.0, 12.0, 2.5}}};
  const WindowImage<double> depth = rasterize_hull({corners, {&kWhole, 1}}, HullFaces::all, camera, 0.5, {0.5, 0.5});
  int filled = 0;
  for (int y = depth.window.y0; y < depth.window.y1; ++y) {
    for (int x = depth.window.x0; x < depth.window.x1; ++x) {
      if (!std::isfinite(depth.at(x, y))) continue;
      ++filled;
      const double slope = (x + 0.5 - 32.0) / 60.0, expected = 2.0 / (1.0 - 0.5 * slope);
      ASSERT_NEAR(depth.at(x, y), expected, 0.02 * expected) << x << ' ' << y;
      ASSERT_GE(depth.at(x, y), 0.49);
    }
  }
  EXPECT_GT(filled, 1000);
}

TEST(SmoothNormals, AreOnePerPositionWhateverTheTriangulationAndDoubledVertices) {
  Mesh box = box_mesh({1.0, 1.0, 1.0});
  Mesh soup;  // every face its own vertices, and each quad as two triangles
  std::int32_t first = 0;
  for (size_t f = 0; f < 6; ++f) {
    for (const int k : {0, 1, 2, 0, 2, 3})
      soup.positions.push_back(box.positions[static_cast<size_t>(box.corner_vertices[4 * f + static_cast<size_t>(k)])]);
    for (int t = 0; t < 2; ++t) soup.face_sizes.push_back(3);
    for (int k = 0; k < 6; ++k) soup.corner_vertices.push_back(first++);
  }
  for (const Mesh* mesh : {&box, &soup}) {
    const std::vector<glm::vec3> normals = bake_smooth_normals(*mesh);
    ASSERT_EQ(normals.size(), mesh->positions.size());
    for (size_t v = 0; v < normals.size(); ++v) EXPECT_LT(angle_between(glm::dvec3(normals[v]), glm::normalize(mesh->positions[v])), 1e-6);
  }
}

}  // namespace
}  // namespace limn::test
