// Where a trembling camera stands, which pixel showed the same before, and that a sequence has the same bytes however it is made.

#include "tests/raymarch/film.h"

#include <fmt/core.h>
#include <rapidcheck/gtest.h>

#include "raymarch/picture/pixel_lanes.h"
#include "tests/random_seed.h"
#include "tests/simd_targets.h"

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

/// One pixel by itself, by the camera's own functions.
std::int32_t pixel_before(const GBuffer& now, const Camera& camera, const GBuffer& before, const Camera& camera_before, size_t i) {
  const auto point_at = [](const GBuffer& seen, const Camera& of, size_t k) {
    const auto width = static_cast<size_t>(seen.width);
    const CameraRay ray = camera_ray(of, static_cast<double>(k % width) + seen.sample.x, static_cast<double>(k / width) + seen.sample.y);
    return ray.origin + ray.direction * (double{seen.depth.pixels[k]} / -glm::dot(ray.direction, of.world_from_camera[2]));
  };
  if (now.id.pixels[i] == 0) return before.id.pixels[i] == 0 ? static_cast<std::int32_t>(i) : -1;
  const glm::dvec3 point = point_at(now, camera, i), image = project(camera_before, point);
  const glm::dvec2 pixel = glm::floor(glm::dvec2(image) - before.sample + 0.5);
  if (!(image.z > 0.0) || !(pixel.x >= 0.0 && pixel.y >= 0.0 && pixel.x < before.width && pixel.y < before.height)) return -1;
  const size_t there = before.id.index(static_cast<int>(pixel.x), static_cast<int>(pixel.y));
  const glm::dvec3 normal(now.normal.pixels[i]), other(before.normal.pixels[there]);
  if (before.id.pixels[there] != now.id.pixels[i] || glm::dot(normal, other) < std::cos(0.25)) return -1;
  const glm::dvec3 way = point_at(before, camera_before, there) - point;
  const double most = std::sin(0.25) * (glm::length(way) + 1.0 / pixels_per_unit_at(camera_before, image.z));
  return std::abs(glm::dot(way, normal)) > most ? -1 : static_cast<std::int32_t>(there);
}

