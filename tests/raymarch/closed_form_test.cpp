// Sphere, ellipsoid and torus against their closed forms: where rays hit, the normals there, and where rim's border runs.

#include <fmt/core.h>

#include <numbers>

#include "tests/raymarch/scenes.h"

namespace limn::test {
namespace {

/// A surface known by its Gauss map: the points whose outward normal is `n`, one for each sheet. Written from the textbook, not from
/// the program's fields.
struct ClosedForm {
  std::string name;
  Field field;
  double radius;  ///< Bounding.
  int sheets;
  glm::dvec3 (*point)(const glm::dvec3& n, int sheet);
  glm::dvec3 (*normal)(const glm::dvec3& p);  ///< Outward, not unit.
  double (*implicit)(const glm::dvec3& p);    ///< A polynomial that is negative inside.
};

constexpr double kMajor = 1.0, kMinor = 0.35;
const glm::dvec3 kRadii(1.0, 0.7, 0.5);

std::vector<ClosedForm> closed_forms() {
  return {
      {"sphere", make_shape("sphere", {{"radius", {1.0}}}), 1.0, 1, [](const glm::dvec3& n, int) { return n; },
       [](const glm::dvec3& p) { return p; }, [](const glm::dvec3& p) { return glm::dot(p, p) - 1.0; }},
      {"ellipsoid", make_shape("ellipsoid", {{"radii", {kRadii.x, kRadii.y, kRadii.z}}}), 1.0, 1,
       [](const glm::dvec3& n, int) { return kRadii * kRadii * n / glm::length(kRadii * n); },
       [](const glm::dvec3& p) { return p / (kRadii * kRadii); },
       [](const glm::dvec3& p) { return glm::dot(p / kRadii, p / kRadii) - 1.0; }},
      {"torus", make_shape("torus", {{"major", {kMajor}}, {"minor", {kMinor}}}), kMajor + kMinor, 2,
       [](const glm::dvec3& n, int sheet) {
         const glm::dvec3 ring = glm::normalize(glm::dvec3(n.x, 0.0, n.z));
         return (sheet == 0 ? kMajor : -kMajor) * ring + kMinor * n;
       },
       [](const glm::dvec3& p) { return p - kMajor * glm::normalize(glm::dvec3(p.x, 0.0, p.z)); },
       [](const glm::dvec3& p) {
         const double k = glm::dot(p, p) + kMajor * kMajor - kMinor * kMinor;
         return k * k - 4.0 * kMajor * kMajor * (p.x * p.x + p.z * p.z);
       }},
  };
}

Camera test_camera(const ClosedForm& form, Projection projection, int width, int height) {
  CameraSettings settings = view(width, height, projection);
  settings.eye = glm::dvec3(1.9, 2.3, 2.9);
  settings.target = glm::dvec3(0.03, -0.02, 0.01);
  if (projection == Projection::orthographic) settings.ortho_height = 2.4 * form.radius;
  return framing(scene_of({object_of(form.field)}), settings);
}

/// First root of the polynomial along the ray by 4000 equal steps and bisection; infinity where there is none.
double first_root(const ClosedForm& form, const CameraRay& ray) {
  const double start = std::max(0.0, -glm::dot(ray.origin, ray.direction) - 1.2 * form.radius), step = 2.4 * form.radius / 4000;
  const auto f = [&](double t) { return form.implicit(ray.origin + t * ray.direction); };
  for (int i = 0; i < 4000; ++i) {
    double a = start + i * step, b = a + step;
    if (f(b) > 0.0) continue;
    for (int k = 0; k < 60; ++k) (f(0.5 * (a + b)) > 0.0 ? a : b) = 0.5 * (a + b);
    return 0.5 * (a + b);
  }
  return std::numeric_limits<double>::infinity();
}

class ClosedFormTest : public testing::TestWithParam<Projection> {};

TEST_P(ClosedFormTest, HitsLieWithin1e5OfTheRadiusAndNormalsWithinAHundredthOfADegree) {
  for (const ClosedForm& form : closed_forms()) {
    const Camera camera = test_camera(form, GetParam(), 160, 120);
    const SceneModel model = model_of(scene_of({object_of(form.field)}));
    std::vector<glm::dvec2> points;
    for (int y = 0; y < camera.height_px; ++y) {
      for (int x = 0; x < camera.width_px; ++x) points.emplace_back(x + 0.5, y + 0.5);
    }
    std::vector<PointSample> samples(points.size());
    sample_points(model, camera, points, samples);
    Errors position, normal;
    for (size_t i = 0; i < points.size(); ++i) {
      const CameraRay ray = camera_ray(camera, points[i].x, points[i].y);
      const double t = first_root(form, ray);
      ASSERT_EQ(samples[i].status == HitStatus::hit, std::isfinite(t)) << form.name << " at " << points[i].x << "," << points[i].y;
      if (!std::isfinite(t)) continue;
      const glm::dvec3 truth = ray.origin + t * ray.direction;
      position.add(glm::length(samples[i].position - truth) / form.radius);
      normal.add(glm::degrees(angle_between(glm::dvec3(samples[i].normal), form.normal(truth))));
    }
    fmt::print("{}: position / radius mean {:.2e} worst {:.2e}; normal mean {:.2e} worst {:.2e} deg; {} hits\n", form.name, position.mean(),
               position.largest, normal.mean(), normal.largest, position.count);
    EXPECT_GT(position.count, 3000) << form.name;
    EXPECT_LT(position.largest, 1e-5) << form.name;
    EXPECT_LT(normal.largest, 0.01) << form.name;
  }
}

/// Points of the border N.V = c: on each meridian of normals about the view, every sign change of N.V - c.
std::vector<glm::dvec3> border_points(const ClosedForm& form, const Camera& camera, double c) {
  std::vector<glm::dvec3> points;
  const glm::dvec3 axis = glm::normalize(camera.world_from_camera[2]), u = camera.world_from_camera[0], v = camera.world_from_camera[1];
  for (int meridian = 0; meridian < 180; ++meridian) {
    const double phi = (meridian + 0.37) * 2.0 * std::numbers::pi / 180;
    const glm::dvec3 side = std::cos(phi) * u + std::sin(phi) * v;
    for (int sheet = 0; sheet < form.sheets; ++sheet) {
      const auto point = [&](double psi) { return form.point(std::cos(psi) * axis + std::sin(psi) * side, sheet); };
      const auto excess = [&](double psi) {
        const glm::dvec3 n = std::cos(psi) * axis + std::sin(psi) * side;
        return glm::dot(n, view_vector(camera, point(psi))) - c;
      };
      for (int i = 0; i < 90; ++i) {
        double a = i * std::numbers::pi / 90, b = a + std::numbers::pi / 90;
        if ((excess(a) > 0.0) == (excess(b) > 0.0)) continue;
        const bool positive = excess(a) > 0.0;
        for (int k = 0; k < 60; ++k) ((excess(0.5 * (a + b)) > 0.0) == positive ? a : b) = 0.5 * (a + b);
        points.push_back(point(0.5 * (a + b)));
      }
    }
  }
  return points;
}

TEST_P(ClosedFormTest, TheBorderOfRimRunsWithinAHundredthOfAPixelOfTheClosedForm) {
  for (const ClosedForm& form : closed_forms()) {
    for (const double c : {0.4, 0.15, 0.8}) {
      const Camera camera = test_camera(form, GetParam(), 1280, 960);
      const SceneModel model = model_of(scene_of({object_of(form.field)}));
      const std::vector<glm::dvec3> truth = border_points(form, camera, c);
      // The point itself and four about it, for the gradient of N.V in the picture.
      constexpr double reach = 0.05;
      std::vector<glm::dvec2> points;
      for (const glm::dvec3& p : truth) {
        const glm::dvec2 q(project(camera, p));
        for (const glm::dvec2 d : {glm::dvec2(0, 0), {-reach, 0}, {reach, 0}, {0, -reach}, {0, reach}}) points.push_back(q + d);
      }
      std::vector<PointSample> samples(points.size());
      sample_points(model, camera, points, samples);
      Errors error;
      for (size_t i = 0; i < truth.size(); ++i) {
        const PointSample* s = &samples[5 * i];
        const bool all_hit = std::all_of(s, s + 5, [](const PointSample& sample) { return sample.status == HitStatus::hit; });
        ASSERT_EQ(s[0].status, HitStatus::hit) << form.name;
        const double nearer = project(camera, truth[i]).z - project(camera, s[0].position).z;
        if (nearer > 1e-3) continue;  // another part of the surface stands before it
        ASSERT_GT(nearer, -1e-4) << form.name << ": the border point itself was missed";
        if (!all_hit) continue;
        const glm::dvec2 gradient((double{s[2].n_dot_v} - double{s[1].n_dot_v}) / (2 * reach),
                                  (double{s[4].n_dot_v} - double{s[3].n_dot_v}) / (2 * reach));
        error.add(std::abs(double{s[0].n_dot_v} - c) / glm::length(gradient));
      }
      fmt::print("{} c={}: border error mean {:.2e} worst {:.2e} px at {} points\n", form.name, c, error.mean(), error.largest,
                 error.count);
      EXPECT_GE(error.count, 150) << form.name;
      EXPECT_LT(error.largest, 0.01) << form.name << " c = " << c;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Cameras, ClosedFormTest, testing::Values(Projection::orthographic, Projection::perspective),
                         [](const auto& projection) {
                           return projection.param == Projection::orthographic ? std::string("orthographic") : std::string("perspective");
                         });

TEST(ClosedForm, TheBorderOfASphereIsTheCircleOfTheory) {
  // Orthographic: radius R sqrt(1 - c^2). Perspective at distance D: sin(theta) = (R / D) sqrt(1 - c^2).
  const double c = 0.4, distance = 4.0;
  for (const Projection projection : {Projection::orthographic, Projection::perspective}) {
    CameraSettings settings = view(801, 801, projection);
    settings.eye = glm::dvec3(0, 0, distance);
    settings.target = glm::dvec3(0.0);
    if (projection == Projection::orthographic) settings.ortho_height = 2.2;
    const Scene scene = scene_of({object_of(make_shape("sphere", {{"radius", {1.0}}}))});
    const Camera camera = framing(scene, settings);
    const SceneModel model = model_of(scene);
    const double sine = std::sqrt(1.0 - c * c) / distance;
    const double truth = projection == Projection::orthographic ? camera.pixels_per_unit * std::sqrt(1.0 - c * c)
                                                                : camera.focal_px * sine / std::sqrt(1.0 - sine * sine);
    for (int i = 0; i < 24; ++i) {
      const double phi = i * 2.0 * std::numbers::pi / 24;
      double inner = 0.0, outer = truth + 20.0;
      for (int k = 0; k < 30; ++k) {
        const double middle = 0.5 * (inner + outer);
        const glm::dvec2 point(400.5 + middle * std::cos(phi), 400.5 + middle * std::sin(phi));
        PointSample sample;
        sample_points(model, camera, {&point, 1}, {&sample, 1});
        (sample.status == HitStatus::hit && double{sample.n_dot_v} >= c ? inner : outer) = middle;
      }
      EXPECT_NEAR(inner, truth, 0.01);
    }
  }
}

}  // namespace
}  // namespace limn::test
