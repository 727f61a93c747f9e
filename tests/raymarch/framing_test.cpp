// Cameras that frame a surface, against all of its points: the outline fills 86 % of the tighter side of the picture and is centred.

#include "raymarch/framing.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <random>

#include "raymarch/frames.h"
#include "tests/random_seed.h"
#include "tests/raymarch/scenes.h"

namespace limn::test {
namespace {

constexpr double kPi = std::numbers::pi;

/// Where the points lie in the picture, as shares of its sides from -1 to 1.
struct Seen {
  glm::dvec2 low{1e9}, high{-1e9};
  double nearest = std::numeric_limits<double>::infinity();  ///< Depth.
  double tighter() const { return std::max(high.x - low.x, high.y - low.y) / 2.0; }
  double off_centre() const { return std::max(std::abs(high.x + low.x), std::abs(high.y + low.y)) / 2.0; }
};

Seen seen_of(const std::vector<glm::dvec3>& points, const Camera& camera) {
  Seen seen;
  for (const glm::dvec3& point : points) {
    const glm::dvec3 p = project(camera, point);
    seen.nearest = std::min(seen.nearest, p.z);
    const glm::dvec2 share(2.0 * p.x / camera.width_px - 1.0, 1.0 - 2.0 * p.y / camera.height_px);
    seen.low = glm::min(seen.low, share);
    seen.high = glm::max(seen.high, share);
  }
  return seen;
}

/// Within 2 % of 86 %: what is asked. Wide lenses on small pictures come near to it.
constexpr double kAsked = 0.02 * 0.86;

/// A wide lens on what points at it stands a tenth of its radius before it, and sees it smaller.
bool stands_close(const std::vector<glm::dvec3>& points, const Camera& camera) {
  if (camera.projection == Projection::orthographic) return false;
  Box box;
  double nearest = std::numeric_limits<double>::infinity();
  for (const glm::dvec3& point : points) {
    box = include(box, point);
    nearest = std::min(nearest, -glm::dot(point - camera.eye, camera.world_from_camera[2]));
  }
  return nearest < 0.15 * box.radius();
}

testing::AssertionResult is_framed(const std::vector<glm::dvec3>& points, const Camera& camera, double tolerance) {
  const Seen seen = seen_of(points, camera);
  const bool small = seen.tighter() <= 0.86 - tolerance && !stands_close(points, camera);
  const bool framed = seen.nearest > 0.0 && seen.tighter() < 0.86 + tolerance && !small && seen.off_centre() < tolerance;
  return (framed ? testing::AssertionSuccess() : testing::AssertionFailure())
         << points.size() << " points fill " << seen.tighter() << ", " << seen.off_centre() << " off the middle, the nearest at depth "
         << seen.nearest;
}

std::vector<CameraSettings> views(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::uniform_int_distribution<int> side(100, 900);
  std::uniform_real_distribution<double> fov(0.2, 1.6);
  std::vector<CameraSettings> all;
  for (int i = 0; i < 12; ++i) {
    CameraSettings settings = view(side(random), side(random), i % 2 ? Projection::orthographic : Projection::perspective);
    settings.direction = glm::dvec3(normal(random), normal(random), normal(random));
    settings.vertical_fov = fov(random);
    all.push_back(settings);
  }
  return all;
}

/// Points of the ellipsoid with these half axes, turned and moved.
std::vector<glm::dvec3> points_of_ellipsoid(const glm::dvec3& radii, const Affine& place) {
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 400; ++i) {
    for (int k = 0; k < 400; ++k) {
      const double theta = kPi * i / 399.0, phi = 2.0 * kPi * k / 400.0;
      points.push_back(place.point(radii * glm::dvec3(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi))));
    }
  }
  return points;
}

Affine turned_and_moved(double angle, const glm::dvec3& to) {
  const double c = std::cos(angle), s = std::sin(angle);
  Affine place;
  place.linear = glm::dmat3(c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0);
  place.translation = to;
  return place;
}

