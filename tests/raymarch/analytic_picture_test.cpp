// Pictures of random fields, tile by tile, against walks along single rays in double; and against themselves with other tiles, threads
// and SIMD targets.

#include <fmt/core.h>

#include <cstring>

#include "raymarch/gbuffer/gbuffer_window.h"
#include "tests/random_seed.h"
#include "tests/raymarch/field_walk.h"
#include "tests/raymarch/scenes.h"
#include "tests/sdf/random_field.h"
#include "tests/simd_targets.h"

namespace limn::test {
namespace {

/// From afar, from near, from inside; either projection; sizes from a single pixel on.
Camera random_camera(Random& random, const Box& box) {
  CameraSettings settings;
  settings.projection = random.index(3) == 0 ? Projection::orthographic : Projection::perspective;
  const int most = random.index(4) == 0 ? 90 : 24;
  settings.width_px = 1 + random.index(most);
  settings.height_px = 1 + random.index(most);
  const double radius = box.finite() && box.radius() > 0.0 ? box.radius() : 2.0;  // bounds may be a single point
  const glm::dvec3 center = box.finite() ? box.center() : glm::dvec3(0.0);
  const double away = random.index(3) == 0 ? random.uniform(0.0, 1.0) : std::exp2(random.uniform(0.0, 5.0));
  settings.eye = center + away * radius * random.direction();
  settings.target = center + 0.5 * random.point(radius);
  settings.vertical_fov = away < 1.0 ? random.uniform(0.3, 2.2) : std::min(2.6, random.uniform(0.5, 2.5) * std::atan(1.0 / away));
  settings.ortho_height = random.uniform(0.2, 2.5) * radius;
  return resolve_camera(settings, box.finite() ? box : Box{glm::dvec3(-2.0), glm::dvec3(2.0)});
}

struct Differences {
  int rays = 0, hits = 0, wrong = 0;
  double farthest_wrong = 0.0;  ///< How far from the surface the ray passes, or how deep it goes in; shares of the scale.
  double worst_off = 0.0;       ///< Of hits from the surface, shares of the scale.
};

/// By how much the floats of a world position may have been rounded. What rays are off is a share of where they are in render space, which
/// has its origin at the scene's centre; positions are the world's, and the scene may lie far from its origin.
double rounding_of(const glm::vec3& position) {
  double squared = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const float a = std::abs(position[axis]);
    const double half = 0.5 * (static_cast<double>(std::nextafter(a, std::numeric_limits<float>::infinity())) - static_cast<double>(a));
    squared += half * half;
  }
  return std::sqrt(squared);
}

/// One pixel of a picture of a field with finite bounds. Rays are float: what they are off is a share of where they are.
void compare_pixel(FieldEvaluator& field, const Camera& camera, const GBuffer& seen, int x, int y, Differences& all) {
  const Box& box = field.field().traits().bounds;
  const CameraRay ray = camera_ray(camera, x + 0.5, y + 0.5);
  const double middle = glm::dot(box.center() - ray.origin, ray.direction), reach = 1.01 * box.radius();
  const double scale = glm::length(box.center() - ray.origin) + box.radius();
  ++all.rays;
  // Not by the depth: towards the edges of a wide view it tells less of the place.
  const double t = std::isfinite(seen.depth.at(x, y)) ? glm::dot(glm::dvec3(seen.position.at(x, y)) - ray.origin, ray.direction)
                                                      : std::numeric_limits<double>::infinity();
  const double from = std::max(0.0, middle - reach), to = std::max(from, middle + reach);
  const double truth = walk_field(field, ray.origin, ray.direction, from, to, {.extent = box.radius()});
  const bool outside = field.value(ray.origin + from * ray.direction) > 0.0;
  const auto wrong = [&](double a, double b) {
    ++all.wrong;
    all.farthest_wrong = std::max(all.farthest_wrong, std::abs(deepest(field, ray.origin, ray.direction, a, b, outside)) / scale);
  };
  ASSERT_NE(seen.status.at(x, y), static_cast<std::uint8_t>(HitStatus::out_of_steps));
  if (std::isfinite(t) != std::isfinite(truth)) return wrong(from, to);
  if (!std::isfinite(t)) return;
  ++all.hits;
  const double apart = std::abs(t - truth);
  if (apart > 1e-4 * scale) return wrong(std::max(from, std::min(t, truth) - 1e-5 * scale), std::min(t, truth) + 1e-5 * scale);
  const double off = std::abs(field.value(ray.origin + t * ray.direction)) / field.field().traits().lipschitz;
  all.worst_off = std::max(all.worst_off, (off - rounding_of(seen.position.at(x, y))) / scale);
}

void compare(const Field& field, const Camera& camera, const GBuffer& seen, Differences& all) {
  FieldEvaluator evaluator(field);
  for (int y = 0; y < camera.height_px; ++y) {
    for (int x = 0; x < camera.width_px; ++x) {
      compare_pixel(evaluator, camera, seen, x, y, all);
      if (testing::Test::HasFatalFailure()) return;
    }
  }
}

bool same(const GBuffer& a, const GBuffer& b) {
  return a.depth.pixels == b.depth.pixels && a.normal.pixels == b.normal.pixels && a.status.pixels == b.status.pixels &&
         a.id.pixels == b.id.pixels;
}

TEST(AnalyticPictures, AreWhatWalksAlongSingleRaysSeeWhateverTheFieldAndTheCamera) {
  const std::uint64_t seed = random_seed();
  Random random(seed);
  Differences all;
  for (int k = 0; k < 150; ++k) {
    SCOPED_TRACE(fmt::format("seed {}, picture {}", seed, k));
    const Field field = random_field(random, random.index(4));
    const Box& box = field.traits().bounds;
    const Camera camera = random_camera(random, box);
    const int tile_px = 1 + random.index(16);
    if (box.empty() || !box.finite()) continue;
    const SceneModel model = model_of(scene_of({object_of(field)}));
    const GBuffer seen = render_gbuffer(model, camera, {.threads = 1, .tile_px = 16});
    EXPECT_TRUE(same(seen, render_gbuffer(model, camera, {.threads = 3, .tile_px = tile_px}))) << "tiles of " << tile_px;
    Differences one;
    compare(field, camera, seen, one);
    EXPECT_LT(one.farthest_wrong, 3e-7);
    EXPECT_LT(one.worst_off, 1.5e-7);
    all.rays += one.rays, all.hits += one.hits, all.wrong += one.wrong;
    all.farthest_wrong = std::max(all.farthest_wrong, one.farthest_wrong);
    all.worst_off = std::max(all.worst_off, one.worst_off);
    if (HasFailure()) break;
  }
  fmt::print("seed {}: {} rays, {} hits; {} otherwise, at most {:.1e} from the silhouette; hits off the surface by at most {:.1e}\n", seed,
             all.rays, all.hits, all.wrong, all.farthest_wrong, all.worst_off);
  EXPECT_GT(all.hits, all.rays / 20);
}

bool same_bits(const Image<glm::vec3>& a, const Image<glm::vec3>& b) {
  return a.pixels.size() == b.pixels.size() && std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(glm::vec3)) == 0;
}

