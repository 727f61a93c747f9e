// Where a trembling camera stands, which pixel showed the same before, and that a sequence has the same bytes however it is made.

#include "tests/raymarch/film.h"

#include <fmt/core.h>
#include <rapidcheck/gtest.h>

namespace limn::test {
namespace {

RC_GTEST_PROP(FramePathOffsets, AreOneStepApartWithinReachAndTheSameForTheSameSeed, ()) {
  const FramePath path{
      .frames = *rc::gen::inRange(1, 200), .step_px = *rc::gen::inRange(1, 1001) / 1000.0, .seed = *rc::gen::arbitrary<std::uint64_t>()};
  const std::vector<glm::dvec2> offsets = path_offsets(path);
  RC_ASSERT(static_cast<int>(offsets.size()) == path.frames);
  RC_ASSERT(offsets.front() == glm::dvec2(0.0));
  for (size_t k = 1; k < offsets.size(); ++k) {
    RC_ASSERT(std::abs(glm::length(offsets[k] - offsets[k - 1]) - path.step_px) < 1e-12);
    RC_ASSERT(glm::length(offsets[k]) <= path.reach_px() + 1e-12);
  }
  RC_ASSERT(path_offsets(path) == offsets);
}

TEST(FramePathOffsets, DifferForDifferentSeeds) {
  EXPECT_NE(path_offsets({.frames = 5, .step_px = 0.1, .seed = 1}), path_offsets({.frames = 5, .step_px = 0.1, .seed = 2}));
}

TEST(PathCameras, MoveNothingInTheSceneFartherThanTheStepAndTheNearestCornerByAllOfIt) {
  const std::uint64_t seed = fresh_seed();
  SCOPED_TRACE(fmt::format("seed {}", seed));
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int round = 0; round < 20; ++round) {
    const Projection projection = round % 2 ? Projection::perspective : Projection::orthographic;
    const Shot shot = shot_of(make_shape("box", {{"half", {1.0, 0.4, 2.0}}}), projection, random, 300, 5);
    const Box box = bounds(shot.scene);
    for (size_t k = 1; k < shot.cameras.size(); ++k) {
      double farthest = 0.0;
      for (int point = 0; point < 64; ++point) {
        // The corners first: one of them is nearest.
        const glm::dvec3 share =
            point < 8 ? glm::dvec3(point & 1, (point >> 1) & 1, (point >> 2) & 1) : glm::dvec3(unit(random), unit(random), unit(random));
        const glm::dvec3 world = box.lower + share * box.size();
        const glm::dvec2 a(project(shot.cameras[k - 1], world)), b(project(shot.cameras[k], world));
        farthest = std::max(farthest, glm::length(b - a));
      }
      EXPECT_NEAR(farthest, shot.path.step_px, 1e-9);
    }
  }
}

TEST(PathCameras, StandAsFarAsTheOriginWhereNothingHasBounds) {
  Camera camera = straight_camera(64, 64, Projection::perspective, 100.0);
  camera.eye = {0.0, 0.0, 8.0};
  const std::vector<Camera> cameras = path_cameras(camera, Box{}, {.frames = 2, .step_px = 0.5});
  EXPECT_NEAR(glm::length(glm::dvec2(project(cameras[1], glm::dvec3(0.0))) - glm::dvec2(32.0)), 0.5, 1e-12);
}

TEST(PixelsBefore, AreThePixelsThemselvesWhereTheCameraRests) {
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    const Scene scene = scene_of({object_of(make_shape("torus"))});
    const Camera camera = framing(scene, view(90, 70, projection));
    const GBuffer seen = render_gbuffer(model_of(scene), camera, {});
    const Image<std::int32_t> before = pixels_before(seen, camera, seen, camera);
    for (size_t i = 0; i < before.size(); ++i) EXPECT_EQ(before.pixels[i], static_cast<std::int32_t>(i));
  }
}

TEST(PixelsBefore, FollowASphereThatMovesByManyPixelsInThePicture) {
  const Scene scene = scene_of({object_of(make_shape("sphere", {{"radius", {1.0}}}))});
  const SceneModel model = model_of(scene);
  Camera camera = straight_camera(120, 120, Projection::orthographic, 40.0);
  camera.eye = {0.0, 0.0, 5.0};
  Camera moved = camera;
  // By 7 and -3 whole pixels: every pixel of the disc has its own partner, and no other.
  moved.eye += glm::dvec3(-7.0 / 40.0, -3.0 / 40.0, 0.0);
  const GBuffer a = render_gbuffer(model, camera, {}), b = render_gbuffer(model, moved, {});
  const Image<std::int32_t> before = pixels_before(b, moved, a, camera);
  int followed = 0;
  for (int y = 3; y < 117; ++y) {
    for (int x = 7; x < 113; ++x) {
      if (b.id.at(x, y) == 0) continue;
      EXPECT_EQ(before.at(x, y), static_cast<std::int32_t>(b.id.index(x - 7, y + 3))) << x << " " << y;
      ++followed;
    }
  }
  EXPECT_GT(followed, 4000);
}

TEST(PixelsBefore, AreNoneWhereAnotherSurfaceWasSeen) {
  // Two parallel squares, one behind the other: what the nearer one uncovers was not seen, though its normal and object are the same.
  const Camera camera = straight_camera(40, 20, Projection::orthographic, 10.0);
  const auto scene_at = [&](int edge, int id_behind) {
    GBuffer out = plane_buffer(camera, {0.0, 0.0, 1.0}, 6.0);
    for (int y = 0; y < 20; ++y) {
      for (int x = 0; x < 40; ++x) hit(out, camera, x, y, x < edge ? 4.0 : 6.0, {0.0, 0.0, 1.0}, x < edge ? 1 : id_behind);
    }
    return out;
  };
  for (const int id_behind : {1, 2}) {
    const Image<std::int32_t> before = pixels_before(scene_at(15, id_behind), camera, scene_at(20, id_behind), camera);
    for (int x = 0; x < 40; ++x) EXPECT_EQ(before.at(x, 9) < 0, x >= 15 && x < 20) << x << " id " << id_behind;
  }
  // Turned by half a radian: a crease.
  GBuffer turned = scene_at(20, 1);
  hit(turned, camera, 3, 9, 4.0, {0.0, std::sin(0.5), std::cos(0.5)});
  const Image<std::int32_t> before = pixels_before(turned, camera, scene_at(20, 1), camera);
  EXPECT_LT(before.at(3, 9), 0);
  EXPECT_GE(before.at(4, 9), 0);
}

TEST(FrameHistory, GivesTheSameBytesForAnyThreadsAndTiles) {
  std::mt19937_64 random(11);
  const Shot shot = shot_of(smooth_shapes()[1].field, Projection::perspective, random, 130, 4);
  const SceneModel model = model_of(shot.scene);
  const PictureSettings settings{{rim(0.1), call_of("rim_width", {{"hysteresis", value(0.5)}})}, 3, {}};
  FrameHistory one, three;
  for (const Camera& camera : shot.cameras) {
    const Picture a = draw_picture(shot.scene, model, camera, settings, {.threads = 1, .tile_px = 16}, &one);
    const Picture b = draw_picture(shot.scene, model, camera, settings, {.threads = 3, .tile_px = 7}, &three);
    EXPECT_EQ(a.border.pixels, b.border.pixels);
    EXPECT_EQ(a.composite.pixels, b.composite.pixels);
    EXPECT_EQ(one.pixels_before.pixels, three.pixels_before.pixels);
  }
}

}  // namespace
}  // namespace limn::test
