// The measured border against closed forms, in its worst place.

#include "raymarch/measured_border.h"

#include <fmt/core.h>

#include <map>
#include <numbers>

#include "raymarch/curve_geometry.h"
#include "raymarch/measured_border/crossings.h"
#include "tests/raymarch/scenes.h"

namespace limn::test {
namespace {

constexpr double kThreshold = 0.4;

Camera camera_at(const glm::dvec3& eye, Projection projection, double height, int width = 200) {
  CameraSettings settings = view(width, width * 3 / 4, projection);
  settings.eye = eye;
  settings.target = glm::dvec3(0.013, -0.021, 0.007);
  if (projection == Projection::orthographic) settings.ortho_height = height;
  return resolve_camera(settings, {});
}

BorderCurves measured(const SceneModel& model, const Camera& camera, double threshold = kThreshold, const ExecutionSettings& how = {}) {
  return measure_border(model, camera, render_gbuffer(model, camera, how), {threshold, 0.002}, how);
}

[[maybe_unused]]
std::map<std::pair<int, CurveKind>, int> counts(const BorderCurves& curves) {
  std::map<std::pair<int, CurveKind>, int> result;
  for (const BorderCurve& curve : curves.curves) ++result[{curve.object, curve.kind}];
  return result;
}

[[maybe_unused]] double total_length(const BorderCurves& curves, CurveKind kind) {
  double length = 0.0;
  for (const BorderCurve& curve : curves.curves) length += curve.kind == kind ? length_px(curve) : 0.0;
  return length;
}

/// Twice the area to the left of a closed curve as seen on the screen: positive where the curve runs about what it bounds.
double left_area(const BorderCurve& curve) {
  double area = 0.0;
  for (size_t i = 0; i < curve.points.size(); ++i) {
    const glm::dvec2 a = curve.points[i].px, b = curve.points[(i + 1) % curve.points.size()].px;
    area -= a.x * b.y - a.y * b.x;
  }
  return area;
}

TEST(MeasuredBorder, OfASphereSeenInParallelIsTwoCirclesOfKnownRadius) {
  const SceneModel model = model_of(scene_of({object_of(make_shape("sphere", {{"radius", {1.0}}}))}));
  const Camera camera = camera_at({1.9, 2.3, 2.9}, Projection::orthographic, 2.4);
  const glm::dvec2 centre(project(camera, glm::dvec3(0.0)));
  const BorderCurves curves = measured(model, camera);
  ASSERT_EQ(curves.curves.size(), 2u);
  Errors errors[2];
  for (const BorderCurve& curve : curves.curves) {
    const bool inner = curve.kind == CurveKind::inner;
    EXPECT_TRUE(curve.closed);
    EXPECT_EQ(curve.object, 1);
    const double radius = camera.pixels_per_unit * (inner ? std::sqrt(1.0 - kThreshold * kThreshold) : 1.0);
    for (const BorderPoint& point : curve.points) errors[inner].add(std::abs(glm::length(point.px - centre) - radius));
    // The ink lies about the inner curve, the object within the silhouette.
    EXPECT_NEAR(left_area(curve) / (2.0 * std::numbers::pi * radius * radius), inner ? -1.0 : 1.0, 1e-3);
  }
  fmt::print("sphere: silhouette worst {:.5f} px, inner worst {:.5f} px\n", errors[0].largest, errors[1].largest);
  EXPECT_GT(errors[0].count, 400);
  EXPECT_LT(errors[0].largest, 0.005);
  EXPECT_LT(errors[1].largest, 0.005);
}

}  // namespace
}  // namespace limn::test
