// The analytic marcher against a march that is a hundred times finer, and the places where marchers fail: thin walls, grazing rays,
// flat faces in their own bounds, cameras inside.

#include <fmt/core.h>

#include <limits>

#include "tests/random_seed.h"
#include "tests/raymarch/scenes.h"

namespace limn::test {
namespace {

RayBatch one_ray(const glm::vec3& origin, const glm::vec3& direction, float t_max = 100.0f) {
  RayBatch rays;
  rays.count = 1;
  rays.set(0, origin, direction, 0.0, t_max);
  return rays;
}

struct OneHit {
  HitStatus status = HitStatus::miss;
  float t = 0.0f;
  glm::vec3 normal{0.0f};
};

OneHit trace_one(const Field& field, const glm::vec3& origin, const glm::vec3& direction, SurfaceSettings settings = {}) {
  const Surface surface = find_surface("analytic").build(object_of(field), settings, glm::dvec3(0.0));
  const RayBatch rays = one_ray(origin, direction);
  HitBatch hits;
  hits.status[0] = HitStatus::miss;
  surface.trace(surface.state.get(), rays, hits);
  if (hits.status[0] == HitStatus::miss) return {};
  return {hits.status[0], hits.t[0], {hits.normal_x[0], hits.normal_y[0], hits.normal_z[0]}};
}

using Random = std::mt19937_64;

double uniform(Random& random, double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); }

glm::dvec3 random_vector(Random& random, double size) {
  return {uniform(random, -size, size), uniform(random, -size, size), uniform(random, -size, size)};
}

Field random_leaf(Random& random) {
  Field field = make_shape("sphere", {{"radius", {uniform(random, 0.3, 0.8)}}});
  switch (random() % 5) {
    case 0:
      field = make_shape("box", {{"half", {uniform(random, 0.2, 0.7), uniform(random, 0.2, 0.7), uniform(random, 0.05, 0.7)}}});
      break;
    case 1:
      field = make_shape("torus", {{"major", {uniform(random, 0.4, 0.7)}}, {"minor", {uniform(random, 0.05, 0.3)}}});
      break;
    case 2:
      field = make_shape("cylinder", {{"radius", {uniform(random, 0.1, 0.6)}}, {"half_height", {uniform(random, 0.1, 0.8)}}});
      break;
    case 3:
      field = make_shape("ellipsoid", {{"radii", {uniform(random, 0.1, 0.8), uniform(random, 0.3, 0.8), uniform(random, 0.3, 0.8)}}});
      break;
    default:
      break;
  }
  if (random() % 3 == 0) field = scale(field, glm::dvec3(uniform(random, 0.4, 2.0), uniform(random, 0.4, 2.0), uniform(random, 0.4, 2.0)));
  return translate(rotate(field, random_vector(random, 1.0) + glm::dvec3(0, 0, 1.1), uniform(random, 0.0, 3.0)),
                   random_vector(random, 0.5));
}

Field random_scene(Random& random) {
  Field field = random_leaf(random);
  for (std::uint64_t i = random() % 3 + 1; i > 0; --i) {
    const auto operation = static_cast<Csg>(random() % 5 % 3);
    const Field other = random_leaf(random);
    // A difference or an intersection may leave nothing; keep something to hit.
    field =
        combine(operation == Csg::intersection ? Csg::union_ : operation, field, other, random() % 2 ? uniform(random, 0.02, 0.3) : 0.0);
  }
  if (random() % 4 == 0) field = shell(field, uniform(random, 0.01, 0.1));
  return field;
}

/// The first sign change on `count` equal steps; infinity where there is none. `closest` is the least |f| met.
double fine_march(FieldEvaluator& evaluator, const glm::dvec3& origin, const glm::dvec3& direction, double t_end, int count,
                  double& closest) {
  std::vector<glm::dvec3> points(static_cast<size_t>(count));
  std::vector<double> values(points.size());
  for (size_t i = 0; i < points.size(); ++i) points[i] = origin + direction * (t_end * static_cast<double>(i) / (count - 1));
  evaluator.values(std::span<const glm::dvec3>(points), std::span<double>(values));
  closest = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < values.size(); ++i) {
    closest = std::min(closest, std::abs(values[i]));
    if (i > 0 && (values[i] < 0.0) != (values[0] < 0.0)) return t_end * (static_cast<double>(i) - 0.5) / (count - 1);
  }
  return std::numeric_limits<double>::infinity();
}

