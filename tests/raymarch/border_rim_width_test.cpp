// rim_width against closed forms: the width drawn along the contour of quadrics, and where it is undefined.

#include <fmt/core.h>

#include <cmath>

#include "raymarch/border/contour_distance.h"
#include "tests/random_seed.h"
#include "tests/raymarch/scenes.h"

namespace limn::test {
namespace {

const glm::dvec3 kRadii(1.0, 0.7, 0.5);

/// Above 0 where the ray through an image point meets the ellipsoid, 0 on its contour: the discriminant of the quadratic along the ray,
/// itself a quadratic of the image point up to a positive factor.
double discriminant(const Camera& camera, const glm::dvec3& radii, const glm::dvec2& p) {
  CameraRay ray = camera_ray(camera, p.x, p.y);
  const glm::dvec3 o = ray.origin / radii, u = ray.direction / radii;
  const double b = glm::dot(o, u);
  return b * b - glm::dot(u, u) * (glm::dot(o, o) - 1.0);
}

struct ContourPoint {
  glm::dvec2 point_px, inwards;
};

/// The ellipsoid's contour in the image, `count` points, and the image normals there.
std::vector<ContourPoint> contour_of(const Camera& camera, const glm::dvec3& radii, int count) {
  const glm::dvec3 projected = project(camera, glm::dvec3(0.0));
  const glm::dvec2 middle(projected.x, projected.y);
  std::vector<ContourPoint> points;
  for (int k = 0; k < count; ++k) {
    const double angle = 2.0 * 3.14159265358979 * (k + 0.31) / count;
    const glm::dvec2 direction(std::cos(angle), std::sin(angle));
    double inside = 0.0, outside = 4000.0;
    for (int i = 0; i < 70; ++i) {
      const double half = 0.5 * (inside + outside);
      (discriminant(camera, radii, middle + half * direction) > 0.0 ? inside : outside) = half;
    }
    const glm::dvec2 p = middle + inside * direction;
    const double h = 1e-3;
    const glm::dvec2 slope(discriminant(camera, radii, p + glm::dvec2(h, 0)) - discriminant(camera, radii, p - glm::dvec2(h, 0)),
                           discriminant(camera, radii, p + glm::dvec2(0, h)) - discriminant(camera, radii, p - glm::dvec2(0, h)));
    points.push_back({p, glm::normalize(slope)});
  }
  return points;
}

template <class Value>
double bilinear(int width, int height, const glm::dvec2& p, const Value& value) {
  const glm::dvec2 q = p - 0.5, base = glm::floor(q), local = q - base;
  const int x = static_cast<int>(base.x), y = static_cast<int>(base.y);
  if (x < 0 || y < 0 || x + 1 >= width || y + 1 >= height) return std::numeric_limits<double>::quiet_NaN();
  return (1 - local.y) * ((1 - local.x) * value(x, y) + local.x * value(x + 1, y)) +
         local.y * ((1 - local.x) * value(x, y + 1) + local.x * value(x + 1, y + 1));
}

/// How far inside the contour `value` falls through `level`, by steps of 0.01 px from `from` on.
template <class Value>
double walk_in(const GBuffer& seen, const ContourPoint& start, double from, double to, double level, const Value& value) {
  for (double t = from; t < to; t += 0.01) {
    if (bilinear(seen.width, seen.height, start.point_px + t * start.inwards, value) <= level) return t;
  }
  return to;
}

struct Widths {
  double sum = 0.0, squares = 0.0, least = 1e9, greatest = 0.0;
  int count = 0;
  void add(double width, double wanted) {
    sum += width;
    squares += (width - wanted) * (width - wanted);
    least = std::min(least, width);
    greatest = std::max(greatest, width);
    ++count;
  }
  double mean() const { return sum / count; }
  double rms(double wanted) const { return std::sqrt(squares / count) / wanted; }
};

std::map<std::string, ParameterInput> asked(const std::string& estimator, double width, double softness) {
  return {{"estimator", {{}, estimator, {}}}, {"width", {{width}, {}, {}}}, {"softness", {{softness}, {}, {}}}};
}

struct Drawn {
  Scene scene;
  SceneModel model;
  Camera camera;
  GBuffer gbuffer;
  Border border(const std::string& method, const std::map<std::string, ParameterInput>& given) const {
    return find_border_method(method).draw({gbuffer, camera, model, scene}, parameters_of(method, given));
  }
};

Drawn drawn(const Field& field, const SurfaceSettings& surface, const Camera& camera) {
  Drawn result;
  result.scene = scene_of({object_of(field)});
  result.model = build_model(result.scene, surface);
  result.camera = camera;
  result.gbuffer = render_gbuffer(result.model, camera, {});
  return result;
}

/// The drawn width along the contour: the ink fades over 2 px about the width asked for, and is one half just there.
Widths drawn_widths(const Drawn& picture, const std::vector<ContourPoint>& contour, const std::string& estimator, double width) {
  const Border border = picture.border("rim_width", asked(estimator, width, 2.0));
  Widths widths;
  for (const ContourPoint& start : contour) {
    widths.add(walk_in(picture.gbuffer, start, 1.0, 5.0 * width, 0.5, [&](int x, int y) { return double{border.coverage.at(x, y)}; }),
               width);
  }
  return widths;
}

/// The plain rim's widths at the threshold that makes their mean `width`.
Widths plain_widths(const Drawn& picture, const std::vector<ContourPoint>& contour, double width) {
  const auto widths_at = [&](double threshold) {
    Widths widths;
    for (const ContourPoint& start : contour) {
      // Down from the inside: 1 - c^2, linear in the distance, so that a bilinear picture holds it.
      const auto value = [&](int x, int y) {
        return 1.0 - double{picture.gbuffer.n_dot_v.at(x, y)} * double{picture.gbuffer.n_dot_v.at(x, y)};
      };
      widths.add(walk_in(picture.gbuffer, start, 0.7, 12.0 * width, 1.0 - threshold * threshold, value), width);
    }
    return widths;
  };
  double low = 0.01, high = 0.9;
  for (int i = 0; i < 12; ++i) (widths_at(0.5 * (low + high)).mean() < width ? low : high) = 0.5 * (low + high);
  return widths_at(0.5 * (low + high));
}

Camera camera_towards(const glm::dvec3& direction, const glm::dvec3& target, double distance, Projection projection) {
  CameraSettings settings = view(620, 620, projection);
  settings.eye = target + distance * direction;
  settings.target = target;
  settings.up = std::abs(direction.y) > 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  settings.vertical_fov = 2.0 * std::atan(0.5 * 620 / 1000.0);
  if (projection == Projection::orthographic) settings.ortho_height = 620.0 / 250.0;
  return resolve_camera(settings, {});
}

class OnTheEllipsoid : public testing::TestWithParam<Projection> {};

TEST_P(OnTheEllipsoid, ThreePixelsAreThreePixelsAllAround) {
  const unsigned seed = random_seed();
  fmt::print("seed {}\n", seed);
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const Field field = make_shape("ellipsoid", {{"radii", {kRadii.x, kRadii.y, kRadii.z}}});
  double worst_ratio = 0.0;
  for (int index = 0; index < 5; ++index) {
    const glm::dvec3 direction =
        index == 0 ? glm::normalize(glm::dvec3(1.9, 2.3, 2.9)) : glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
    const glm::dvec3 target = index % 2 ? glm::dvec3(0.1, -0.05, 0.1) : glm::dvec3(0.0);
    const Drawn picture = drawn(field, surface_kind("analytic"), camera_towards(direction, target, 4.0, GetParam()));
    const std::vector<ContourPoint> contour = contour_of(picture.camera, kRadii, 360);
    const Widths screen = drawn_widths(picture, contour, "screen", 3.0), curvature = drawn_widths(picture, contour, "curvature", 3.0);
    const Widths plain = plain_widths(picture, contour, 3.0);
    fmt::print("screen {:.3f} px, {:.2f} % rms, {:.2f} to {:.2f}; curvature {:.3f} px, {:.2f} % rms, {:.2f} to {:.2f}; rim {:.2f} : 1\n",
               screen.mean(), 100 * screen.rms(3), screen.least, screen.greatest, curvature.mean(), 100 * curvature.rms(3), curvature.least,
               curvature.greatest, plain.greatest / plain.least);
    EXPECT_LT(screen.rms(3.0), 0.08);
    EXPECT_LT(curvature.rms(3.0), 0.12);
    EXPECT_LT(screen.greatest / screen.least, 1.25);
    worst_ratio = std::max(worst_ratio, plain.greatest / plain.least);
    // Seen along y, as an orthographic camera sees them, the ellipse's ends differ by 2 : 1; a near eye sees more.
    if (index == 0) {
      EXPECT_GT(plain.greatest / plain.least, GetParam() == Projection::perspective ? 2.0 : 1.8);
    }
  }
  fmt::print("rim tuned to a mean of 3 px varies up to {:.2f} : 1\n", worst_ratio);
}

INSTANTIATE_TEST_SUITE_P(RimWidth, OnTheEllipsoid, testing::Values(Projection::perspective, Projection::orthographic),
                         [](const auto& p) { return p.param == Projection::perspective ? "perspective" : "orthographic"; });

/// The area of hard ink is the contour's length times the width, less that of the turn: pi w^2 for a closed convex curve.
TEST(RimWidth, HardInkHasTheAreaOfItsWidth) {
  const Field field = make_shape("ellipsoid", {{"radii", {kRadii.x, kRadii.y, kRadii.z}}});
  const Drawn picture =
      drawn(field, surface_kind("analytic"), camera_towards(glm::normalize(glm::dvec3(1.9, 2.3, 2.9)), {}, 4.0, Projection::perspective));
  const std::vector<ContourPoint> contour = contour_of(picture.camera, kRadii, 2000);
  double length = 0.0;
  for (size_t i = 0; i < contour.size(); ++i) length += glm::length(contour[i].point_px - contour[(i + 1) % contour.size()].point_px);
  for (const std::string estimator : {"screen", "curvature"}) {
    for (const double width : {1.0, 3.0, 10.0}) {
      const Border border = picture.border("rim_width", asked(estimator, width, 0.0));
      double area = 0.0;
      for (const float ink : border.coverage.pixels) area += double{ink};
      const double mean = area / (length - 3.14159265358979 * width);
      fmt::print("{} {} px: {:.3f} px by area\n", estimator, width, mean);
      EXPECT_NEAR(mean, width, 0.03 * width + 0.03) << estimator;
    }
  }
}

/// On a sphere the distance of every pixel to the contour is known, on and off the axis.
TEST(RimWidth, CircleIsExactOnSpheresInBothProjections) {
  const double radius = 0.8;
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    const Camera camera = camera_towards(glm::normalize(glm::dvec3(1, 2, 3)), {0.4, 0.1, 0.2}, 4.0, projection);
    const glm::dvec3 middle = project(camera, glm::dvec3(0.0));
    Errors errors;
    for (int k = 0; k < 200; ++k) {
      // A sphere's perspective image is an ellipse; along its long axis the contour nearest to a pixel is the one straight outwards.
      const glm::dvec2 off = glm::normalize(glm::dvec2(middle.x, middle.y) - glm::dvec2(310.0));
      const glm::dvec2 along = k % 2 ? off : -off;
      const auto inside_at = [&](double t) { return discriminant(camera, glm::dvec3(radius), glm::dvec2(middle) + t * along) > 0.0; };
      double low = 0.0, high = 3000.0;
      for (int i = 0; i < 70; ++i) (inside_at(0.5 * (low + high)) ? low : high) = 0.5 * (low + high);
      const double back = 0.05 + 0.2 * k;
      const glm::dvec2 p = glm::dvec2(middle) + (low - back) * along;
      const CameraRay ray = camera_ray(camera, p.x, p.y);
      const double b = glm::dot(ray.origin, ray.direction);
      const double t = -b - std::sqrt(b * b - glm::dot(ray.origin, ray.origin) + radius * radius);
      const glm::dvec3 hit = ray.origin + t * ray.direction;
      const SeenPoint seen = seen_point(camera, p.x, p.y, project(camera, hit).z, hit / radius);
      errors.add(std::abs(circle_contour(camera, seen, 1.0 / radius).distance_px - back));
    }
    fmt::print("sphere: {:.2g} px at most\n", errors.largest);
    EXPECT_LT(errors.largest, 1e-6);
  }
}

TEST(RimWidth, OfASphereIsARingOfItsWidth) {
  for (const std::string estimator : {"screen", "curvature"}) {
    for (const std::string kind : {"analytic", "level_set", "mesh"}) {
      SurfaceSettings surface = surface_kind(kind);
      surface.voxels = 64;
      surface.gradient = "cubic";
      surface.level = 3;
      const glm::dvec3 direction = glm::normalize(glm::dvec3(1.9, 2.3, 2.9));
      const Drawn picture =
          drawn(make_shape("sphere", {{"radius", {0.8}}}), surface, camera_towards(direction, {}, 4.0, Projection::perspective));
      const Widths widths = drawn_widths(picture, contour_of(picture.camera, glm::dvec3(0.8), 360), estimator, 3.0);
      fmt::print("{} {}: {:.3f} px, {:.2f} % rms, {:.2f} to {:.2f}\n", kind, estimator, widths.mean(), 100 * widths.rms(3), widths.least,
                 widths.greatest);
      EXPECT_LT(widths.rms(3.0), kind == "analytic" ? 0.01 : 0.08) << kind << ' ' << estimator;
    }
  }
}

/// Seen across its axis a cylinder has straight contours; both are as wide.
TEST(RimWidth, OfACylinderRunsAlongItsSides) {
  CameraSettings settings = view(300, 300, Projection::orthographic);
  settings.eye = glm::dvec3(0, 0, 6);
  settings.target = glm::dvec3(0.0);
  settings.ortho_height = 3.0;
  const Drawn picture =
      drawn(make_shape("cylinder", {{"radius", {0.8}}, {"half_height", {2.0}}}), surface_kind("analytic"), resolve_camera(settings, {}));
  for (const std::string estimator : {"screen", "curvature"}) {
    const Border border = picture.border("rim_width", asked(estimator, 5.0, 0.0));
    for (int x = 60; x < 240; ++x) {
      // Contour at 150 +- 80: pixel centres within 5 px of it are ink.
      const double inside = 80.0 - std::abs(x + 0.5 - 150.0);
      const bool ink = inside > 0.0 && inside <= 5.0;
      if (std::abs(inside - 5.0) > 0.3) {
        EXPECT_EQ(border.coverage.at(x, 150) > 0.5f, ink) << estimator << ' ' << x;
      }
    }
  }
}

std::int64_t count(const Border& border, std::uint8_t status) {
  return std::count(border.status.pixels.begin(), border.status.pixels.end(), status);
}

TEST(RimWidth, IsUndefinedOnPlanesAndSaysSo) {
  const Drawn picture = drawn(make_shape("box", {{"half", {0.6, 0.6, 0.6}}}), surface_kind("analytic"),
                              camera_towards(glm::normalize(glm::dvec3(1, 2, 3)), {}, 4.0, Projection::perspective));
  for (const std::string estimator : {"screen", "curvature"}) {
    const Border border = picture.border("rim_width", asked(estimator, 3.0, 0.0));
    const auto hits = static_cast<double>(count_hits(picture.gbuffer).hits);
    const double share = static_cast<double>(count(border, 1)) / hits;
    // Differences across the edges are no curvature of the faces.
    EXPECT_GT(share, estimator == "curvature" ? 0.999 : 0.97);
    ASSERT_FALSE(border.notes.empty());
    fmt::print("{}: {}\n", estimator, border.notes[0]);
    EXPECT_NE(border.notes[0].find("radial curvature is not above 0"), std::string::npos);
    if (estimator == "curvature") {
      for (const float ink : border.coverage.pixels) ASSERT_EQ(ink, 0.0f);
    }
  }
}

/// The inner half of a torus is a saddle: seen obliquely its radial curvature is negative where (closed form) the normal curvature along
/// the view is.
TEST(RimWidth, StatusFollowsTheSignOfTheRadialCurvatureOnATorus) {
  const double major = 0.8, minor = 0.3;
  const Drawn picture = drawn(make_shape("torus", {{"major", {major}}, {"minor", {minor}}}), surface_kind("analytic"),
                              camera_towards(glm::normalize(glm::dvec3(1, 2, 1.5)), {}, 4.0, Projection::perspective));
  for (const std::string estimator : {"screen", "curvature"}) {
    const Border border = picture.border("rim_width", asked(estimator, 3.0, 0.0));
    std::int64_t negative = 0, wrong = 0;
    for (int y = 0; y < picture.gbuffer.height; ++y) {
      for (int x = 0; x < picture.gbuffer.width; ++x) {
        if (picture.gbuffer.id.at(x, y) == 0) continue;
        const glm::dvec3 p(picture.gbuffer.position.at(x, y)), v = view_vector(picture.camera, p);
        const double ring = std::hypot(p.x, p.z);
        const glm::dvec3 out(p.x / ring, 0.0, p.z / ring), around(-out.z, 0.0, out.x);
        const glm::dvec3 n = (p - major * out) / minor, tube = glm::cross(n, around);
        // Principal curvatures 1 / minor along the tube's circle, (n . out) / ring around the axis.
        const double kr = (std::pow(glm::dot(v, tube), 2) / minor + std::pow(glm::dot(v, around), 2) * glm::dot(n, out) / ring) /
                          (1.0 - std::pow(glm::dot(n, v), 2));
        if (std::abs(kr) < 0.15 || glm::dot(n, v) > 0.98 || glm::dot(n, v) < 0.1) continue;
        negative += kr < 0.0;
        wrong += (border.status.at(x, y) == 1) != (kr < 0.0);
      }
    }
    fmt::print("{}: {} pixels with kr < 0, {} told wrongly\n", estimator, negative, wrong);
    EXPECT_GT(negative, 100);
    EXPECT_LE(wrong, estimator == "curvature" ? 0 : negative / 50);
  }
}

TEST(RimWidth, WiderThanTheRadiusIsClampedAndReported) {
  const Drawn picture = drawn(make_shape("sphere", {{"radius", {0.04}}}), surface_kind("analytic"),
                              camera_towards(glm::normalize(glm::dvec3(1, 2, 3)), {}, 4.0, Projection::perspective));
  // 10 px of radius.
  const Border border = picture.border("rim_width", asked("curvature", 12.0, 0.0));
  EXPECT_EQ(count(border, 2), count_hits(picture.gbuffer).hits);
  for (size_t i = 0; i < border.coverage.size(); ++i) EXPECT_EQ(border.coverage.pixels[i], picture.gbuffer.id.pixels[i] ? 1.0f : 0.0f);
  ASSERT_EQ(border.notes.size(), 1u);
  EXPECT_NE(border.notes[0].find("12 px are more than the radius"), std::string::npos) << border.notes[0];
  EXPECT_EQ(count(picture.border("rim_width", asked("curvature", 8.0, 0.0)), 2), 0);
}

TEST(RimWidth, WithoutACurvatureSourceUsesTheScreenAndSaysWhy) {
  SurfaceSettings thin = surface_kind("level_set");
  thin.voxels = 64;
  const Drawn picture =
      drawn(make_shape("sphere"), thin, camera_towards(glm::normalize(glm::dvec3(1, 2, 3)), {}, 6.0, Projection::perspective));
  const Border border = picture.border("rim_width", asked("curvature", 3.0, 0.0)),
               screen = picture.border("rim_width", asked("screen", 3.0, 0.0));
  EXPECT_EQ(border.coverage.pixels, screen.coverage.pixels);
  EXPECT_EQ(count(border, 3), count_hits(picture.gbuffer).hits);
  ASSERT_EQ(border.notes.size(), 2u);
  EXPECT_NE(border.notes[1].find("too thin"), std::string::npos) << border.notes[1];
  EXPECT_TRUE(screen.notes.empty()) << screen.notes[0];
}

/// A crease that both sides show is not a contour, however sharply the normals turn there; the silhouette beside it is.
TEST(RimWidth, DrawsNoBorderAtACreaseBetweenFacesThatShow) {
  // The top edge of a cylinder, seen from above: its caps' rim lies between two visible sides in front, and on the silhouette behind.
  CameraSettings settings = view(400, 400);
  settings.eye = glm::dvec3(0, 3, 5);
  settings.target = glm::dvec3(0.0);
  const Field field = make_shape("cylinder", {{"radius", {0.8}}, {"half_height", {0.6}}});
  const Drawn picture = drawn(field, surface_kind("analytic"), framing(scene_of({object_of(field)}), settings));
  const glm::dvec3 front = project(picture.camera, {0.0, 0.6, 0.8}), side = project(picture.camera, {0.8, 0.0, 0.0});
  for (const std::string estimator : {"screen", "curvature"}) {
    const Border border = picture.border("rim_width", asked(estimator, 3.0, 0.0));
    int at_crease = 0, at_side = 0;
    for (int k = -8; k <= 8; ++k) {
      at_crease += border.coverage.at(static_cast<int>(front.x), static_cast<int>(front.y) + k) > 0.0f;
      at_side += border.coverage.at(static_cast<int>(side.x) + k, static_cast<int>(side.y)) > 0.0f;
    }
    EXPECT_EQ(at_crease, 0) << estimator;
    EXPECT_GE(at_side, 2) << estimator;
  }
}

TEST(RimWidth, IsFiniteAndTheSameForAnyThreadsOnEveryShapeAndSurface) {
  for (const ShapeDescriptor& shape : shapes()) {
    const Field field = make_shape(shape.about.name);
    const bool bounded = field.traits().bounds.finite();
    for (const std::string kind : {"analytic", "level_set", "mesh"}) {
      if (kind != "analytic" && !bounded) continue;
      SurfaceSettings surface = surface_kind(kind);
      surface.voxels = 40;
      surface.level = 1;
      surface.half_width_voxels = 4.2;
      const Scene scene = scene_of({object_of(field)});
      const SceneModel model = build_model(scene, surface);
      const Camera camera = framing(scene, view(90, 70));
      for (const std::string estimator : {"screen", "curvature"}) {
        const PictureSettings settings{{call_of("rim_width", asked(estimator, 3.0, 1.0))}, 2, {}};
        const Picture one = draw_picture(scene, model, camera, settings, {1, 16, {}, {}});
        const Picture many = draw_picture(scene, model, camera, settings, {3, 7, {}, {}});
        ASSERT_EQ(one.border.pixels, many.border.pixels) << shape.about.name << ' ' << kind;
        ASSERT_EQ(one.notes, many.notes) << shape.about.name << ' ' << kind;
        for (const float ink : one.border.pixels) ASSERT_TRUE(ink >= 0.0f && ink <= 1.0f) << shape.about.name << ' ' << kind;
      }
    }
  }
}

}  // namespace
}  // namespace limn::test
