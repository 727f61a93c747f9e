#include "sdf/camera.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <limits>
#include <numbers>

#include "random_field.h"
#include "sdf/error.h"

namespace limn {
namespace {

using std::numbers::pi;

Camera random_camera(Random& random, const Box& bounds) {
  CameraSettings settings;
  settings.width_px = 1 + random.index(2000);
  settings.height_px = 1 + random.index(2000);
  settings.vertical_fov = random.uniform(0.01, 3.0);
  settings.projection = random.index(2) == 0 ? Projection::perspective : Projection::orthographic;
  if (random.index(2) == 0) settings.direction = random.direction();
  if (random.index(3) == 0) settings.target = random.point(1.0);
  if (random.index(3) == 0) settings.eye = bounds.center() + random.direction() * bounds.radius() * random.uniform(1.5, 20.0);
  return resolve_camera(settings, bounds);
}

Box random_box(Random& random) {
  const glm::dvec3 middle = random.point(3.0), half = glm::abs(random.point(1.0)) + 0.01;
  return {middle - half, middle + half};
}

std::vector<glm::dvec3> corners(const Box& box) {
  std::vector<glm::dvec3> all;
  for (int i = 0; i < 8; ++i) {
    all.emplace_back((i & 1) ? box.upper.x : box.lower.x, (i & 2) ? box.upper.y : box.lower.y, (i & 4) ? box.upper.z : box.lower.z);
  }
  return all;
}

InputFault fault_of(const CameraSettings& settings) {
  try {
    resolve_camera(settings, {glm::dvec3(-1.0), glm::dvec3(1.0)});
  } catch (const InputError& error) {
    return error.fault();
  }
  ADD_FAILURE() << "accepted";
  return {};
}

RC_GTEST_PROP(Camera, ProjectionUndoesTheRay, (std::uint64_t seed)) {
  Random random(seed);
  const Camera camera = random_camera(random, random_box(random));
  for (int i = 0; i < 20; ++i) {
    const double x = random.uniform(0.0, camera.width_px), y = random.uniform(0.0, camera.height_px), t = random.uniform(0.1, 50.0);
    const CameraRay ray = camera_ray(camera, x, y);
    RC_ASSERT(std::abs(glm::length(ray.direction) - 1.0) <= 1e-14);
    const glm::dvec3 world = ray.origin + t * ray.direction;
    const glm::dvec3 image = project(camera, world);
    const double slack = 1e-10 * (camera.width_px + camera.height_px + camera.focal_px);
    RC_ASSERT(std::abs(image.x - x) <= slack);
    RC_ASSERT(std::abs(image.y - y) <= slack);
    RC_ASSERT(std::abs(image.z - t * glm::dot(ray.direction, -camera.world_from_camera[2])) <= 1e-11 * (1.0 + t));
    RC_ASSERT(glm::length(view_vector(camera, world) + ray.direction) <= 1e-12);
    const glm::dvec3 origin = random.point(100.0);
    RC_ASSERT(glm::length(project(moved(camera, origin), world - origin) - image) <= 1e-9 * (1.0 + glm::length(image)));
  }
}

RC_GTEST_PROP(Camera, AxesAreARightHandedOrthonormalBasis, (std::uint64_t seed)) {
  Random random(seed);
  const glm::dmat3 m = random_camera(random, random_box(random)).world_from_camera;
  const glm::dmat3 error = glm::transpose(m) * m - glm::dmat3(1.0);
  for (int k = 0; k < 3; ++k) RC_ASSERT(glm::length(error[k]) <= 1e-14);
  RC_ASSERT(std::abs(glm::determinant(m) - 1.0) <= 1e-14);
}

// All corners inside the margin, and at least one on it: nothing is cut and nothing is wasted.
RC_GTEST_PROP(Camera, FramingFillsThePictureUpToTheMargin, (std::uint64_t seed)) {
  Random random(seed);
  const Box box = random_box(random);
  CameraSettings settings;
  settings.width_px = 1 + random.index(2000);
  settings.height_px = 1 + random.index(2000);
  settings.vertical_fov = random.uniform(0.01, 3.0);
  settings.projection = random.index(2) == 0 ? Projection::perspective : Projection::orthographic;
  settings.direction = random.direction();
  const bool around_target = random.index(2) == 0;
  if (around_target) settings.target = box.center() + random.point(0.5);
  const Camera camera = resolve_camera(settings, box);
  double low_x = 1.0, low_y = 1.0, high_x = 0.0, high_y = 0.0;
  for (const glm::dvec3& corner : corners(box)) {
    const glm::dvec3 image = project(camera, corner);
    RC_ASSERT(image.z > 0.0);
    low_x = std::min(low_x, image.x / camera.width_px);
    high_x = std::max(high_x, image.x / camera.width_px);
    low_y = std::min(low_y, image.y / camera.height_px);
    high_y = std::max(high_y, image.y / camera.height_px);
  }
  const double tightest = std::min({low_x, low_y, 1.0 - high_x, 1.0 - high_y});
  // The axes are those that an eye and a target one unit before it give again: an eye far away, as narrow pictures have it, rounds them.
  const double distance = glm::distance(camera.eye, box.center());
  const double rounding = std::numeric_limits<double>::epsilon() * glm::length(camera.eye) * (1.0 + distance) *
                          pixels_per_unit_at(camera, distance) / std::min(camera.width_px, camera.height_px);
  const double slack = 1e-9 + rounding;
  RC_ASSERT(rounding < 1e-3);
  RC_ASSERT(tightest >= 0.06 - slack);
  double nearest = 1e9;
  for (const glm::dvec3& corner : corners(box)) nearest = std::min(nearest, project(camera, corner).z);
  const bool kept_clear = settings.projection == Projection::perspective && nearest < 0.1001 * box.radius();
  if (!kept_clear) RC_ASSERT(tightest <= 0.06 + slack);
  if (!around_target) {  // centred: both sides of the tight pair touch
    RC_ASSERT(std::abs(low_x - (1.0 - high_x)) <= 1e-6);
    RC_ASSERT(std::abs(low_y - (1.0 - high_y)) <= 1e-6);
  } else {
    const glm::dvec3 middle = project(camera, *settings.target);
    RC_ASSERT(std::abs(middle.x / camera.width_px - 0.5) <= slack);
    RC_ASSERT(std::abs(middle.y / camera.height_px - 0.5) <= slack);
  }
}

// THEORY: a sphere's outline is a circle of R * pixels_per_unit, or of f tan(asin(R/D)) where the axis meets the centre.
TEST(Camera, OutlineOfASphereHasTheClosedRadius) {
  const double radius = 0.7, distance = 3.0;
  CameraSettings settings;
  settings.eye = glm::dvec3(1.0, 2.0, -1.0) + distance * glm::normalize(glm::dvec3(1.0, 0.4, 2.0));
  settings.target = glm::dvec3(1.0, 2.0, -1.0);
  settings.vertical_fov = 0.8;
  settings.height_px = 600;
  const Camera camera = resolve_camera(settings, {});
  const double focal = 300.0 / std::tan(0.4);
  EXPECT_NEAR(camera.focal_px, focal, 1e-9);
  EXPECT_NEAR(pixels_per_unit_at(camera, 2.0), focal / 2.0, 1e-9);
  const double outline = focal * std::tan(std::asin(radius / distance));
  const auto nearest = [&](const Camera& c, double x_px) {  // of the ray to the centre
    const CameraRay ray = camera_ray(c, 640.0 + x_px, 300.0);
    const glm::dvec3 to_center = *settings.target - ray.origin;
    return glm::length(to_center - ray.direction * glm::dot(to_center, ray.direction));
  };
  EXPECT_NEAR(nearest(camera, outline), radius, 1e-12);
  settings.projection = Projection::orthographic;
  settings.ortho_height = 2.4;
  const Camera parallel = resolve_camera(settings, {});
  EXPECT_NEAR(parallel.pixels_per_unit, 250.0, 1e-12);
  EXPECT_NEAR(nearest(parallel, 250.0 * radius), radius, 1e-12);
}

TEST(Camera, UpIsUpAndRightIsRight) {
  CameraSettings settings;
  settings.eye = glm::dvec3(0, 0, 5);
  settings.target = glm::dvec3(0, 0, 0);
  const Camera camera = resolve_camera(settings, {});
  EXPECT_NEAR(project(camera, {0, 0, 0}).x, 640.0, 1e-12);
  EXPECT_NEAR(project(camera, {0, 0, 0}).y, 360.0, 1e-12);
  EXPECT_GT(project(camera, {1, 0, 0}).x, 640.0);
  EXPECT_LT(project(camera, {0, 1, 0}).y, 360.0);
  EXPECT_NEAR(project(camera, {0, 0, 2}).z, 3.0, 1e-12);
  EXPECT_LE(project(camera, {0, 0, 6}).z, 0.0);
}

TEST(Camera, WrittenAsEyeTargetAndUpItIsTheSameToTheLastBit) {
  constexpr std::uint64_t seed = 20261125;
  Random random(seed);
  int near = 0, same = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Camera camera = random_camera(random, random_box(random));
    // From far away a target one unit off has fewer digits than a direction.
    if (glm::length(camera.eye) > 6.0) continue;
    ++near;
    CameraSettings written;
    written.eye = camera.eye;
    written.target = camera.eye - camera.world_from_camera[2];
    written.up = camera.world_from_camera[1];
    const Camera again = resolve_camera(written, Box{glm::dvec3(-1.0), glm::dvec3(1.0)});
    same += again.world_from_camera == camera.world_from_camera ? 1 : 0;
  }
  EXPECT_GT(near, 10'000);
  EXPECT_EQ(same, near) << "seed " << seed;
}

TEST(Camera, DefaultViewLooksFromAboveWhateverIsUp) {
  for (const glm::dvec3& up :
       {glm::dvec3(0, 1, 0), glm::dvec3(0, -1, 0), glm::dvec3(0, 0, 2), glm::dvec3(0.6, 0.45, 0.75), glm::dvec3(1, 0, 0)}) {
    CameraSettings settings;
    settings.up = up;
    const Camera camera = resolve_camera(settings, {glm::dvec3(-1.0), glm::dvec3(1.0)});
    EXPECT_NEAR(glm::dot(camera.world_from_camera[2], glm::normalize(up)), 0.45 / glm::length(glm::dvec3(0.6, 0.45, 0.75)), 1e-12);
    EXPECT_GT(glm::dot(camera.world_from_camera[1], up), 0.0);
  }
}

TEST(Camera, AViewAlongUpIsAnErrorOnlyWhereItWasAskedFor) {
  CameraSettings settings;
  settings.direction = glm::dvec3(0, 3, 0);
  const Camera camera = resolve_camera(settings, {glm::dvec3(-1.0), glm::dvec3(1.0)});
  EXPECT_NEAR(camera.world_from_camera[2].y, 1.0, 1e-15);
  CameraSettings chosen;
  chosen.eye = glm::dvec3(0, 3, 0);
  EXPECT_EQ(fault_of(chosen).field, "up");
}

TEST(Camera, BoundsWithoutASizeStillMakeACamera) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const Box& box : {Box{}, Box{glm::dvec3(-infinity), glm::dvec3(infinity)}, Box{glm::dvec3(5.0), glm::dvec3(5.0)},
                         make_shape("plane").traits().bounds}) {
    for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
      CameraSettings settings;
      settings.projection = projection;
      const Camera camera = resolve_camera(settings, box);
      EXPECT_TRUE(std::isfinite(glm::length(camera.eye)));
      EXPECT_TRUE(std::isfinite(camera.focal_px) && std::isfinite(camera.pixels_per_unit) && camera.pixels_per_unit > 0.0);
    }
  }
}