Field ellipsoid(const glm::dvec3& radii, const Affine& place) {
  const Field plain = make_shape("ellipsoid", {{"radii", {radii.x, radii.y, radii.z}}});
  const double angle = std::atan2(place.linear[0].y, place.linear[0].x);
  return translate(rotate(plain, {0.0, 0.0, 1.0}, angle), place.translation);
}

TEST(Framing, MeshesByTheirVertices) {
  std::mt19937_64 random(random_seed());
  std::normal_distribution<double> normal;
  for (const CameraSettings& settings : views(random)) {
    Mesh mesh = box_mesh({1.0, 0.3, 0.2});
    for (glm::dvec3& position : mesh.positions) position += glm::dvec3(normal(random), normal(random), normal(random)) * 0.8;
    // A vertex that no face has is not seen.
    mesh.positions.push_back({100.0, 0.0, 0.0});
    Scene scene = scene_of({object_of(mesh)});
    scene.objects[0].world_from_object = turned_and_moved(normal(random), {5.0, -3.0, 2.0});
    std::vector<glm::dvec3> points;
    for (size_t v = 0; v < 8; ++v) points.push_back(scene.objects[0].world_from_object.point(mesh.positions[v]));
    EXPECT_TRUE(is_framed(points, resolve_camera(settings, framed_surface(scene)), kAsked)) << "mesh";
  }
}

TEST(Framing, FieldsAndLevelSetsByTheirSurface) {
  std::mt19937_64 random(random_seed());
  const glm::dvec3 radii(1.0, 0.35, 0.2);
  const Affine place = turned_and_moved(0.7, {2.0, 1.0, -4.0});
  const std::vector<glm::dvec3> points = points_of_ellipsoid(radii, place);
  const Field field = ellipsoid(radii, place);
  Scene scene = scene_of({object_of(field)});
  Scene grid = scene;
  grid.objects[0].source = LevelSetSource{level_set_from_field(field, {.voxel_size = 0.02}), {}};
  for (const CameraSettings& settings : views(random)) {
    EXPECT_TRUE(is_framed(points, resolve_camera(settings, framed_surface(scene)), kAsked)) << "field";
    EXPECT_TRUE(is_framed(points, resolve_camera(settings, framed_surface(grid)), kAsked)) << "level set";
  }
}

TEST(Framing, CagesByTheirLimitSurface) {
  std::mt19937_64 random(random_seed());
  const Mesh cage = box_mesh({1.0, 0.6, 0.4});
  const Scene scene = scene_of({object_of(cage, Scheme::catmark)});
  const Mesh limit = refine(cage, {.scheme = Scheme::catmark, .level = 5});
  for (const CameraSettings& settings : views(random))
    EXPECT_TRUE(is_framed(limit.positions, resolve_camera(settings, framed_surface(scene)), kAsked)) << "cage";
}

TEST(Framing, SeveralObjectsTogetherAndPlanesNotAtAll) {
  std::mt19937_64 random(random_seed());
  const glm::dvec3 radii(0.5, 0.5, 0.5);
  const Affine left = turned_and_moved(0.0, {-2.0, 0.0, 0.0}), right = turned_and_moved(0.0, {2.0, 1.0, 0.5});
  std::vector<glm::dvec3> points = points_of_ellipsoid(radii, left);
  for (const glm::dvec3& point : points_of_ellipsoid(radii, right)) points.push_back(point);
  const Scene scene = scene_of({object_of(ellipsoid(radii, left)), object_of(make_shape("plane", {})), object_of(ellipsoid(radii, right))});
  for (const CameraSettings& settings : views(random))
    EXPECT_TRUE(is_framed(points, resolve_camera(settings, framed_surface(scene)), kAsked)) << "several";
}

TEST(Framing, FarthestPointsLieWithinAThousandthOfTheBounds) {
  std::mt19937_64 random(random_seed());
  std::normal_distribution<double> normal;
  const glm::dvec3 radii(1.0, 0.35, 0.2);
  const Affine place = turned_and_moved(0.7, {2.0, 1.0, -4.0});
  const FramedSurface surface = framed_surface(scene_of({object_of(ellipsoid(radii, place))}));
  for (int i = 0; i < 50; ++i) {
    const glm::dvec3 direction = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
    // The support function of an ellipsoid in closed form.
    const double exact = glm::dot(place.translation, direction) + glm::length(radii * (glm::transpose(place.linear) * direction));
    EXPECT_NEAR(glm::dot(surface.farthest({&direction, 1}).at(0), direction), exact, 1e-3 * surface.bounds.longest_side());
  }
}

