// Pictures of meshes: triangles listed by tile show what rays find one at a time, leave no gaps, and do so on every SIMD target.

#include <fmt/core.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cstring>

#include "raymarch/mesh/mesh_view.h"
#include "tests/raymarch/border_distance.h"
#include "tests/raymarch/scenes.h"
#include "tests/simd_targets.h"

namespace limn::test {
namespace {

double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * (static_cast<double>(random() >> 11) * 0x1p-53);
}
glm::dvec3 point(std::mt19937_64& random) { return {uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)}; }

/// Triangles of all sizes, through each other: from slivers far below a pixel to some as large as the picture.
Mesh soup(std::mt19937_64& random, int count) {
  Mesh mesh;
  for (int k = 0; k < count; ++k) {
    const double size = std::pow(10.0, uniform(random, -3.0, 0.0));
    const glm::dvec3 middle = point(random);
    for (int corner = 0; corner < 3; ++corner) {
      mesh.corner_vertices.push_back(static_cast<std::int32_t>(mesh.positions.size()));
      mesh.positions.push_back(middle + size * point(random));
    }
    mesh.face_sizes.push_back(3);
  }
  return mesh;
}

/// How far the image of the closest edge is from an image point, in pixels.
double nearest_edge_px(const Mesh& mesh, const Camera& camera, const glm::dvec2& at) {
  double nearest = std::numeric_limits<double>::infinity();
  for (size_t first = 0; first < mesh.corner_vertices.size(); first += 3) {
    for (size_t k = 0; k < 3; ++k) {
      const auto image = [&](size_t corner) {
        return glm::dvec2(project(camera, mesh.positions[static_cast<size_t>(mesh.corner_vertices[first + corner % 3])]));
      };
      nearest = std::min(nearest, test::segment_distance(at, image(k), image(k + 1)));
    }
  }
  return nearest;
}

/// How far a point is from the plane of a triangle.
double from_plane(const Mesh& mesh, std::int32_t face, const glm::dvec3& at) {
  const auto corner = [&](size_t k) {
    return mesh.positions[static_cast<size_t>(mesh.corner_vertices[3 * static_cast<size_t>(face) + k])];
  };
  const glm::dvec3 normal = glm::cross(corner(1) - corner(0), corner(2) - corner(0));
  return std::abs(glm::dot(glm::normalize(normal), at - corner(0)));
}

struct Random {
  std::uint64_t seed;
  std::mt19937_64 generator;
};
Random seeded() {
  const std::uint64_t seed = *rc::gen::arbitrary<std::uint64_t>();
  return {seed, std::mt19937_64(seed)};
}

RC_GTEST_PROP(MeshPictures, ShowWhatSingleRaysFind, ()) {
  auto [seed, random] = seeded();
  const Mesh mesh = soup(random, 300);
  const Scene scene = scene_of({object_of(mesh)});
  const SceneModel model = build_model(scene, surface_kind("mesh"));
  CameraSettings settings = view(67, 45, random() % 2 ? Projection::perspective : Projection::orthographic);
  settings.direction = point(random);
  const Camera camera = framing(scene, settings);
  const glm::dvec2 sample(uniform(random, 0.05, 0.95), uniform(random, 0.05, 0.95));
  ExecutionSettings how;
  how.tile_px = 1 + static_cast<int>(random() % 16);
  const GBuffer seen = render_gbuffer(model, camera, how, sample);
  std::vector<glm::dvec2> points;
  for (int y = 0; y < seen.height; ++y)
    for (int x = 0; x < seen.width; ++x) points.emplace_back(x + sample.x, y + sample.y);
  std::vector<PointSample> single(points.size());
  sample_points(model, camera, points, single);
  int hits = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    const bool hit = seen.id.pixels[i] != 0, expected = single[i].status == HitStatus::hit;
    const bool same = hit == expected && (!hit || seen.face.pixels[i] == single[i].face);
    if (!same) {
      // Rays of float directions, one at a time, pass edges on the other side now and then.
      const bool as_near = hit && expected && glm::length(glm::dvec3(seen.position.pixels[i]) - single[i].position) < 1e-5;
      RC_ASSERT(as_near || nearest_edge_px(mesh, camera, points[i]) < 1e-3);
      continue;
    }
    if (!hit) continue;
    ++hits;
    // Where ray and plane are nearly parallel the least rounding moves the hit along the ray: what both keep to is the plane and the ray.
    const glm::dvec3 drawn(seen.position.pixels[i]);
    RC_ASSERT(from_plane(mesh, seen.face.pixels[i], drawn) < 3e-6);
    RC_ASSERT(from_plane(mesh, seen.face.pixels[i], single[i].position) < 3e-6);
    RC_ASSERT(glm::length(glm::dvec2(project(camera, drawn)) - points[i]) < 3e-5);
    RC_ASSERT(glm::length(glm::dvec2(project(camera, single[i].position)) - points[i]) < 1e-9);
    RC_ASSERT(glm::length(seen.normal.pixels[i] - single[i].normal) < 1e-5f);
  }
  RC_ASSERT(hits > 100);
}

/// In parallel projection, corners at pixel centres: a sheet of n x n squares, bumpy in depth.
Mesh sheet(std::mt19937_64& random, int squares) {
  Mesh mesh;
  for (int y = 0; y <= squares; ++y)
    for (int x = 0; x <= squares; ++x) mesh.positions.emplace_back(x, y, uniform(random, -1, 1));
  for (int y = 0; y < squares; ++y) {
    for (int x = 0; x < squares; ++x) {
      const int a = y * (squares + 1) + x, b = a + 1, c = a + squares + 1, d = c + 1;
      const bool rising = random() % 2;
      for (const int corner : rising ? std::array{a, b, d, a, d, c} : std::array{a, b, c, b, d, c}) mesh.corner_vertices.push_back(corner);
      mesh.face_sizes.insert(mesh.face_sizes.end(), 2, 3);
    }
  }
  return mesh;
}