TEST(Camera, ViewDirectionsAreUnitAndSpreadEvenly) {
  EXPECT_NEAR(glm::dot(view_direction(0, 1), glm::normalize(glm::dvec3(0.6, 0.45, 0.75))), 1.0, 1e-15);
  const int count = 200;
  glm::dvec3 mean(0.0);
  double nearest_most = 0.0, nearest_least = 1e9;
  for (int i = 0; i < count; ++i) {
    const glm::dvec3 a = view_direction(i, count);
    EXPECT_NEAR(glm::length(a), 1.0, 1e-14);
    mean += a / static_cast<double>(count);
    double nearest = 1e9;
    for (int j = 0; j < count; ++j) {
      if (j != i) nearest = std::min(nearest, glm::length(a - view_direction(j, count)));
    }
    nearest_most = std::max(nearest_most, nearest);
    nearest_least = std::min(nearest_least, nearest);
  }
  EXPECT_NEAR(glm::dot(view_direction(0, count), glm::normalize(glm::dvec3(0.6, 0.45, 0.75))), 1.0, 1e-14);
  EXPECT_LE(glm::length(mean), 0.01);
  const double ideal = std::sqrt(4.0 * pi / count);  // the side of a square that each has to itself
  EXPECT_GE(nearest_least, 0.6 * ideal);
  EXPECT_LE(nearest_most, 1.2 * ideal);
}

