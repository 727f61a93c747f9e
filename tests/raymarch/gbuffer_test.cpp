// The G-buffer: the same bytes however it is made, and the same picture wherever and however large the scene is.

#include <fmt/core.h>

#include <cstring>

#include "tests/raymarch/scenes.h"

namespace limn::test {
namespace {

Field part() {
  const Field box = make_shape("rounded_box", {{"half", {0.8, 0.6, 0.5}}, {"rounding", {0.1}}});
  const Field bore = make_shape("cylinder", {{"radius", {0.35}}, {"half_height", {2.0}}});
  return combine(Csg::union_, combine(Csg::difference, box, bore), translate(make_shape("torus"), {0.5, 0.4, 0.0}), 0.15);
}

/// At a sharp seam rounding alone decides which side a voxel's node belongs to, so that equal pictures want a part without one.
Field smooth_part() {
  const Field box = make_shape("rounded_box", {{"half", {0.8, 0.6, 0.5}}, {"rounding", {0.2}}});
  return combine(Csg::union_, translate(make_shape("torus"), {0.5, 0.4, 0.0}),
                 combine(Csg::difference, box, make_shape("sphere", {{"radius", {0.62}}}), 0.1), 0.15);
}

Field part_for(const std::string& kind) { return kind.ends_with("level_set") ? smooth_part() : part(); }

template <class T>
bool same_bytes(const Image<T>& a, const Image<T>& b) {
  return a.pixels.size() == b.pixels.size() && std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(T)) == 0;
}

bool same_bytes(const GBuffer& a, const GBuffer& b) {
  return same_bytes(a.depth, b.depth) && same_bytes(a.position, b.position) && same_bytes(a.normal, b.normal) &&
         same_bytes(a.n_dot_v, b.n_dot_v) && same_bytes(a.id, b.id) && same_bytes(a.material, b.material) && same_bytes(a.face, b.face) &&
         same_bytes(a.status, b.status);
}

TEST(GBuffer, TheSameBytesForAnyThreadsAndTiles) {
  const Scene scene = scene_of({object_of(part()), object_of(translate(make_shape("superellipsoid"), {2.0, 0.0, 0.0}))});
  for (const std::string kind : {"analytic", "level_set", "mesh", "mesh_level_set"}) {
    SurfaceSettings settings = surface_kind(kind);
    settings.voxels = 48;
    settings.level = 1;
    const SceneModel model = build_model(scene, settings);
    const Camera camera = framing(scene, view(97, 61));
    const GBuffer reference = render_gbuffer(model, camera, {1, 16, {}, {}});
    EXPECT_GT(count_hits(reference).hits, 500) << kind;
    for (const int threads : {1, 2, 5, 0}) {
      for (const int tile : {1, 3, 16}) {
        EXPECT_TRUE(same_bytes(reference, render_gbuffer(model, camera, {threads, tile, {}, {}}))) << kind << " " << threads << " " << tile;
      }
    }
    EXPECT_TRUE(same_bytes(reference, render_gbuffer(build_model(scene, settings), camera, {}))) << kind << " modelled again";
  }
}

TEST(GBuffer, AMillionUnitsAwayThePictureIsTheSame) {
  const glm::dvec3 far(1e6, -2e6, 5e5);
  for (const std::string kind : {"analytic", "level_set", "mesh", "mesh_level_set"}) {
    SurfaceSettings settings = surface_kind(kind);
    settings.voxels = 64;
    settings.level = 2;
    settings.normals = NormalKind::limit;
    const Scene here = scene_of({object_of(part_for(kind))}), there = scene_of({object_of(translate(part_for(kind), far))});
    const Camera camera = framing(here, view(80, 60));
    Camera far_camera = camera;
    far_camera.eye += far;
    const GBuffer a = render_gbuffer(build_model(here, settings), camera, {});
    const GBuffer b = render_gbuffer(build_model(there, settings), far_camera, {});
    Errors normal, depth, n_dot_v;
    int status = 0;
    for (size_t i = 0; i < a.id.size(); ++i) {
      status += a.status.pixels[i] != b.status.pixels[i];
      if (a.id.pixels[i] == 0 || b.id.pixels[i] == 0) continue;
      normal.add(angle_between(glm::dvec3(a.normal.pixels[i]), glm::dvec3(b.normal.pixels[i])));
      depth.add(std::abs(double{a.depth.pixels[i]} - double{b.depth.pixels[i]}));
      n_dot_v.add(std::abs(double{a.n_dot_v.pixels[i]} - double{b.n_dot_v.pixels[i]}));
    }
    fmt::print("{}: at 1e6 against at 0: normal {:.1e} rad, depth {:.1e}, N.V {:.1e} (worst of {})\n", kind, normal.largest, depth.largest,
               n_dot_v.largest, normal.count);
    EXPECT_EQ(status, 0) << kind;
    EXPECT_GT(normal.count, 500);
    EXPECT_LT(normal.largest, 1e-4) << kind;
    EXPECT_LT(depth.largest, 1e-5) << kind;
    EXPECT_LT(n_dot_v.largest, 1e-4) << kind;
  }
}

TEST(GBuffer, ScaledByAThousandBothWaysThePictureIsTheSame) {
  for (const std::string kind : {"analytic", "level_set", "mesh", "mesh_level_set"}) {
    SurfaceSettings settings = surface_kind(kind);
    settings.voxels = 64;
    settings.level = 2;
    settings.normals = NormalKind::limit;
    const Scene unit = scene_of({object_of(part_for(kind))});
    const Camera camera = framing(unit, view(80, 60));
    const GBuffer a = render_gbuffer(build_model(unit, settings), camera, {});
    for (const double factor : {1e-3, 1e3}) {
      const Scene scene = scene_of({object_of(scale(part_for(kind), factor))});
      Camera scaled = camera;
      scaled.eye *= factor;
      const GBuffer b = render_gbuffer(build_model(scene, settings), scaled, {});
      Errors normal, depth;
      int status = 0;
      for (size_t i = 0; i < a.id.size(); ++i) {
        status += a.status.pixels[i] != b.status.pixels[i];
        if (a.id.pixels[i] == 0 || b.id.pixels[i] == 0) continue;
        normal.add(angle_between(glm::dvec3(a.normal.pixels[i]), glm::dvec3(b.normal.pixels[i])));
        depth.add(std::abs(double{a.depth.pixels[i]} - double{b.depth.pixels[i]} / factor));
      }
      fmt::print("{} x {}: normal {:.1e} rad, depth {:.1e} (worst of {})\n", kind, factor, normal.largest, depth.largest, normal.count);
      EXPECT_EQ(status, 0) << kind << " " << factor;
      EXPECT_LT(normal.largest, 1e-4) << kind << " " << factor;
      EXPECT_LT(depth.largest, 1e-5) << kind << " " << factor;
    }
  }
}

TEST(GBuffer, BehindThePinholeNothingIsSeenAndInsideEverything) {
  const Scene scene = scene_of({object_of(make_shape("sphere", {{"radius", {1.0}}}))});
  const SceneModel model = model_of(scene);
  CameraSettings settings = view(20, 20);
  settings.eye = glm::dvec3(0, 0, 5);
  settings.target = glm::dvec3(0, 0, 10);
  EXPECT_EQ(count_hits(render_gbuffer(model, framing(scene, settings), {})).misses, 400);
  settings.eye = glm::dvec3(0.2, 0.1, 0.0);
  const GBuffer inside = render_gbuffer(model, framing(scene, settings), {});
  EXPECT_EQ(count_hits(inside).hits, 400);
  for (const float n_dot_v : inside.n_dot_v.pixels) EXPECT_EQ(n_dot_v, 0.0f);
}

TEST(GBuffer, WhereNothingIsHitTheBuffersSayNothing) {
  const Scene empty = scene_of({});
  const GBuffer seen = render_gbuffer(model_of(empty), framing(empty, view(1, 1)), {});
  EXPECT_EQ(seen.depth.at(0, 0), std::numeric_limits<float>::infinity());
  EXPECT_EQ(seen.position.at(0, 0), glm::vec3(std::numeric_limits<float>::infinity()));
  EXPECT_EQ(seen.normal.at(0, 0), glm::vec3(0.0f));
  EXPECT_EQ(seen.id.at(0, 0), 0);
  EXPECT_EQ(seen.face.at(0, 0), -1);
  EXPECT_EQ(count_hits(seen).misses, 1);
}

TEST(GBuffer, OnePixelSeesTheMiddle) {
  const Scene scene = scene_of({object_of(make_shape("sphere", {{"radius", {1.0}}}))});
  CameraSettings settings = view(1, 1);
  settings.target = glm::dvec3(0.0);
  const GBuffer seen = render_gbuffer(model_of(scene), framing(scene, settings), {});
  EXPECT_EQ(count_hits(seen).hits, 1);
  EXPECT_NEAR(seen.n_dot_v.at(0, 0), 1.0f, 1e-6f);
}

TEST(GBuffer, TheNearestObjectIsSeenWithItsIdAndMaterial) {
  SceneObject front = object_of(translate(make_shape("sphere", {{"radius", {0.5}}}), {0, 0, 2}));
  SceneObject back = object_of(make_shape("sphere", {{"radius", {1.0}}}));
  front.material = 7;
  back.material = 3;
  CameraSettings settings = view(41, 41);
  settings.eye = glm::dvec3(0, 0, 8);
  settings.target = glm::dvec3(0, 0, 0);
  for (const bool swapped : {false, true}) {
    const Scene scene = swapped ? scene_of({back, front}) : scene_of({front, back});
    const GBuffer seen = render_gbuffer(model_of(scene), framing(scene, settings), {});
    EXPECT_EQ(seen.id.at(20, 20), swapped ? 2 : 1);
    EXPECT_EQ(seen.material.at(20, 20), 7);
    EXPECT_NEAR(seen.depth.at(20, 20), 5.5f, 1e-5f);
  }
}

TEST(GBuffer, PositionNormalAndDepthBelongTogether) {
  const Scene scene = scene_of({object_of(part())});
  const Camera camera = framing(scene, view(64, 48));
  const GBuffer seen = render_gbuffer(model_of(scene), camera, {});
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) {
      if (seen.id.at(x, y) == 0) continue;
      const glm::dvec3 position(seen.position.at(x, y)), image = project(camera, position);
      EXPECT_NEAR(image.x, x + 0.5, 1e-3);
      EXPECT_NEAR(image.y, y + 0.5, 1e-3);
      EXPECT_NEAR(image.z, seen.depth.at(x, y), 1e-5);
      const double n_dot_v = glm::dot(glm::dvec3(seen.normal.at(x, y)), view_vector(camera, position));
      EXPECT_NEAR(seen.n_dot_v.at(x, y), std::clamp(n_dot_v, 0.0, 1.0), 1e-6);
    }
  }
}

TEST(GBuffer, CancellingThrowsAndProgressEndsAtOne) {
  const Scene scene = scene_of({object_of(make_shape("sphere"))});
  const SceneModel model = model_of(scene);
  const Camera camera = framing(scene, view(64, 64));
  double last = 0.0;
  render_gbuffer(model, camera, {2, 8, [&](double done) { last = std::max(last, done); }, {}});
  EXPECT_EQ(last, 1.0);
  EXPECT_THROW(render_gbuffer(model, camera, {2, 8, {}, [] { return true; }}), Cancelled);
}

}  // namespace
}  // namespace limn::test