/// Fields side by side; now and then one without end, which is traced by itself.
Scene random_scene(Random& random) {
  std::vector<SceneObject> objects;
  for (int k = random.index(3); k >= 0; --k)
    objects.push_back(object_of(random_field(random, random.index(3)), fmt::format("field {}", k)));
  if (random.index(8) == 0) objects.push_back(object_of(make_shape("plane"), "ground"));
  return scene_of(std::move(objects));
}

TEST(AnalyticPictures, OfSeveralSamplesTogetherAreThoseOfEachByItself) {
  const std::uint64_t seed = random_seed();
  Random random(seed);
  int hits = 0;
  for (int k = 0; k < 120; ++k) {
    SCOPED_TRACE(fmt::format("seed {}, picture {}", seed, k));
    const Scene scene = random_scene(random);
    const SceneModel model = model_of(scene);
    const Camera camera = random_camera(random, bounds(scene));
    std::vector<GBuffer> seen(static_cast<size_t>(2 + random.index(16)));
    std::vector<PixelRays> rays;
    for (GBuffer& one : seen)
      rays.push_back({{random.uniform(-0.2, 1.2), random.uniform(-0.2, 1.2)}, {}, true, [](const TracedPixels&) {}, &one});
    render_pixels(model, camera, {.threads = 1 + random.index(3), .tile_px = 1 + random.index(16)}, rays);
    for (size_t i = 0; i < seen.size(); ++i) {
      const GBuffer alone = render_gbuffer(model, camera, {.threads = 1}, rays[i].offset);
      EXPECT_TRUE(same(seen[i], alone)) << "sample " << i << " of " << seen.size();
      EXPECT_TRUE(same_bits(seen[i].normal, alone.normal)) << "sample " << i << ": signs of zeros";
      EXPECT_TRUE(seen[i].n_dot_v.pixels == alone.n_dot_v.pixels && seen[i].material.pixels == alone.material.pixels);
      EXPECT_EQ(seen[i].turned, alone.turned);
      hits += static_cast<int>(count_hits(alone).hits);
    }
    if (HasFailure()) break;
  }
  fmt::print("seed {}: {} hits\n", seed, hits);
  EXPECT_GT(hits, 10'000);
}

TEST(AnalyticPictures, AreTheSameOnEverySimdTarget) {
  const std::uint64_t seed = random_seed();
  SCOPED_TRACE(fmt::format("seed {}", seed));
  Random random(seed);
  int pixels = 0;
  for (int k = 0; k < 20; ++k) {
    const Field field = random_field(random, 1 + random.index(3));
    const Camera camera = random_camera(random, field.traits().bounds);
    const SceneModel model = model_of(scene_of({object_of(field)}));
    const GBuffer widest = render_gbuffer(model, camera, {.threads = 1});
    for_each_simd_target([&](const char* target) {
      EXPECT_TRUE(same(widest, render_gbuffer(model, camera, {.threads = 1}))) << target << ", picture " << k;
      pixels += camera.width_px * camera.height_px;
    });
  }
  EXPECT_GT(pixels, 0);
}

}  // namespace
}  // namespace limn::test
