// Scenes of many objects: the picture is that of the nearest, whatever tiles it is drawn in, and an object takes little memory.

#include <gtest/gtest.h>
#include <malloc.h>

#include <cstring>
#include <random>

#include "raymarch/gbuffer/trace_scene.h"
#include "scenes.h"

namespace limn::test {
namespace {

struct Ball {
  glm::dvec3 center{0.0};
  double radius = 0.0;
};

std::vector<Ball> balls(int count, double largest) {
  std::mt19937_64 random(17);
  const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  std::vector<Ball> made;
  for (int k = 0; k < count; ++k) made.push_back({2.0 * glm::dvec3(unit(), unit(), unit()) - 1.0, largest * (0.3 + 0.7 * unit())});
  return made;
}

Scene scene_of_balls(const std::vector<Ball>& made) {
  Scene scene;
  for (const Ball& ball : made)
    scene.objects.push_back(object_of(translate(make_shape("sphere", {{"radius", {ball.radius}}}), ball.center), "ball"));
  return scene;
}

/// The ball that the ray through a pixel meets first, from 1; 0: none; -1 where another is as near, or one is grazed.
int nearest_ball(const std::vector<Ball>& made, const Camera& camera, const glm::dvec3& position) {
  const glm::dvec3 direction = glm::normalize(position - camera.eye);
  int found = 0;
  double best = 1e300, second = 1e300;
  for (size_t k = 0; k < made.size(); ++k) {
    const glm::dvec3 to = made[k].center - camera.eye;
    const double along = glm::dot(to, direction), beside = std::sqrt(std::max(0.0, glm::dot(to, to) - along * along));
    if (std::abs(beside - made[k].radius) < 1e-4) return -1;
    if (beside > made[k].radius) continue;
    const double t = along - std::sqrt(made[k].radius * made[k].radius - beside * beside);
    if (t < best) {
      second = best;
      best = t, found = static_cast<int>(k) + 1;
    } else {
      second = std::min(second, t);
    }
  }
  return second - best < 1e-4 ? -1 : found;
}

template <class T>
bool same_bytes(const Image<T>& a, const Image<T>& b) {
  return a.pixels.size() == b.pixels.size() && std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(T)) == 0;
}

TEST(ManyObjects, EachPixelShowsTheNearestInTilesOfAnySize) {
  const std::vector<Ball> made = balls(400, 0.2);
  const Scene scene = scene_of_balls(made);
  const SceneModel model = model_of(scene);
  const Camera camera = framing(scene, view(150, 110));
  const GBuffer seen = render_gbuffer(model, camera, {});
  int hits = 0;
  for (int y = 0; y < seen.height; ++y) {
    for (int x = 0; x < seen.width; ++x) {
      if (seen.id.at(x, y) == 0) continue;
      const int expected = nearest_ball(made, camera, glm::dvec3(seen.position.at(x, y)));
      if (expected < 0) continue;
      ++hits;
      ASSERT_EQ(static_cast<int>(seen.id.at(x, y)), expected) << x << ", " << y;
    }
  }
  EXPECT_GT(hits, 3000);
  for (const int tile_px : {3, 7, 16}) {
    const GBuffer again = render_gbuffer(model, camera, {.threads = 2, .tile_px = tile_px});
    EXPECT_TRUE(same_bytes(again.id, seen.id) && same_bytes(again.depth, seen.depth) && same_bytes(again.normal, seen.normal)) << tile_px;
  }
}

TEST(ManyObjects, APixelThatNoObjectsBoundsReachIsEmpty) {
  const std::vector<Ball> made = balls(40, 0.02);
  const Scene scene = scene_of_balls(made);
  const SceneModel model = model_of(scene);
  const Camera camera = framing(scene, view(200, 150));
  const ModelView prepared = view_model(model, {moved(camera, model.render_origin), {0.5, 0.5}});
  ASSERT_FALSE(prepared.cells.empty());
  const GBuffer seen = render_gbuffer(model, camera, {});
  int empty = 0;
  for (int y = 0; y + 10 <= 150; y += 10)
    for (int x = 0; x + 10 <= 200; x += 10) {
      const bool any = touches(prepared, {x, y, 10, 10});
      empty += !any;
      for (int dy = 0; dy < 10 && !any; ++dy)
        for (int dx = 0; dx < 10; ++dx) EXPECT_EQ(seen.id.at(x + dx, y + dy), 0u);
    }
  EXPECT_GT(empty, 100);
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
double allocated_bytes() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks) + static_cast<double>(info.hblkhd);
}

TEST(ManyObjects, AnObjectTakesKilobytesNotItsThreadsMemory) {
  constexpr int kCount = 4000;
  const Scene scene = scene_of_balls(balls(kCount, 0.01));
  const Camera camera = framing(scene, view(320, 200));
  const double before = allocated_bytes();
  const SceneModel model = model_of(scene);
  const ModelView prepared = view_model(model, {moved(camera, model.render_origin), {0.5, 0.5}});
  const double each = (allocated_bytes() - before) / kCount;
  EXPECT_EQ(prepared.surfaces.size(), size_t{kCount});
  EXPECT_LT(each, 12'000.0);
}
#endif

}  // namespace
}  // namespace limn::test
