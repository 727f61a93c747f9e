#include <gtest/gtest.h>

#include "sdf/error.h"
#include "tests/raymarch/level_set_rays.h"

namespace limn {
namespace {

using namespace testing_tools;

// Against closed forms ------------------------------------------------------------------------------------------------------------

TEST(LevelSetMarcher, NoRayTowardsTheInsideOfASphereGoesThrough) {
  const double radius = 1.0, h = 1.0 / 16.0;  // nodes fall on the poles
  const LevelSet level_set =
      level_set_from_field(make_shape("sphere", {{"radius", {radius}}}), {.voxel_size = h, .half_width_voxels = 1.8});
  const Surface surface = marcher(level_set, "cell");
  std::mt19937_64 random(fresh_seed());
  std::vector<Ray> rays;
  for (int i = 0; i < 200'000; ++i) {
    const glm::dvec3 origin = 3.0 * random_direction(random);
    glm::dvec3 target = 0.95 * random_direction(random);
    // A third of the targets are nodes of the grid, a third lie on faces.
    if (i % 3 == 0) target = glm::round(target / h) * h;
    if (i % 3 == 1) target.x = std::round(target.x / h) * h;
    if (glm::length(target) > 0.98) target *= 0.9;
    rays.push_back({glm::vec3(origin), glm::normalize(glm::vec3(target) - glm::vec3(origin))});
  }
  double worst = 0.0;
  int missed = 0;
  const std::vector<Hit> hits = trace(surface, rays);
  for (size_t i = 0; i < rays.size(); ++i) {
    missed += hits[i].status != HitStatus::hit;
    const glm::dvec3 p = glm::dvec3(rays[i].origin) + hits[i].t * glm::dvec3(rays[i].direction);
    if (hits[i].status == HitStatus::hit && glm::dot(p, glm::dvec3(rays[i].direction)) < 0.0)
      worst = std::max(worst, std::abs(glm::length(p) - radius));
    else
      ++missed;
  }
  EXPECT_EQ(missed, 0);
  EXPECT_LT(worst, 0.3 * h * h);
}

TEST(LevelSetMarcher, FromInsideTheInnerWallIsSeenAndNormalsStillPointOutwards) {
  const Surface surface = build(make_shape("sphere", {{"radius", {1.0}}}), {.voxel_size = 0.05});
  std::mt19937_64 random(1);
  for (int i = 0; i < 500; ++i) {
    const glm::dvec3 d = random_direction(random);
    const Hit hit = trace(surface, Ray{glm::vec3(0.01f, 0.02f, 0.03f), glm::vec3(d)});
    ASSERT_EQ(hit.status, HitStatus::hit);
    EXPECT_NEAR(hit.t, 1.0, 0.05);
    EXPECT_GT(glm::dot(hit.normal, d), 0.99);
  }
}

TEST(LevelSetMarcher, HitsLieBetweenTMinAndTMaxAndTheNextCrossingFollows) {
  const Surface surface = build(make_shape("sphere", {{"radius", {1.0}}}), {.voxel_size = 0.05});
  const glm::vec3 origin(0.013f, 0.022f, 3.0f), direction(0.0f, 0.0f, -1.0f);
  const Hit first = trace(surface, Ray{origin, direction});
  EXPECT_NEAR(first.t, 2.0, 1e-3);
  EXPECT_EQ(trace(surface, Ray{origin, direction, 0.0f, 1.9f}).status, HitStatus::miss);
  const Hit second = trace(surface, Ray{origin, direction, 2.1f});
  EXPECT_NEAR(second.t, 4.0, 1e-3);
  EXPECT_EQ(trace(surface, Ray{origin, direction, 2.1f, 3.9f}).status, HitStatus::miss);
  EXPECT_EQ(trace(surface, Ray{origin, direction, 4.1f}).status, HitStatus::miss);
  EXPECT_EQ(trace(surface, Ray{origin, -direction}).status, HitStatus::miss);
}

TEST(LevelSetMarcher, ALaneWithoutAHitIsNotTouched) {
  const Surface surface = build(make_shape("sphere", {{"radius", {1.0}}}), {.voxel_size = 0.1});
  RayBatch rays{};
  HitBatch hits{};
  rays.count = 1;
  rays.origin_z[0] = 3.0f, rays.direction_z[0] = 1.0f, rays.t_max[0] = 100.0f;
  hits.t[0] = 42.0f;
  hits.normal_x[0] = 43.0f;
  hits.status[0] = HitStatus::hit;
  surface.trace(surface.state.get(), rays, hits);
  EXPECT_EQ(hits.t[0], 42.0f);
  EXPECT_EQ(hits.normal_x[0], 43.0f);
  EXPECT_EQ(hits.status[0], HitStatus::hit);
}

TEST(LevelSetMarcher, RunningOutOfStepsIsAStatusOfItsOwn) {
  const LevelSet level_set = level_set_from_field(make_shape("sphere", {{"radius", {1.0}}}), {.voxel_size = 0.02});
  const Ray ray{{0.0f, 0.0f, 3.0f}, {0.0f, 0.0f, -1.0f}};
  EXPECT_EQ(trace(marcher(level_set, "central", 1), ray).status, HitStatus::out_of_steps);
  EXPECT_EQ(trace(marcher(level_set, "central", 1000), ray).status, HitStatus::hit);
}

TEST(LevelSetMarcher, AMillionUnitsFromTheOriginThePictureIsTheSame) {
  const glm::dvec3 far(1048576.0, -2097152.0, 524288.0);
  const Field shape = rotate(make_shape("ellipsoid"), {1.0, 2.0, 3.0}, 0.7);
  const Surface near = build(shape, {.voxel_size = 1.0 / 32.0, .gradient = "cubic"});
  const Surface away = build(translate(shape, far), {.voxel_size = 1.0 / 32.0, .gradient = "cubic"}, far);
  EXPECT_LT(glm::distance(near.bounds.lower, away.bounds.lower), 1e-6);
  std::mt19937_64 random(2);
  std::vector<Ray> rays;
  for (int i = 0; i < 3000; ++i) {
    const glm::vec3 origin(3.0 * random_direction(random)), target(0.6 * random_direction(random));
    rays.push_back({origin, glm::normalize(target - origin)});
  }
  const std::vector<Hit> a = trace(near, rays), b = trace(away, rays);
  for (size_t i = 0; i < rays.size(); ++i) {
    ASSERT_EQ(a[i].status, b[i].status);
    // Field values at a million carry a rounding of 1e-10, of which the gradient divides by the voxel size.
    EXPECT_NEAR(a[i].t, b[i].t, 1e-6);
    EXPECT_LT(glm::distance(a[i].normal, b[i].normal), 1e-5);
  }
}

TEST(LevelSetMarcher, AGridPlacedByAnAffineMapIsTracedInTheWorld) {
  const LevelSet level_set =
      level_set_from_field(make_shape("sphere", {{"radius", {1.0}}}), {.voxel_size = 0.02, .half_width_voxels = 4.2});
  Ellipsoid truth = Ellipsoid::jittered(5);
  truth.radii = {1.3, 0.6, 0.9};
  Affine world_from_object;
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 unit(0.0);
    unit[axis] = truth.radii[axis];
    world_from_object.linear[axis] = truth.turned(unit, truth.angle);
  }
  world_from_object.translation = truth.center;
  SceneObject object{.name = "egg", .source = LevelSetSource{level_set, "egg.vdb"}, .world_from_object = world_from_object};
  const glm::dvec3 render_origin(0.25, 0.5, -0.125);
  const Surface surface = find_surface("level_set").build(object, {.gradient = "cubic"}, render_origin);
  std::mt19937_64 random(6);
  int count = 0;
  for (int i = 0; i < 3000; ++i) {
    const glm::dvec3 origin = truth.center + 4.0 * random_direction(random), target = truth.center + 0.4 * random_direction(random);
    const Ray ray{glm::vec3(origin - render_origin), glm::vec3(glm::normalize(target - origin))};
    const double t = truth.intersect(glm::dvec3(ray.origin) + render_origin, glm::dvec3(ray.direction));
    const Hit hit = trace(surface, ray);
    ASSERT_EQ(hit.status, HitStatus::hit);
    EXPECT_NEAR(hit.t, t, 1e-3);
    const glm::dvec3 p = glm::dvec3(ray.origin) + render_origin + hit.t * glm::dvec3(ray.direction);
    EXPECT_LT(glm::distance(hit.normal, truth.normal(p)), 2e-3);
    EXPECT_TRUE(glm::all(glm::greaterThanEqual(p - render_origin, surface.bounds.lower)));
    EXPECT_TRUE(glm::all(glm::lessThanEqual(p - render_origin, surface.bounds.upper)));
    ++count;
  }
  EXPECT_EQ(count, 3000);
}

TEST(LevelSetMarcher, NormalsAreFiniteUnitVectorsOnCreasesToo) {
  const Field part = combine(Csg::difference, make_shape("box", {{"half", {0.8, 0.5, 0.6}}}), make_shape("sphere", {{"radius", {0.62}}}));
  std::mt19937_64 random(7);
  for (const GradientDescriptor& gradient : gradients()) {
    const Surface surface = build(part, {.voxel_size = 0.05, .gradient = gradient.about.name});
    for (int i = 0; i < 2000; ++i) {
      const glm::dvec3 origin = 3.0 * random_direction(random);
      const glm::dvec3 corner(i % 2 ? 0.8 : -0.8, i % 3 ? 0.5 : -0.5, std::uniform_real_distribution(-0.6, 0.6)(random));
      const Hit hit = trace(surface, Ray{glm::vec3(origin), glm::vec3(glm::normalize(0.999 * corner - origin))});
      if (hit.status == HitStatus::hit) {
        EXPECT_NEAR(glm::length(hit.normal), 1.0, 1e-6) << gradient.about.name;
      }
    }
  }
}

// What it refuses -----------------------------------------------------------------------------------------------------------------

TEST(LevelSetSurface, SettingsThatDoNotFitAreRefusedWithTheOption) {
  const Field sphere = make_shape("sphere", {{"radius", {1.0}}});
  const auto fault = [&](const SurfaceSettings& settings) -> InputFault {
    try {
      build(sphere, settings);
    } catch (const InputError& error) {
      return error.fault();
    }
    return {.file = {}, .field = "accepted", .value = {}, .problem = {}, .expected = {}};
  };
  EXPECT_EQ(fault({.half_width_voxels = 3.0, .gradient = "cubic"}).field, "half_width");
  EXPECT_NE(fault({.half_width_voxels = 3.0, .gradient = "cubic"}).expected.find("4.12"), std::string::npos);
  EXPECT_EQ(fault({.voxels = 1}).field, "voxels");
  EXPECT_EQ(fault({.voxel_size = -1.0}).field, "voxel_size");
  EXPECT_EQ(fault({.gradient = "cubik"}).field, "gradient");
  EXPECT_EQ(fault({.voxels = 32, .half_width_voxels = 4.12, .gradient = "cubic"}).field, "accepted");
}

TEST(LevelSetSurface, TheBandIsWhatTheGradientNeedsAndTheInfoSaysSo) {
  const Field sphere = make_shape("sphere", {{"radius", {1.0}}});
  std::int64_t before = 0;
  for (const GradientDescriptor& gradient : gradients()) {
    const Surface surface = build(sphere, {.voxels = 64, .gradient = gradient.about.name});
    const double width = std::max(1.8, gradient.half_width_voxels), h = 2.0 / 64.0;
    // A shell of the sphere, 2 width h thick.
    const double shell = 4.18879 * (std::pow(1.0 + width * h, 3.0) - std::pow(1.0 - width * h, 3.0)) / (h * h * h);
    EXPECT_NEAR(static_cast<double>(surface.info.voxels), shell, 0.02 * shell);
    EXPECT_DOUBLE_EQ(surface.info.voxel_size, h);
    EXPECT_EQ(surface.info.kind, "level_set");
    EXPECT_GT(surface.info.voxels, before);
    before = surface.info.voxels;
  }
}

TEST(LevelSetSurface, AMeshIsSentToTheSurfaceThatIsMadeForIt) {
  const SceneObject object{.name = "mesh", .source = MeshSource{}};
  EXPECT_NE(find_surface("level_set").unsupported(object).find("mesh_level_set"), std::string::npos);
  const SceneObject plane{.name = "plane", .source = make_shape("plane")};
  EXPECT_NE(find_surface("level_set").unsupported(plane).find("no bounds"), std::string::npos);
}

}  // namespace
}  // namespace limn