TEST(PixelsBefore, AreThoseOfOnePixelAfterTheOtherOnAnyTarget) {
  std::mt19937 random(random_seed());
  std::uniform_real_distribution<double> near(-1.0, 1.0);
  std::uniform_int_distribution<int> side(1, 40);
  const Scene scene = scene_of({object_of(make_shape("torus")), object_of(translate(make_shape("box"), {0.4, 0.3, 0.2}))});
  const SceneModel model = model_of(scene);
  size_t followed = 0, hits = 0;
  for (int round = 0; round < 400; ++round) {
    const Projection projection = round % 2 ? Projection::perspective : Projection::orthographic;
    const Camera camera = framing(scene, view(side(random), side(random), projection));
    // By a part of a pixel, by many, and so far that the object leaves the picture or comes behind the eye.
    Camera moved = turned_camera(camera, glm::dvec3(0.0), {near(random), near(random), near(random)}, 0.3 * near(random));
    moved.eye += (round % 3 == 0 ? 2.0 : 0.01) * glm::dvec3(near(random), near(random), near(random));
    const auto frame = [&](const Camera& of, int sample) {
      GBuffer out;
      render_gbuffer(model, of, {}, sample_offset(sample, 4), {}, out);
      return out;
    };
    const GBuffer a = frame(camera, round % 4), b = frame(moved, round % 4);
    Image<std::int32_t> expected(a.width, a.height, 0);
    for (size_t i = 0; i < expected.size(); ++i) expected.pixels[i] = pixel_before(b, moved, a, camera, i);
    for_each_simd_target([&](const char* target) {
      EXPECT_EQ(pixels_before(b, moved, a, camera).pixels, expected.pixels)
          << target << ", round " << round << ", " << a.width << "x" << a.height;
    });
    for (size_t i = 0; i < expected.size(); ++i) {
      hits += b.id.pixels[i] != 0;
      followed += b.id.pixels[i] != 0 && expected.pixels[i] >= 0;
    }
  }
  // Both happen often.
  EXPECT_GT(10 * followed, hits);
  EXPECT_LT(10 * followed, 9 * hits);
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

TEST(FrameHistory, FramesOfInkThatHoldsOnToNothingAreThePicturesThatTheyAreAlone) {
  std::mt19937_64 random(random_seed());
  const Shot shot = shot_of(smooth_shapes()[1].field, Projection::perspective, random, 90, 4);
  const SceneModel model = model_of(shot.scene);
  for (const int samples : {1, 3})
    for (const PictureColors colors : {PictureColors::linear, PictureColors::bytes, PictureColors::none})
      for (const bool hands_over : {true, false}) {
        const PictureSettings alone{{rim(0.0), call_of("fresnel")}, samples, glm::vec3(0.2f, 0.5f, 1.0f)};
        PictureSettings settings = alone;
        settings.colors = colors;
        settings.hands_over_gbuffer = hands_over;
        FrameHistory history;
        for (size_t k = 0; k < shot.cameras.size(); ++k) {
          const Picture frame = draw_picture(shot.scene, model, shot.cameras[k], settings, {}, &history);
          Picture expected = draw_picture(shot.scene, model, shot.cameras[k], alone, {});
          if (colors == PictureColors::bytes) expected.bytes = encoded(expected.composite);
          if (colors != PictureColors::linear) expected.composite = {};
          EXPECT_EQ(frame.border.pixels, expected.border.pixels);
          EXPECT_EQ(frame.composite.pixels, expected.composite.pixels);
          EXPECT_EQ(frame.bytes.pixels, expected.bytes.pixels);
          EXPECT_EQ(frame.counts.hits, expected.counts.hits);
          const GBuffer now = render_gbuffer(model, shot.cameras[k], {});
          const GBuffer& there = hands_over ? frame.gbuffer : history.samples.front().gbuffer;
          EXPECT_EQ(there.n_dot_v.pixels, now.n_dot_v.pixels);
          EXPECT_EQ(frame.gbuffer.depth.pixels.empty(), !hands_over);
          if (k == 0) {
            EXPECT_TRUE(history.pixels_before.pixels.empty());
          } else {
            const GBuffer before = render_gbuffer(model, shot.cameras[k - 1], {});
            EXPECT_EQ(history.pixels_before.pixels, pixels_before(now, shot.cameras[k], before, shot.cameras[k - 1]).pixels);
          }
        }
      }
}

TEST(FrameHistory, OfInkThatHoldsOnDrawsTheSameWhetherGBuffersAreHandedOverOrNot) {
  std::mt19937_64 random(random_seed());
  const Shot shot = shot_of(smooth_shapes()[1].field, Projection::perspective, random, 130, 5);
  const SceneModel model = model_of(shot.scene);
  PictureSettings handed{{rim(0.1), call_of("rim_width", {{"hysteresis", value(0.5)}})}, 3, {}}, kept = handed;
  kept.hands_over_gbuffer = false;
  FrameHistory of_handed, of_kept;
  bool holds = false;
  for (const Camera& camera : shot.cameras) {
    const Picture a = draw_picture(shot.scene, model, camera, handed, {}, &of_handed);
    const Picture b = draw_picture(shot.scene, model, camera, kept, {}, &of_kept);
    EXPECT_EQ(a.border.pixels, b.border.pixels);
    EXPECT_EQ(a.counts.hits, b.counts.hits);
    EXPECT_EQ(of_handed.pixels_before.pixels, of_kept.pixels_before.pixels);
    EXPECT_EQ(a.gbuffer.n_dot_v.pixels, of_kept.samples.front().gbuffer.n_dot_v.pixels);
    EXPECT_TRUE(b.gbuffer.n_dot_v.pixels.empty());
    holds |= a.border.pixels != draw_picture(shot.scene, model, camera, handed, {}).border.pixels;
  }
  EXPECT_TRUE(holds);
}

}  // namespace
}  // namespace limn::test
