// The measured border against closed forms, in its worst place.

#include "raymarch/measured_border.h"

#include <fmt/core.h>

#include <map>
#include <numbers>

#include "raymarch/curves/curve_geometry.h"
#include "raymarch/measured_border/crossings.h"
#include "tests/random_seed.h"
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

std::map<std::pair<int, CurveKind>, int> counts(const BorderCurves& curves) {
  std::map<std::pair<int, CurveKind>, int> result;
  for (const BorderCurve& curve : curves.curves) ++result[{curve.object, curve.kind}];
  return result;
}

double total_length(const BorderCurves& curves, CurveKind kind) {
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

/// The image of the circle of normals N.v = c of an ellipsoid seen in parallel: p = A^-1 N / sqrt(N' A^-1 N).
BorderCurve ellipsoid_curve(const Camera& camera, const glm::dvec3& radii, double c) {
  const glm::dvec3 v = camera.world_from_camera[2], a = camera.world_from_camera[0], b = camera.world_from_camera[1];
  BorderCurve curve{CurveKind::inner, 1, true, {}};
  for (int i = 0; i < 20000; ++i) {
    const double angle = i * 2.0 * std::numbers::pi / 20000;
    const glm::dvec3 n = c * v + std::sqrt(1.0 - c * c) * (std::cos(angle) * a + std::sin(angle) * b);
    BorderPoint point;
    point.px = glm::dvec2(project(camera, radii * radii * n / glm::length(radii * n)));
    curve.points.push_back(point);
  }
  return curve;
}

/// Largest distance of the points of `curves` of `kind` from `form`.
double worst_distance(const BorderCurves& curves, CurveKind kind, const BorderCurves& form) {
  const CurveIndex index(form, std::nullopt);
  double worst = 0.0;
  for (const BorderCurve& curve : curves.curves) {
    if (curve.kind != kind) continue;
    for (const BorderPoint& point : curve.points) worst = std::max(worst, index.nearest(point.px, 0, 1e9)->distance_px);
  }
  return worst;
}

TEST(MeasuredBorder, OfAnEllipsoidLiesOnTheImagesOfItsCirclesOfNormals) {
  const glm::dvec3 radii(1.0, 0.7, 0.5);
  const SceneModel model = model_of(scene_of({object_of(make_shape("ellipsoid", {{"radii", {radii.x, radii.y, radii.z}}}))}));
  for (const double c : {0.15, 0.4, 0.7}) {
    const Camera camera = camera_at({1.1, -2.3, 1.9}, Projection::orthographic, 2.4);
    const BorderCurves curves = measured(model, camera, c);
    const BorderCurves silhouette{{ellipsoid_curve(camera, radii, 0.0)}}, inner{{ellipsoid_curve(camera, radii, c)}};
    const double outside = worst_distance(curves, CurveKind::silhouette, silhouette),
                 within = worst_distance(curves, CurveKind::inner, inner);
    fmt::print("ellipsoid, threshold {}: silhouette worst {:.5f} px, inner worst {:.5f} px\n", c, outside, within);
    EXPECT_EQ(curves.curves.size(), 2u);
    EXPECT_LT(outside, 0.005);
    EXPECT_LT(within, 0.005);
    // Whole curves, but for what chords cut off.
    EXPECT_NEAR(total_length(curves, CurveKind::silhouette), length_px(silhouette.curves[0]), 0.2);
    EXPECT_NEAR(total_length(curves, CurveKind::inner), length_px(inner.curves[0]), 0.2);
  }
}

TEST(MeasuredBorder, OfATorusLiesOnTheImagesOfItsCirclesOfNormals) {
  constexpr double major = 1.0, minor = 0.3;
  const SceneModel model = model_of(scene_of({object_of(make_shape("torus", {{"major", {major}}, {"minor", {minor}}}))}));
  // From above all of it is visible; from lower down the far side of the hole hides parts.
  for (const glm::dvec3 eye : {glm::dvec3(0.6, 3.0, 0.8), glm::dvec3(0.4, 1.0, 2.7)}) {
    const Camera camera = camera_at(eye, Projection::orthographic, 2.9);
    const glm::dvec3 v = camera.world_from_camera[2], a = camera.world_from_camera[0], b = camera.world_from_camera[1];
    BorderCurves forms[2];
    for (const bool inner : {false, true}) {
      const double c = inner ? kThreshold : 0.0;
      for (const double sheet : {-1.0, 1.0}) {
        BorderCurve curve{CurveKind::inner, 1, true, {}};
        for (int i = 0; i < 20000; ++i) {
          const double angle = i * 2.0 * std::numbers::pi / 20000;
          const glm::dvec3 n = c * v + std::sqrt(1.0 - c * c) * (std::cos(angle) * a + std::sin(angle) * b);
          BorderPoint point;
          point.px = glm::dvec2(project(camera, sheet * major * glm::normalize(glm::dvec3(n.x, 0.0, n.z)) + minor * n));
          curve.points.push_back(point);
        }
        forms[inner].curves.push_back(curve);
      }
    }
    const BorderCurves curves = measured(model, camera);
    const double outside = worst_distance(curves, CurveKind::silhouette, forms[0]),
                 within = worst_distance(curves, CurveKind::inner, forms[1]);
    fmt::print("torus: silhouette worst {:.5f} px, inner worst {:.5f} px, {} curves\n", outside, within, curves.curves.size());
    EXPECT_LT(outside, 0.005);
    EXPECT_LT(within, 0.005);
    EXPECT_GT(total_length(curves, CurveKind::silhouette), 0.7 * (length_px(forms[0].curves[0]) + length_px(forms[0].curves[1])));
  }
}

TEST(MeasuredBorder, OfASphereInPerspectiveStandsAtItsAngles) {
  const SceneModel model = model_of(scene_of({object_of(make_shape("sphere", {{"radius", {1.0}}}))}));
  const Camera camera = camera_at({2.1, 2.2, 2.9}, Projection::perspective, 0.0);
  const double distance = glm::length(camera.eye);
  double worst = 0.0;
  for (const BorderCurve& curve : measured(model, camera).curves) {
    const double sine = (curve.kind == CurveKind::inner ? std::sqrt(1.0 - kThreshold * kThreshold) : 1.0) / distance;
    for (const BorderPoint& point : curve.points) {
      const glm::dvec3 ray = camera_ray(camera, point.px.x, point.px.y).direction;
      const double angle = std::atan2(glm::length(glm::cross(ray, -camera.eye)), glm::dot(ray, -camera.eye));
      worst = std::max(worst, std::abs(angle - std::asin(sine)) * camera.focal_px);
    }
  }
  fmt::print("sphere in perspective: worst {:.5f} px\n", worst);
  EXPECT_LT(worst, 0.005);
}

TEST(MeasuredBorder, OfASphereBeforeAnotherEndsWhereItIsHidden) {
  const Field nearer = translate(make_shape("sphere", {{"radius", {0.6}}}), {0.0, 0.0, 1.5});
  const Field farther = translate(make_shape("sphere", {{"radius", {0.8}}}), {0.5, 0.1, -1.0});
  const SceneModel model = model_of(scene_of({object_of(farther), object_of(nearer)}));
  CameraSettings settings = view(240, 180, Projection::orthographic);
  settings.eye = glm::dvec3(0.0, 0.0, 5.0);
  settings.target = glm::dvec3(0.2, 0.0, 0.0);
  settings.eye->x = 0.2;
  settings.ortho_height = 2.4;
  const Camera camera = resolve_camera(settings, {});
  const BorderCurves curves = measured(model, camera);
  for (const BorderCurve& curve : curves.curves) EXPECT_EQ(curve.closed, curve.object == 2);
  EXPECT_EQ(counts(curves),
            (std::map<std::pair<int, CurveKind>, int>{
                {{1, CurveKind::silhouette}, 1}, {{1, CurveKind::inner}, 1}, {{2, CurveKind::silhouette}, 1}, {{2, CurveKind::inner}, 1}}));
  // It ends on the nearer circle, not at the last line of the grid before it.
  const glm::dvec2 middle(project(camera, {0.0, 0.0, 1.5}));
  for (const BorderCurve& curve : curves.curves) {
    if (curve.closed) continue;
    for (const BorderPoint& end : {curve.points.front(), curve.points.back()})
      EXPECT_NEAR(glm::distance(end.px, middle), 0.6 * camera.pixels_per_unit, 0.06);
  }
  // What is left of the farther circles outside the nearer one's, by counting.
  const double scale = camera.pixels_per_unit;
  for (const CurveKind kind : {CurveKind::silhouette, CurveKind::inner}) {
    const double radius = 0.8 * (kind == CurveKind::inner ? std::sqrt(1.0 - kThreshold * kThreshold) : 1.0);
    int outside = 0;
    for (int i = 0; i < 100000; ++i) {
      const double angle = i * 2.0 * std::numbers::pi / 100000;
      outside += glm::length(glm::dvec2(0.5, 0.1) + radius * glm::dvec2(std::cos(angle), std::sin(angle))) > 0.6;
    }
    double length = 0.0;
    for (const BorderCurve& curve : curves.curves) length += curve.kind == kind && curve.object == 1 ? length_px(curve) : 0.0;
    // Each end is cut short by less than the diagonal of a pixel.
    EXPECT_NEAR(length, 2.0 * std::numbers::pi * radius * scale * outside / 100000, 2.9);
  }
}

TEST(MeasuredBorder, OfACubeIsItsOutlineOnceThoughNothingIsInked) {
  const Field cube = make_shape("box", {{"half", {0.5, 0.5, 0.5}}});
  for (const char* kind : {"analytic", "mesh"}) {
    const Scene scene = std::string(kind) == "mesh" ? scene_of({object_of(box_mesh(glm::dvec3(0.5)))}) : scene_of({object_of(cube)});
    SurfaceSettings flat = surface_kind(kind);
    flat.normals = NormalKind::flat;
    const SceneModel model = build_model(scene, flat);
    CameraSettings settings = view(200, 160, Projection::orthographic);
    settings.eye = glm::dvec3(3.0, 2.9, 3.3);
    settings.target = glm::dvec3(0.0);
    settings.ortho_height = 2.0;
    const Camera camera = resolve_camera(settings, {});
    const BorderCurves curves = measured(model, camera);
    ASSERT_EQ(curves.curves.size(), 1u) << kind;
    const BorderCurve& outline = curves.curves[0];
    EXPECT_EQ(outline.kind, CurveKind::silhouette);
    EXPECT_TRUE(outline.closed);
    EXPECT_GT(left_area(outline), 0.0);
    // The six edges between a face seen and one not seen.
    BorderCurve hexagon{CurveKind::silhouette, 1, true, {}};
    for (const glm::dvec3 corner : {glm::dvec3(1, -1, -1), glm::dvec3(1, 1, -1), glm::dvec3(-1, 1, -1), glm::dvec3(-1, 1, 1),
                                    glm::dvec3(-1, -1, 1), glm::dvec3(1, -1, 1)}) {
      BorderPoint point;
      point.px = glm::dvec2(project(camera, 0.5 * corner));
      hexagon.points.push_back(point);
    }
    const double worst = worst_distance(curves, CurveKind::silhouette, {{hexagon}});
    fmt::print("cube, {}: worst {:.5f} px\n", kind, worst);
    EXPECT_LT(worst, 0.005) << kind;
    // Corners are cut by less than a pixel each, and by rays between the pixels' to next to nothing.
    EXPECT_NEAR(length_px(outline), length_px(hexagon), 4.0) << kind;
    EXPECT_LT(worst_distance({{hexagon}}, CurveKind::silhouette, curves), 0.03) << kind;
    EXPECT_EQ(measured(model, camera, 0.0).curves.size(), 1u) << kind;
  }
}

TEST(MeasuredBorder, OfThinInkIsFoundBetweenPixelCentres) {
  // Ink 0.05 px to 0.6 px wide: no centre need show it, its silhouette's own rays do.
  const SceneModel model = model_of(scene_of({object_of(make_shape("sphere", {{"radius", {1.0}}}))}));
  const Camera camera = camera_at({1.9, 2.3, 2.9}, Projection::orthographic, 2.4);
  for (const double c : {0.04, 0.12}) {
    const BorderCurves curves = measured(model, camera, c);
    EXPECT_EQ(curves.curves.size(), 2u) << c;
    const double circumference = 2.0 * std::numbers::pi * camera.pixels_per_unit * std::sqrt(1.0 - c * c);
    EXPECT_NEAR(total_length(curves, CurveKind::inner), circumference, 0.1) << c;
  }
}

TEST(MeasuredBorder, FollowsThinWedgesBetweenThePixelsToTheirTips) {
  // A wedge of ten degrees, seen flat: its last 5.7 px are thinner than a pixel. It is followed to where it is 0.07 px thin.
  const double half = glm::radians(5.0);
  const glm::dvec3 up(std::sin(half), 0.0, std::cos(half)), down(std::sin(half), 0.0, -std::cos(half));
  const Field cut = combine(Csg::intersection, make_shape("plane", {{"normal", {up.x, up.y, up.z}}, {"offset", {0.0}}}),
                            make_shape("plane", {{"normal", {down.x, down.y, down.z}}, {"offset", {0.0}}}));
  const Field wedge = combine(Csg::intersection, make_shape("box", {{"half", {1.0, 0.3, 1.0}}}), cut);
  const SceneModel model = model_of(scene_of({object_of(wedge)}));
  CameraSettings settings = view(200, 160, Projection::orthographic);
  settings.eye = glm::dvec3(-0.513, 5.0, 0.017);
  settings.target = glm::dvec3(-0.513, 0.0, 0.017);
  settings.up = glm::dvec3(0.31, 0.0, 1.0);
  settings.ortho_height = 1.6;
  const Camera camera = resolve_camera(settings, {});
  BorderCurve tip{CurveKind::silhouette, 1, false, std::vector<BorderPoint>(2)};
  tip.points[0].px = tip.points[1].px = glm::dvec2(project(camera, {0.0, 0.3, 0.0}));
  EXPECT_LT(worst_distance({{tip}}, CurveKind::silhouette, measured(model, camera)), 0.4);
}

/// Seen along z in parallel, a pixel being 0.01, from straight above the point (0.0031, 0.0017).
Camera flat_view() {
  CameraSettings settings = view(160, 120, Projection::orthographic);
  settings.eye = glm::dvec3(0.0031, 0.0017, 5.0);
  settings.target = glm::dvec3(0.0031, 0.0017, 0.0);
  settings.ortho_height = 1.2;
  return resolve_camera(settings, {});
}

std::vector<double> components(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

TEST(MeasuredBorder, OfSheetsAndGapsThinnerThanAPixelIsInOnePiece) {
  // Askew between the pixels' centres, of which some line shows each: marching squares alone leaves pieces. From 1/sqrt(2) px on none of
  // these runs by more than three centres.
  std::mt19937 random(random_seed());
  const auto draw = [&](double low, double high) { return low + (high - low) * static_cast<double>(random() % 10001) / 1e4; };
  const Camera camera = flat_view();
  for (int i = 0; i < 40; ++i) {
    const double width_px = draw(0.72, 0.95), angle = glm::radians(draw(14.0, 76.0)), shift = draw(-0.1, 0.1);
    const glm::dvec3 along(std::cos(angle), std::sin(angle), 0.0), across(-along.y, along.x, 0.0), middle = shift * across;
    const std::string what = fmt::format("{:.3f} px wide at {:.2f} degrees, moved by {:.4f}", width_px, glm::degrees(angle), shift);
    const Field stick = make_shape(
        "capsule", {{"a", components(middle - 0.4 * along)}, {"b", components(middle + 0.4 * along)}, {"radius", {0.005 * width_px}}});
    const BorderCurves sheet = measured(model_of(scene_of({object_of(stick)})), camera, 0.0);
    ASSERT_EQ(sheet.curves.size(), 1u) << what;
    EXPECT_TRUE(sheet.curves[0].closed) << what;
    EXPECT_GT(left_area(sheet.curves[0]), 0.0) << what;
    EXPECT_NEAR(length_px(sheet.curves[0]), 160.0 + std::numbers::pi * width_px, 0.5) << what;

    const Field slit =
        combine(Csg::intersection, make_shape("plane", {{"normal", components(across)}, {"offset", {shift + 0.005 * width_px}}}),
                make_shape("plane", {{"normal", components(-across)}, {"offset", {-shift + 0.005 * width_px}}}));
    const Field hole = combine(Csg::intersection, slit, make_shape("box", {{"half", {0.35, 0.25, 1.0}}}));
    const Field plate = combine(Csg::difference, make_shape("box", {{"half", {0.45, 0.35, 0.2}}}), hole);
    const BorderCurves gap = measured(model_of(scene_of({object_of(plate)})), camera, 0.0);
    ASSERT_EQ(gap.curves.size(), 2u) << what;
    EXPECT_LT(left_area(gap.curves[0]) * left_area(gap.curves[1]), 0.0) << what;
    for (const BorderCurve& one : gap.curves) EXPECT_TRUE(one.closed) << what;
  }
}

TEST(MeasuredBorder, WithoutAThresholdIsTheSilhouetteAlone) {
  const SceneModel model = model_of(scene_of({object_of(make_shape("torus"))}));
  const Camera camera = camera_at({1.9, 1.3, 2.9}, Projection::perspective, 0.0);
  const BorderCurves all = measured(model, camera), silhouette = measured(model, camera, 0.0);
  EXPECT_EQ(total_length(silhouette, CurveKind::inner), 0.0);
  EXPECT_NEAR(total_length(silhouette, CurveKind::silhouette), total_length(all, CurveKind::silhouette), 1e-9);
}

TEST(MeasuredBorder, IsTheSameForAnyNumberOfThreads) {
  const SceneModel model = model_of(scene_of({object_of(make_shape("torus"))}), "level_set");
  const Camera camera = camera_at({1.9, 1.3, 2.9}, Projection::perspective, 0.0);
  ExecutionSettings one, three;
  one.threads = 1;
  three.threads = 3;
  const BorderCurves a = measured(model, camera, kThreshold, one), b = measured(model, camera, kThreshold, three);
  ASSERT_EQ(a.curves.size(), b.curves.size());
  for (size_t i = 0; i < a.curves.size(); ++i) {
    ASSERT_EQ(a.curves[i].points.size(), b.curves[i].points.size());
    EXPECT_EQ(a.curves[i].kind, b.curves[i].kind);
    for (size_t k = 0; k < a.curves[i].points.size(); ++k) {
      EXPECT_EQ(a.curves[i].points[k].px, b.curves[i].points[k].px);
      EXPECT_EQ(a.curves[i].points[k].depth, b.curves[i].points[k].depth);
    }
  }
}

TEST(MeasuredBorder, TakesFewRays) {
  const SceneModel model = model_of(scene_of({object_of(make_shape("ellipsoid"))}));
  const Camera camera = camera_at({1.9, 2.3, 2.9}, Projection::perspective, 0.0);
  const BorderCrossings found = find_crossings(model, camera, render_gbuffer(model, camera, {}), {}, {});
  const double each = static_cast<double>(found.rays) / static_cast<double>(found.crossings.size());
  fmt::print("{} rays for {} crossings: {:.1f} each\n", found.rays, found.crossings.size(), each);
  EXPECT_LT(each, 8.0);
}

}  // namespace
}  // namespace limn::test