RC_GTEST_PROP(MeshPictures, LeaveNoGapWherePixelsLieOnCornersAndEdges, ()) {
  auto [seed, random] = seeded();
  constexpr int kSquares = 40;
  const Mesh mesh = sheet(random, kSquares);
  CameraSettings settings = view(64, 64, Projection::orthographic);
  settings.eye = glm::dvec3(20.0, 20.0, 50.0);
  settings.target = glm::dvec3(20.0, 20.0, 0.0);
  settings.ortho_height = 64.0;  // a pixel a square
  const Scene scene = scene_of({object_of(mesh)});
  const SceneModel model = build_model(scene, surface_kind("mesh"));
  const Camera camera = framing(scene, settings);
  // Pixel (i + 12, 51 - j) of sample (0, 1) sees corner (i, j); half a pixel on, the middle of an edge or of a square.
  for (const glm::dvec2 sample : {glm::dvec2(0.0, 0.0), glm::dvec2(0.5, 0.0), glm::dvec2(0.0, 0.5), glm::dvec2(0.5, 0.5)}) {
    const GBuffer seen = render_gbuffer(model, camera, {}, sample);
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 64; ++x) {
        const glm::dvec2 at(x + sample.x - 12.0, 52.0 - (y + sample.y));
        const bool inside = at.x >= 0.0 && at.x <= kSquares && at.y >= 0.0 && at.y <= kSquares;
        RC_ASSERT((seen.id.at(x, y) != 0) == inside);
        if (!inside || sample != glm::dvec2(0.0)) continue;
        const size_t corner = static_cast<size_t>(at.y) * (kSquares + 1) + static_cast<size_t>(at.x);
        RC_ASSERT(std::abs(seen.depth.at(x, y) - (50.0 - mesh.positions[corner].z)) < 1e-4);
      }
    }
  }
}

template <class T>
bool same_bytes(const Image<T>& a, const Image<T>& b) {
  return a.pixels.size() == b.pixels.size() && std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(T)) == 0;
}

bool same_bytes(const GBuffer& a, const GBuffer& b) {
  return same_bytes(a.depth, b.depth) && same_bytes(a.normal, b.normal) && same_bytes(a.position, b.position) &&
         same_bytes(a.face, b.face) && same_bytes(a.material, b.material) && same_bytes(a.status, b.status);
}

TEST(MeshPictures, AreTheSameBytesOnEveryTargetAndInAnyTiles) {
  std::mt19937_64 random(5);
  const Scene scene = scene_of({object_of(soup(random, 2000))});
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    for (const NormalKind normals : {NormalKind::flat, NormalKind::vertex}) {
      SurfaceSettings settings = surface_kind("mesh");
      settings.normals = normals;
      const SceneModel model = build_model(scene, settings);
      const Camera camera = framing(scene, view(213, 131, projection));
      const GBuffer widest = render_gbuffer(model, camera, {});
      EXPECT_GT(count_hits(widest).hits, 3000);
      for (const int tile_px : {1, 7, 13})
        EXPECT_TRUE(same_bytes(render_gbuffer(model, camera, {.threads = 3, .tile_px = tile_px}), widest));
      for_each_simd_target([&](const char* target) { EXPECT_TRUE(same_bytes(render_gbuffer(model, camera, {}), widest)) << target; });
    }
  }
}

TEST(MeshPictures, ComeFromSingleRaysWhereTheEyeIsAmongTheTrianglesOrThesePixelsAreFew) {
  std::mt19937_64 random(6);
  const Scene scene = scene_of({object_of(soup(random, 20'000))});
  const SceneModel model = build_model(scene, surface_kind("mesh"));
  const Surface& surface = model.surfaces[0];
  const auto is_listed = [&](const Camera& camera) {
    return surface.view(surface.state, {moved(camera, model.render_origin), {0.5, 0.5}}).state != nullptr;
  };
  CameraSettings inside = view(200, 200);
  inside.eye = glm::dvec3(0.1);
  inside.target = glm::dvec3(1.0);
  EXPECT_TRUE(is_listed(framing(scene, view(200, 200))));
  EXPECT_FALSE(is_listed(framing(scene, inside)));
  EXPECT_FALSE(is_listed(framing(scene, view(20, 20))));
  EXPECT_GT(count_hits(render_gbuffer(model, framing(scene, inside), {})).hits, 30'000);
}

TEST(MeshPictures, OfOneModelAtTheSameTimeDoNotMeetInItsMemory) {
  std::mt19937_64 random(7);
  const Scene scene = scene_of({object_of(soup(random, 3000))});
  const SceneModel model = build_model(scene, surface_kind("mesh"));
  const Surface& surface = model.surfaces[0];
  CameraSettings aside = view(150, 150);
  aside.direction = glm::dvec3(1, 0, 0);
  const Camera front = framing(scene, view(150, 150)), side = framing(scene, aside);
  const GBuffer expected = render_gbuffer(model, front, {});
  // A view held while others are made, used and given back.
  const SurfaceView held = surface.view(surface.state, {moved(front, model.render_origin), {0.5, 0.5}});
  const GBuffer other = render_gbuffer(model, side, {});
  const GBuffer again = render_gbuffer(model, front, {});
  EXPECT_TRUE(same_bytes(again, expected));
  EXPECT_FALSE(same_bytes(other, expected));
  EXPECT_TRUE(held.touches(held.state.get(), {64, 64, 16, 16}));
}

}  // namespace
}  // namespace limn::test