TEST(Framing, RollZoomAndMargin) {
  const Mesh mesh = box_mesh({1.0, 0.3, 0.2});
  const FramedSurface surface = framed_surface(scene_of({object_of(mesh)}));
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    const CameraSettings settings = view(400, 300, projection);
    const auto tighter = [&](const FramingSettings& framing) {
      return seen_of(mesh.positions, resolve_camera(settings, surface, framing)).tighter();
    };
    EXPECT_NEAR(tighter({.margin = 0.2}), 0.6, 1e-3);
    EXPECT_NEAR(tighter({.margin = 0.0}), 1.0, 1e-3);
    EXPECT_NEAR(tighter({.zoom = 0.5}), 0.43, 1e-3);
    EXPECT_NEAR(tighter({.roll = 0.4}), 0.86, 1e-3);
    // The picture turns clockwise: what was up leans to the right.
    const Camera rolled = resolve_camera(settings, surface, {.roll = 0.4});
    const glm::dvec3 up = glm::dvec3(0.0, 1.0, 0.0) * rolled.world_from_camera;
    EXPECT_NEAR(std::atan2(up.x, up.y), 0.4, 1e-12);
    for (const FramingSettings& wrong : {FramingSettings{.roll = NAN}, {.zoom = 0.0}, {.margin = 0.5}, {.margin = -0.1}})
      EXPECT_THROW(resolve_camera(settings, surface, wrong), InputError);
  }
}

TEST(Framing, ATurntableHoldsTheObjectInEveryFrame) {
  const Mesh mesh = box_mesh({1.0, 0.3, 0.2});
  const FramedSurface surface = framed_surface(scene_of({object_of(mesh)}));
  constexpr int kFrames = 24;
  const glm::dvec3 center(0.0), up(0.0, 1.0, 0.0);
  const CameraSettings settings = view(320, 240);
  const Camera first = resolve_camera(settings, turned_surface(surface, center, up, kFrames));
  double widest = 0.0;
  for (int frame = 0; frame < kFrames; ++frame) {
    const Camera camera = turned_camera(first, center, up, 2.0 * kPi * frame / kFrames);
    const Seen seen = seen_of(mesh.positions, camera);
    EXPECT_LT(std::max({seen.high.x, seen.high.y, -seen.low.x, -seen.low.y}), 0.8601) << frame;
    widest = std::max(widest, std::max({seen.high.x, seen.high.y, -seen.low.x, -seen.low.y}));
  }
  EXPECT_NEAR(widest, 0.86, 1e-3);
}

TEST(ViewAngles, ComeBackAndMatchWhatIsUp) {
  std::mt19937_64 random(random_seed());
  std::normal_distribution<double> normal;
  for (int i = 0; i < 200; ++i) {
    const glm::dvec3 up(normal(random), normal(random), normal(random));
    const glm::dvec3 direction = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
    EXPECT_LT(glm::distance(direction_at(angles_of(direction, up), up), direction), 1e-12);
  }
  const auto near = [](const glm::dvec3& a, const glm::dvec3& b) { return glm::distance(a, b) < 1e-12; };
  EXPECT_TRUE(near(direction_at({0.0, 0.0}, {0, 1, 0}), {0, 0, 1}));
  EXPECT_TRUE(near(direction_at({kPi / 2, 0.0}, {0, 1, 0}), {1, 0, 0}));
  EXPECT_TRUE(near(direction_at({0.0, 0.0}, {0, 0, 1}), {0, -1, 0}));
  EXPECT_TRUE(near(direction_at({kPi / 2, 0.0}, {0, 0, 1}), {1, 0, 0}));
  EXPECT_TRUE(near(direction_at({0.3, kPi / 2}, {0, 0, 1}), {0, 0, 1}));
}

}  // namespace
}  // namespace limn::test