TEST(Analytic, NoHolesAndNoThroughHitsAgainstAHundredTimesFinerMarch) {
  const std::uint64_t seed = random_seed();
  SCOPED_TRACE(fmt::format("seed {}", seed));
  Random random(seed);
  constexpr int steps = 8000;
  constexpr double reach = 8.0;
  int hits = 0, compared = 0;
  double worst = 0.0;
  for (int scene = 0; scene < 40; ++scene) {
    const Field field = random_scene(random);
    FieldEvaluator evaluator(field);
    const Surface surface = find_surface("analytic").build(object_of(field), {}, glm::dvec3(0.0));
    RayBatch rays;
    rays.count = 60;
    for (int i = 0; i < rays.count; ++i) {
      const glm::dvec3 origin = 4.0 * glm::normalize(random_vector(random, 1.0) + glm::dvec3(1e-3));
      rays.set(i, origin, glm::normalize(random_vector(random, 0.8) - origin), 0.0, reach);
    }
    HitBatch batch;
    std::fill_n(batch.status, kRayBatchSize, HitStatus::miss);
    surface.trace(surface.state.get(), rays, batch);
    for (int i = 0; i < rays.count; ++i) {
      ASSERT_NE(batch.status[i], HitStatus::out_of_steps);
      const glm::dvec3 origin(rays.origin(i)), direction(rays.direction(i));
      double closest = 0.0;
      const double truth = fine_march(evaluator, origin, direction, reach, steps, closest);
      if (batch.status[i] == HitStatus::hit) {
        const double t = batch.t[i], step = reach / steps;
        // On the surface, and no later than the march's first crossing; it may come earlier where the march stepped over a sliver.
        EXPECT_LT(std::abs(evaluator.value(origin + t * direction)), 3e-6 * field.traits().lipschitz);
        EXPECT_LT(t, truth + step) << "through-surface hit in scene " << scene << " ray " << i;
        if (t < truth - step) {
          FieldEvaluator fine(field);
          double ignored = 0.0;
          const glm::dvec3 start = origin + (t - step) * direction;
          EXPECT_TRUE(std::isfinite(fine_march(fine, start, direction, 2 * step, 20000, ignored)) || std::abs(closest) < 1e-3)
              << "false hit in scene " << scene;
        } else {
          worst = std::max(worst, std::abs(t - truth));
        }
        const glm::dvec3 normal(batch.normal_x[i], batch.normal_y[i], batch.normal_z[i]);
        EXPECT_NEAR(glm::length(normal), 1.0, 1e-6);
        ++hits;
      } else {
        EXPECT_FALSE(std::isfinite(truth)) << "hole in scene " << scene << " ray " << i;
      }
      ++compared;
    }
  }
  fmt::print("{} of {} rays hit; largest distance from the fine march's crossing {:.1e} (its step is {:.1e})\n", hits, compared, worst,
             reach / steps);
  EXPECT_GT(hits, compared / 4);
}

TEST(Analytic, AShellOfOneTenThousandthIsHitOnItsOuterSide) {
  const Field field = shell(make_shape("sphere", {{"radius", {1.0}}}), 1e-4);
  for (int i = 0; i < 50; ++i) {
    const double offset = 0.9999 * i / 50.0;
    const OneHit hit = trace_one(field, {static_cast<float>(offset), 0.0f, 3.0f}, {0, 0, -1});
    ASSERT_EQ(hit.status, HitStatus::hit) << offset;
    const double x = static_cast<float>(offset);
    EXPECT_NEAR(hit.t, 3.0 - std::sqrt(1.00005 * 1.00005 - x * x), 1e-5);
    EXPECT_GT(hit.normal.z, 0.0f);
  }
}