RC_GTEST_PROP(Camera, MatricesAgreeWithTheProjection, (std::uint64_t seed)) {
  Random random(seed);
  const Camera camera = random_camera(random, random_box(random));
  const CameraRay ray = camera_ray(camera, random.uniform(0.0, camera.width_px), random.uniform(0.0, camera.height_px));
  const glm::dvec4 world(ray.origin + random.uniform(0.5, 20.0) * ray.direction, 1.0);
  const glm::dvec3 image = project(camera, glm::dvec3(world));
  const glm::dvec4 in_camera = camera_from_world_matrix(camera) * world, clip = ndc_from_world_matrix(camera) * world;
  RC_ASSERT(std::abs(-in_camera.z - image.z) <= 1e-10 * (1.0 + image.z));
  RC_ASSERT(std::abs((clip.x / clip.w + 1.0) * 0.5 * camera.width_px - image.x) <= 1e-8 * camera.width_px);
  RC_ASSERT(std::abs((1.0 - clip.y / clip.w) * 0.5 * camera.height_px - image.y) <= 1e-8 * camera.height_px);
}

TEST(Camera, WhatMakesNoCameraIsRefusedByField) {
  const double infinity = std::numeric_limits<double>::infinity(), nan = std::nan("");
  const auto with = [](const auto& change) {
    CameraSettings settings;
    change(settings);
    return fault_of(settings).field;
  };
  for (const int bad : {0, -1, 16385}) {
    EXPECT_EQ(with([&](CameraSettings& s) { s.width_px = bad; }), "size");
    EXPECT_EQ(with([&](CameraSettings& s) { s.height_px = bad; }), "size");
  }
  for (const double bad : {0.0, pi, -1.0, 4.0, nan, infinity}) EXPECT_EQ(with([&](CameraSettings& s) { s.vertical_fov = bad; }), "fov");
  for (const double bad : {0.0, -1.0, nan, infinity}) EXPECT_EQ(with([&](CameraSettings& s) { s.ortho_height = bad; }), "ortho");
  EXPECT_EQ(with([&](CameraSettings& s) { s.eye = glm::dvec3(nan, 0, 0); }), "eye");
  EXPECT_EQ(with([&](CameraSettings& s) { s.target = glm::dvec3(infinity, 0, 0); }), "target");
  EXPECT_EQ(with([&](CameraSettings& s) { s.eye = s.target = glm::dvec3(1, 2, 3); }), "eye");
  EXPECT_EQ(with([&](CameraSettings& s) { s.up = glm::dvec3(0.0); }), "up");
  EXPECT_EQ(with([&](CameraSettings& s) { s.up = glm::dvec3(0, nan, 0); }), "up");
  EXPECT_EQ(with([&](CameraSettings& s) {
              s.eye = glm::dvec3(0, 5, 0);
              s.target = glm::dvec3(0, -5, 0);
            }),
            "up");
  CameraSettings wide;
  wide.vertical_fov = pi;
  EXPECT_EQ(fault_of(wide).value, "180");
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{16384, 1}}) {
    CameraSettings settings;
    settings.width_px = width;
    settings.height_px = height;
    EXPECT_NO_THROW(resolve_camera(settings, {glm::dvec3(-1.0), glm::dvec3(1.0)}));
  }
}

}  // namespace
}  // namespace limn
