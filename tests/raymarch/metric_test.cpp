// Metrics against closed cases, and what must hold of any of them: a border against itself, symmetry, the triangle inequality, pictures
// that are turned.

#include "raymarch/metric.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "raymarch/curves/curve_geometry.h"
#include "tests/raymarch/border_distance.h"

namespace limn::test {
namespace {

constexpr int kSide = 400;
const glm::dvec2 kMiddle(0.5 * kSide);

using Values = std::map<std::string, double>;

/// Curves against truth, or inks, or motion: whatever the metric reads.
struct Case {
  BorderCurves curves{};
  BorderTruth truth{};
  Picture picture{}, reference{};
  std::vector<Image<float>> moved{}, reference_moved{};
  Camera camera{};
};

Case case_of(const BorderCurves& curves, const BorderCurves& truth) {
  Case result;
  result.curves = curves;
  result.truth.curves = truth;
  result.camera.width_px = result.camera.height_px = kSide;
  return result;
}

Case case_of(const Image<float>& ink, const Image<float>& reference) {
  Case result;
  result.picture.border = ink;
  result.reference.border = reference;
  return result;
}

Values measured(const std::string& metric, const Case& given) {
  Values values;
  for (const MetricValue& value : find_metric(metric).measure(
           {given.picture, given.reference, given.camera, &given.curves, &given.truth, given.moved, given.reference_moved})) {
    values[value.name] = value.value;
  }
  return values;
}

BorderCurve polyline(const std::vector<glm::dvec2>& points, CurveKind kind = CurveKind::silhouette, bool closed = false, int object = 1) {
  BorderCurve curve{kind, object, closed, {}};
  for (const glm::dvec2& px : points) {
    BorderPoint point;
    point.px = px;
    curve.points.push_back(point);
  }
  return curve;
}

/// What is bounded lies within a silhouette and about an inner border.
BorderCurve circle(double radius, CurveKind kind, glm::dvec2 centre = kMiddle, double from = 0.0, double to = 1.0) {
  std::vector<glm::dvec2> points;
  const int count = 1000;
  const bool closed = from == 0.0 && to == 1.0;
  for (int i = 0; i < count; ++i) {
    const double turn = from + (to - from) * i / (closed ? count : count - 1);
    const double angle = (kind == CurveKind::silhouette ? -2.0 : 2.0) * std::numbers::pi * turn;
    points.push_back(centre + radius * glm::dvec2(std::cos(angle), std::sin(angle)));
  }
  return polyline(points, kind, closed);
}

BorderCurves turned(BorderCurves curves, double angle) {
  const glm::dmat2 turn(std::cos(angle), std::sin(angle), -std::sin(angle), std::cos(angle));
  for (BorderCurve& curve : curves.curves) {
    for (BorderPoint& point : curve.points) point.px = kMiddle + turn * (point.px - kMiddle);
  }
  return curves;
}

/// Wavy closed curves about the middle, of both kinds, within the circle that fits the picture.
BorderCurves wavy(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  BorderCurves curves;
  for (const CurveKind kind : {CurveKind::silhouette, CurveKind::inner}) {
    const double a = 4.0 * unit(random), b = 3.0 * unit(random), phase = 3.0 * unit(random), radius = kind == CurveKind::inner ? 120 : 160;
    BorderCurve curve = circle(radius, kind, kMiddle + 4.0 * glm::dvec2(unit(random), unit(random)));
    for (BorderPoint& point : curve.points) {
      const glm::dvec2 from = point.px - kMiddle;
      const double angle = std::atan2(from.y, from.x);
      point.px += glm::normalize(from) * (a * std::sin(3.0 * angle + phase) + b * std::cos(7.0 * angle));
    }
    curves.curves.push_back(curve);
  }
  return curves;
}

TEST(CurveMetrics, OfABorderAgainstItselfAreNought) {
  std::mt19937 random(5);
  const BorderCurves curves = wavy(random);
  const Case same = case_of(curves, curves);
  for (const char* name : {"silhouette_displacement", "inner_displacement"}) {
    for (const auto& [value_name, value] : measured(name, same)) {
      if (!value_name.ends_with("_x") && !value_name.ends_with("_y")) {
        EXPECT_NEAR(value, 0.0, 1e-12) << value_name;
      }
    }
  }
  for (const char* name : {"hausdorff", "mean_distance"}) {
    for (const auto& [value_name, value] : measured(name, same)) EXPECT_NEAR(value, 0.0, 1e-12) << value_name;
  }
  EXPECT_EQ(measured("width", same).at("width_bias"), 0.0);
}

RC_GTEST_PROP(CurveMetrics, OfAStraightLineMovedByKPixelsReadK, ()) {
  const double angle = *rc::gen::inRange(0, 6283) * 1e-3, k = *rc::gen::inRange(-1500, 1500) * 1e-2;
  const glm::dvec2 along(std::cos(angle), std::sin(angle)), outward(-along.y, along.x);
  const auto line = [&](double offset) {
    return polyline({kMiddle - 700.0 * along + offset * outward, kMiddle + 700.0 * along + offset * outward});
  };
  const Case moved = case_of({{line(k)}}, {{line(0.0)}});
  const Values values = measured("silhouette_displacement", moved);
  RC_ASSERT(std::abs(values.at("silhouette_displacement_mean") - k) < 1e-9);
  for (const char* name : {"rms", "p95", "max"}) {
    RC_ASSERT(std::abs(values.at("silhouette_displacement_" + std::string(name)) - std::abs(k)) < 1e-9);
  }
  RC_ASSERT(values.at("silhouette_displacement_missing") == 0.0);
  RC_ASSERT(values.at("silhouette_displacement_false") == 0.0);
  RC_ASSERT(std::abs(measured("hausdorff", moved).at("hausdorff") - std::abs(k)) < 1e-9);
  RC_ASSERT(std::abs(measured("mean_distance", moved).at("mean_distance") - std::abs(k)) < 1e-9);
}

RC_GTEST_PROP(CurveMetrics, OfCirclesOfRadiusRAndRPlusKReadK, ()) {
  const double radius = *rc::gen::inRange(300, 1500) * 0.1, k = *rc::gen::inRange(-1000, 1000) * 1e-2;
  for (const CurveKind kind : {CurveKind::silhouette, CurveKind::inner}) {
    const std::string name = kind == CurveKind::silhouette ? "silhouette_displacement" : "inner_displacement";
    // Wider ink is a smaller inner circle.
    const double grown = kind == CurveKind::silhouette ? k : -k;
    const Case given = case_of({{circle(radius + k, kind)}}, {{circle(radius, kind)}});
    const Values values = measured(name, given);
    RC_ASSERT(std::abs(values.at(name + "_mean") - grown) < 1e-3);
    RC_ASSERT(std::abs(values.at(name + "_max") - std::abs(k)) < 1e-3);
    RC_ASSERT(values.at(name + "_missing") == 0.0);
    RC_ASSERT(std::abs(measured("hausdorff", given).at("hausdorff") - std::abs(k)) < 1e-3);
  }
}

TEST(CurveMetrics, CountWhatHasNoPartner) {
  const Case half = case_of({{circle(100.5, CurveKind::inner, kMiddle, 0.0, 0.5)}}, {{circle(100.0, CurveKind::inner)}});
  const Values values = measured("inner_displacement", half);
  // Open ends are continued by 1.5 px.
  EXPECT_NEAR(values.at("inner_displacement_missing"), 0.5, 0.007);
  EXPECT_EQ(values.at("inner_displacement_false"), 0.0);
  EXPECT_NEAR(values.at("inner_displacement_rms"), 0.5, 0.01);
  const Case swapped = case_of(half.truth.curves, half.curves);
  EXPECT_EQ(measured("inner_displacement", swapped).at("inner_displacement_missing"), 0.0);
  EXPECT_NEAR(measured("inner_displacement", swapped).at("inner_displacement_false"), 0.5, 0.007);
  // Another object's border is no partner, and none at all is all missing.
  Case other = case_of({{circle(100.0, CurveKind::inner)}}, {{circle(100.0, CurveKind::inner)}});
  other.curves.curves[0].object = 2;
  EXPECT_EQ(measured("inner_displacement", other).at("inner_displacement_missing"), 1.0);
  EXPECT_TRUE(std::isnan(measured("inner_displacement", other).at("inner_displacement_rms")));
}

TEST(CurveMetrics, ReadAMovedSquareRightBesideItsCorners) {
  const auto square = [](double half) {
    std::vector<glm::dvec2> points{{-half, half}, {half, half}, {half, -half}, {-half, -half}};
    for (glm::dvec2& point : points) point += kMiddle;
    return polyline(points, CurveKind::silhouette, true);
  };
  for (const double k : {-3.0, 2.0}) {
    const Values values = measured("silhouette_displacement", case_of({{square(80.0 + k)}}, {{square(80.0)}}));
    EXPECT_NEAR(values.at("silhouette_displacement_mean"), k, 0.05 * std::abs(k)) << k;
    EXPECT_NEAR(values.at("silhouette_displacement_max"), std::abs(k), 1e-9) << k;
    EXPECT_LT(values.at("silhouette_displacement_missing"), 0.04) << k;
  }
}

TEST(CurveMetrics, AreSymmetricAndKeepTheTriangleInequality) {
  for (std::uint32_t seed = 0; seed < 8; ++seed) {
    std::mt19937 random(seed);
    const BorderCurves a = wavy(random), b = wavy(random), c = wavy(random);
    const auto distance = [](const std::string& name, const BorderCurves& p, const BorderCurves& q) {
      return measured(name, case_of(p, q)).at(name);
    };
    for (const std::string name : {"hausdorff", "mean_distance"}) EXPECT_EQ(distance(name, a, b), distance(name, b, a)) << seed;
    // Samples 0.25 px apart find the largest distance to half of that.
    EXPECT_LE(distance("hausdorff", a, c), distance("hausdorff", a, b) + distance("hausdorff", b, c) + 0.125) << seed;
  }
}

TEST(CurveMetrics, DoNotChangeWhenThePictureIsTurned) {
  std::mt19937 random(17);
  for (const double angle : {0.5 * std::numbers::pi, std::numbers::pi, 0.3, 2.17}) {
    const BorderCurves a = wavy(random), b = wavy(random);
    const Case before = case_of(a, b), after = case_of(turned(a, angle), turned(b, angle));
    for (const char* name : {"silhouette_displacement", "inner_displacement", "hausdorff", "mean_distance", "width"}) {
      const Values one = measured(name, before), other = measured(name, after);
      for (const auto& [value_name, value] : one) {
        if (!value_name.ends_with("_x") && !value_name.ends_with("_y")) {
          EXPECT_NEAR(value, other.at(value_name), 1e-6) << value_name << " turned by " << angle;
        }
      }
    }
  }
}

TEST(CurveMetrics, FindTheNearestPointThatASearchOfAllSegmentsFinds) {
  std::mt19937 random(23);
  std::uniform_real_distribution<double> place(-40.0, kSide + 40.0);
  const BorderCurves curves = wavy(random);
  const CurveIndex index(curves, std::nullopt);
  for (int i = 0; i < 300; ++i) {
    const glm::dvec2 px(place(random), place(random));
    double best = 1e300;
    for (const BorderCurve& curve : curves.curves) {
      for (size_t k = 0; k < curve.points.size(); ++k)
        best = std::min(best, test::segment_distance(px, curve.points[k].px, curve.points[(k + 1) % curve.points.size()].px));
    }
    const auto nearest = index.nearest(px, 0, 1e9);
    ASSERT_TRUE(nearest);
    EXPECT_NEAR(nearest->distance_px, best, 1e-9);
    EXPECT_EQ(index.nearest(px, 0, 0.99 * best).has_value(), false);
  }
}

TEST(CurveMetrics, FindTheDistancesToAllCurvesAndToOneKindInOneSearch) {
  std::mt19937 random(29);
  std::uniform_real_distribution<double> place(-40.0, kSide + 40.0);
  const BorderCurves both = wavy(random);
  BorderCurves silhouettes;
  silhouettes.curves.push_back(both.curves.front());
  const CurveIndex of_both(both, std::nullopt), of_silhouettes(silhouettes, std::nullopt);
  int inner_is_nearer = 0;
  for (int i = 0; i < 300; ++i) {
    const glm::dvec2 px(place(random), place(random));
    for (const CurveKind kind : {CurveKind::silhouette, CurveKind::inner}) {
      const NearestDistances found = of_both.nearest_distances(px, kind);
      EXPECT_EQ(found.any_px, of_both.nearest(px, 0, 1e9)->distance_px) << i;
      EXPECT_EQ(found.of_kind_px, CurveIndex(both, kind).nearest(px, 0, 1e9)->distance_px) << i;
      inner_is_nearer += kind == CurveKind::silhouette && found.any_px < found.of_kind_px;
    }
    // Of a kind that is not there nothing is near, and all the same what there is is found.
    const NearestDistances none = of_silhouettes.nearest_distances(px, CurveKind::inner);
    EXPECT_TRUE(std::isinf(none.of_kind_px)) << i;
    EXPECT_EQ(none.any_px, of_silhouettes.nearest(px, 0, 1e9)->distance_px) << i;
  }
  EXPECT_GT(inner_is_nearer, 30) << "places that tell the two apart";
}

TEST(Width, OfARingIsTheDifferenceOfItsRadii) {
  const BorderCurves ring{{circle(150.0, CurveKind::silhouette), circle(138.0, CurveKind::inner)}};
  const BorderCurves wider{{circle(150.0, CurveKind::silhouette), circle(137.0, CurveKind::inner)}};
  const Values values = measured("width", case_of(wider, ring));
  EXPECT_NEAR(values.at("width_mean"), 13.0, 1e-3);
  EXPECT_NEAR(values.at("width_truth_mean"), 12.0, 1e-3);
  EXPECT_NEAR(values.at("width_bias"), 1.0, 1e-3);
  EXPECT_NEAR(values.at("width_deviation"), 0.0, 1e-3);
  EXPECT_NEAR(values.at("width_ratio"), 1.0, 1e-3);
  EXPECT_EQ(values.at("width_missing"), 0.0);
}

TEST(Width, OfARingOffItsMiddleVariesFromOneSideToTheOther) {
  const BorderCurves ring{{circle(150.0, CurveKind::silhouette), circle(138.0, CurveKind::inner, kMiddle + glm::dvec2(6.0, 0.0))}};
  const Values values = measured("width", case_of(ring, ring));
  EXPECT_NEAR(values.at("width_mean"), 12.0, 0.1);
  EXPECT_NEAR(values.at("width_deviation"), 6.0 / std::sqrt(2.0), 0.1);  // 12 + 6 cos
  EXPECT_NEAR(values.at("width_ratio"), 3.0, 0.05);
}

Image<float> ink_of(const std::vector<std::string>& rows) {
  Image<float> ink(static_cast<int>(rows[0].size()), static_cast<int>(rows.size()), 0.0f);
  for (int y = 0; y < ink.height; ++y) {
    for (int x = 0; x < ink.width; ++x) ink.at(x, y) = rows[static_cast<size_t>(y)][static_cast<size_t>(x)] == '#';
  }
  return ink;
}

Image<float> turned(const Image<float>& ink) {
  Image<float> result(ink.height, ink.width);
  for (int y = 0; y < ink.height; ++y) {
    for (int x = 0; x < ink.width; ++x) result.at(ink.height - 1 - y, x) = ink.at(x, y);
  }
  return result;
}

Image<float> random_ink(std::mt19937& random, int width, int height, int coarseness) {
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  Image<float> ink(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      ink.at(x, y) = x % coarseness == 0 && y % coarseness == 0 ? unit(random) : ink.at(x - x % coarseness, y - y % coarseness);
    }
  }
  return ink;
}

TEST(Topology, CountsPiecesOverCornersAndHolesOverSides) {
  const Image<float> ring = ink_of({
      ".........",
      "..##.....",
      ".#..#..#.",
      ".#..#....",
      "..##.....",
      ".......##",
      ".......#.",
  });
  const Image<float> open = ink_of({
      ".........",
      "..##.....",
      ".#..#..#.",
      ".#.......",
      "..##.....",
      ".......##",
      ".......#.",
  });
  const Values values = measured("topology", case_of(open, ring));
  EXPECT_EQ(values.at("topology_reference_components"), 3.0);
  EXPECT_EQ(values.at("topology_reference_holes"), 1.0);
  EXPECT_EQ(values.at("topology_components"), 3.0);
  EXPECT_EQ(values.at("topology_holes"), 0.0);
  EXPECT_EQ(values.at("topology_components_difference"), 0.0);
  EXPECT_EQ(values.at("topology_holes_difference"), -1.0);
}

TEST(Topology, KeepsTheEulerNumberOfRandomInk) {
  // Euler number of 8-connected ink from 2 x 2 windows (Gray 1971): (Q1 - Q3 - 2 QD) / 4.
  std::mt19937 random(3);
  for (int round = 0; round < 20; ++round) {
    const Image<float> ink = random_ink(random, 30, 21, 1 + round % 3);
    const auto at = [&](int x, int y) { return ink.inside(x, y) && ink.at(x, y) >= 0.5f ? 1 : 0; };
    int sum = 0;
    for (int y = -1; y < ink.height; ++y) {
      for (int x = -1; x < ink.width; ++x) {
        const int a = at(x, y), b = at(x + 1, y), c = at(x, y + 1), d = at(x + 1, y + 1), count = a + b + c + d;
        sum += count == 1 ? 1 : count == 3 ? -1 : count == 2 && a == d ? -2 : 0;
      }
    }
    const Values values = measured("topology", case_of(ink, ink));
    EXPECT_EQ(values.at("topology_components") - values.at("topology_holes"), sum / 4) << "round " << round;
  }
}

TEST(BoundaryIou, OfASquareMovedByOnePixelIsWhatItsSidesShare) {
  const auto square = [](int x0) {
    Image<float> ink(100, 100, 0.0f);
    for (int y = 30; y < 70; ++y) {
      for (int x = x0; x < x0 + 40; ++x) ink.at(x, y) = 1.0f;
    }
    return ink;
  };
  // Strips one px wide of 4 * 39 px: the upper and the lower share 39 each.
  EXPECT_NEAR(measured("boundary_iou", case_of(square(30), square(31))).at("boundary_iou"), 78.0 / 234.0, 1e-12);
  EXPECT_EQ(measured("boundary_iou", case_of(square(30), square(30))).at("boundary_iou"), 1.0);
  EXPECT_EQ(measured("boundary_iou", case_of(square(0), square(50))).at("boundary_iou"), 0.0);
}

TEST(InkMetrics, DoNotChangeWhenThePictureIsTurnedByAQuarter) {
  std::mt19937 random(29);
  for (int round = 0; round < 5; ++round) {
    const Image<float> a = random_ink(random, 64, 48, 6), b = random_ink(random, 64, 48, 6);
    for (const char* name : {"pixels_differ", "overlap", "boundary_iou", "topology"}) {
      const Values one = measured(name, case_of(a, b)), other = measured(name, case_of(turned(a), turned(b)));
      for (const auto& [value_name, value] : one) EXPECT_NEAR(value, other.at(value_name), 1e-9) << value_name;
    }
  }
}

TEST(Flicker, CountsTheFlipsThatTheReferenceHasNot) {
  Case moves = case_of(Image<float>{}, Image<float>{});
  const Image<float> line = ink_of({"......", ".####.", "......"}), shorter = ink_of({"......", ".###..", "......"}),
                     stray = ink_of({"#.....", ".###..", "......"});
  moves.reference_moved = {line, shorter, shorter};
  moves.moved = {line, stray, shorter};
  const Values values = measured("flicker", moves);
  // The reference shows 3 border pixels after each of 2 moves. It flips once; the model thrice: with it, and a stray pixel on and off.
  EXPECT_NEAR(values.at("flicker"), 2.0 / 6.0, 1e-12);
  EXPECT_NEAR(values.at("flicker_flips"), 3.0 / 6.0, 1e-12);
  EXPECT_NEAR(values.at("flicker_reference_flips"), 1.0 / 6.0, 1e-12);
  moves.moved = moves.reference_moved;
  EXPECT_EQ(measured("flicker", moves).at("flicker"), 0.0);
}

TEST(NormalError, GivesTheRootMeanSquareToo) {
  Case given;
  GBuffer& a = given.picture.gbuffer;
  a.width = 2;
  a.height = 1;
  a.status = Image<std::uint8_t>(2, 1, 1);
  a.id = Image<std::int32_t>(2, 1, 1);
  a.normal = Image<glm::vec3>(2, 1, glm::vec3(0.0f, 0.0f, 1.0f));
  given.reference.gbuffer = a;
  a.normal.pixels[1] = {std::sin(0.1f), 0.0f, std::cos(0.1f)};
  const Values values = measured("normal_error", given);
  EXPECT_NEAR(values.at("normal_error_mean"), glm::degrees(0.05), 1e-5);
  EXPECT_NEAR(values.at("normal_error_rms"), glm::degrees(0.1 / std::sqrt(2.0)), 1e-5);
  EXPECT_EQ(values.at("normal_error_max_x"), 1.0);
}

}  // namespace
}  // namespace limn::test