TEST(Analytic, GrazingRaysAreDecidedToTheLastMicron) {
  const Field sphere = make_shape("sphere", {{"radius", {1.0}}});
  for (const float clearance : {1e-2f, 1e-3f, 1e-4f, 1e-5f, 1e-6f, 3e-7f}) {
    EXPECT_EQ(trace_one(sphere, {1.0f + clearance, 0, 3}, {0, 0, -1}).status, HitStatus::miss) << clearance;
    EXPECT_EQ(trace_one(sphere, {1.0f - clearance, 0, 3}, {0, 0, -1}).status, HitStatus::hit) << clearance;
  }
  // Exactly tangent: either answer is right, running out of steps is not.
  EXPECT_NE(trace_one(sphere, {1, 0, 3}, {0, 0, -1}).status, HitStatus::out_of_steps);
}

TEST(Analytic, ABoxIsHitAtItsFacesAlthoughTheyLieInItsBounds) {
  const Field box = make_shape("box", {{"half", {1.0, 0.5, 0.25}}});
  const glm::vec3 half(1.0f, 0.5f, 0.25f);
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0f, 1.0f}) {
      glm::vec3 origin(0.0f), direction(0.0f);
      origin[axis] = 4.0f * side;
      direction[axis] = -side;
      const OneHit hit = trace_one(box, origin, direction);
      ASSERT_EQ(hit.status, HitStatus::hit);
      EXPECT_NEAR(hit.t, 4.0f - half[axis], 1e-6f);
      EXPECT_NEAR(hit.normal[axis], side, 1e-6f);
    }
  }
  // Along a face, in its plane: defined, whichever way.
  EXPECT_NE(trace_one(box, {1.0f, 0.0f, 4.0f}, {0, 0, -1}).status, HitStatus::out_of_steps);
  EXPECT_EQ(trace_one(box, {1.00001f, 0.0f, 4.0f}, {0, 0, -1}).status, HitStatus::miss);
  EXPECT_EQ(trace_one(box, {0.99999f, 0.0f, 4.0f}, {0, 0, -1}).status, HitStatus::hit);
}

TEST(Analytic, FromInsideTheFarWallIsHitAndItsNormalStaysOutward) {
  const OneHit hit = trace_one(make_shape("sphere", {{"radius", {2.0}}}), {0.5f, 0, 0}, {1, 0, 0});
  ASSERT_EQ(hit.status, HitStatus::hit);
  EXPECT_NEAR(hit.t, 1.5f, 1e-6f);
  EXPECT_NEAR(hit.normal.x, 1.0f, 1e-6f);
}

TEST(Analytic, ARayThatRunsOutOfStepsSaysSo) {
  SurfaceSettings settings;
  settings.max_steps = 2;
  const OneHit hit = trace_one(make_shape("torus"), {0.2f, 0.3f, 5.0f}, glm::normalize(glm::vec3(0.05f, -0.02f, -1.0f)), settings);
  EXPECT_EQ(hit.status, HitStatus::out_of_steps);
}

TEST(Analytic, AnUnboundedPlaneIsHitFromFarAndNear) {
  const Scene scene = scene_of({object_of(make_shape("plane")), object_of(make_shape("sphere", {{"radius", {0.5}}}))});
  CameraSettings settings = view(64, 64);
  settings.eye = glm::dvec3(0, 30, 40);
  settings.target = glm::dvec3(0, 0, 0);
  const GBuffer seen = render_gbuffer(model_of(scene), framing(scene, settings), {});
  EXPECT_EQ(count_hits(seen).hits, 64 * 64);
  settings.eye = glm::dvec3(0, 3, 4);
  const Camera camera = framing(scene, settings);
  const GBuffer near = render_gbuffer(model_of(scene), camera, {});
  for (int y = 40; y < 64; ++y) {
    // Where the floor is seen, its depth is that of the plane y = 0.
    const CameraRay ray = camera_ray(camera, 2.5, y + 0.5);
    const double t = -ray.origin.y / ray.direction.y;
    EXPECT_NEAR(near.depth.at(2, y), project(camera, ray.origin + t * ray.direction).z, 1e-4);
  }
}

TEST(Analytic, MeshesAndVolumesAreRefusedWithAReason) {
  const SceneObject object = object_of(box_mesh(glm::dvec3(1.0)));
  EXPECT_FALSE(find_surface("analytic").unsupported(object).empty());
  try {
    model_of(scene_of({object}), "analytic");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("mesh"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace limn::test
