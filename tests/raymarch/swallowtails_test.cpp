// Cusps and crossings of contours that lie close to each other, and pieces between them too short for rays.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/raymarch/made_up_curves.h"

namespace limn {
using namespace test;
namespace {

constexpr double kPi = std::numbers::pi;

std::vector<int> invisibilities(const CutCurve& cut) {
  std::vector<int> seen;
  for (const CurvePiece& piece : cut.pieces) seen.push_back(piece.invisibility);
  return seen;
}

TEST(Swallowtails, ArmsThatPartAfterACuspCrossWhereTheyMeetAgain) {
  // Between the cusp and where the arms meet, 2.5 px from it, they lie up to 0.02 px apart.
  const Camera camera = flat_view();
  std::vector<glm::dvec2> px;
  std::vector<double> curvatures;
  const auto off = [](double x) { return 0.01 * std::sin(kPi * x / 2.5); };
  for (int i = 41; i >= 1; --i) px.push_back({0.1 * i, -off(0.1 * i)}), curvatures.push_back(1.0);
  for (int i = 1; i <= 41; ++i) px.push_back({0.1 * i, off(0.1 * i)}), curvatures.push_back(-1.0);
  const SurfaceCurve curve = exact_curve(camera, px, curvatures);
  const double cusp = 0.5 * (curve.samples[40].p.z + curve.samples[41].p.z);
  const LayersBefore rays = [&](const CurveSample& sample) { return LayersSeen{sample.p.z > cusp ? 0 : sample.p.x < 0.25 ? 1 : 3}; };
  const CutCurves cut = cut_by_invisibility({curve}, camera, 5.0, rays, {});
  EXPECT_TRUE(cut.conflicts.empty());
  EXPECT_EQ(invisibilities(cut.curves[0]), (std::vector<int>{0, 1, 3}));
  // Lines tell it, and no rays have to look for it.
  EXPECT_LT(cut.rays, 10);
}

/// Samples of a curve as the image has them, and which way it bends there.
struct BentCurve {
  std::vector<glm::dvec2> px{};
  std::vector<double> curvatures{};
  void add(const glm::dvec2& at, double curvature) { px.push_back(at), curvatures.push_back(curvature); }
};

/// Ten pixels up to a swallowtail of a fiftieth of a pixel, and through it: its cusps lie after samples 103 and 107.
BentCurve narrow_swallowtail() {
  BentCurve curve;
  for (int i = 100; i >= 1; --i) curve.add({-0.1 * i, -0.01 * i}, 1.0);
  for (const double x : {-0.005, 0.0, 0.005, 0.0099}) curve.add({x, 0.1 * x}, 1.0);
  for (const double x : {0.0098, 0.003, -0.003, -0.0098}) curve.add({x, 0.001}, -1.0);
  for (const double x : {-0.0099, -0.005, 0.001, 0.005}) curve.add({x, 0.00001 - 0.1 * x}, 1.0);
  return curve;
}

/// With the rays that tell what lies before each of its arms.
CutCurves cut_swallowtail(const BentCurve& bent) {
  const Camera camera = flat_view();
  const SurfaceCurve curve = exact_curve(camera, bent.px, bent.curvatures);
  const auto middle = [&](size_t i) { return 0.5 * (curve.samples[i].p.z + curve.samples[i + 1].p.z); };
  const double first = middle(103), second = middle(107);
  const LayersBefore rays = [&](const CurveSample& sample) {
    const glm::dvec3& p = sample.p;
    return LayersSeen{p.z > first ? 0 : p.z > second ? 1 : p.x < 5e-6 ? 2 : 0};
  };
  return cut_by_invisibility({curve}, camera, 5.0, rays, {});
}

TEST(Swallowtails, ASwallowtailOfAFiftiethOfAPixelIsThereWhereTheCurveIsKnownBetweenItsSamples) {
  BentCurve curve = narrow_swallowtail();
  for (int i = 1; i <= 100; ++i) curve.add({0.1 * i, -0.01 * i}, 1.0);
  const CutCurves cut = cut_swallowtail(curve);
  EXPECT_TRUE(cut.conflicts.empty());
  EXPECT_EQ(invisibilities(cut.curves[0]), (std::vector<int>{0, 1, 2, 0}));
}

TEST(Swallowtails, OneTooNarrowToTellIsGoneThoughACrossingOfAnotherIsNear) {
  // The first is that of the test before; the second, a pixel on, is 0.0034 px long, and its arms lie within 0.0004 px.
  BentCurve curve = narrow_swallowtail();
  for (int i = 1; i <= 10; ++i) curve.add({0.1 * i, -0.01 * i}, 1.0);
  curve.add({1.0017, -0.1}, 1.0);
  for (const double x : {1.0016, 0.9984}) curve.add({x, -0.0998}, -1.0);
  for (const double x : {0.9983, 1.0017}) curve.add({x, -0.0996}, 1.0);
  for (int i = 11; i <= 100; ++i) curve.add({0.1 * i, -0.01 * i}, 1.0);
  const CutCurves cut = cut_swallowtail(curve);
  EXPECT_TRUE(cut.conflicts.empty());
  EXPECT_EQ(invisibilities(cut.curves[0]), (std::vector<int>{0, 1, 2, 0}));
}

/// The contour of the surface t^5 - t^3 + u t + v = 0 along t: a section of the butterfly (Arnold 1972), with three cusps, between
/// whose arms it crosses itself three times. `size_px`: of a unit of u and v.
class Butterfly {
 public:
  explicit Butterfly(double size_px) : size_px_(size_px) {}
  glm::dvec2 px_at(double t) const {
    const double t2 = t * t;
    return size_px_ * glm::dvec2(3.0 * t2 - 5.0 * t2 * t2, (4.0 * t2 - 2.0) * t2 * t);
  }
  /// Of one sign between the cusps, at -0.5477, 0 and 0.5477.
  double bend_at(double t) const { return 20.0 * t * t * t - 6.0 * t; }
  /// Sheets nearer than the contour: roots below t of the polynomial over (x - t)^2, a cubic.
  int layers_at(double t) const {
    const auto cubic = [t](double x) { return ((x + 2.0 * t) * x + 3.0 * t * t - 1.0) * x + 4.0 * t * t * t - 2.0 * t; };
    int layers = 0;
    constexpr int kSteps = 20'000;
    constexpr double kFarthest = 30.0;
    for (int i = 0; i < kSteps; ++i) {
      const double a = glm::mix(-kFarthest, t, static_cast<double>(i) / kSteps), b = glm::mix(-kFarthest, t, (i + 1.0) / kSteps);
      layers += (cubic(a) < 0.0) != (cubic(b) < 0.0) ? 1 : 0;
    }
    return layers;
  }

 private:
  double size_px_;
};

TEST(Swallowtails, OfAButterflyTheOuterArmsCrossThoughTheyLieOnEachOther) {
  const Camera camera = flat_view();
  for (const double size_px : {0.2, 0.02, 0.006}) {
    const Butterfly butterfly(size_px);
    // Ten pixels on each side; finely about the cusps.
    std::vector<double> t;
    const double farthest = std::pow(10.0 / size_px, 0.2);
    for (int i = -400; i <= 400; ++i) t.push_back(farthest * std::sinh(4.0 * (i + 0.25) / 400.0) / std::sinh(4.0));
    BentCurve bent;
    for (const double at : t) bent.add(butterfly.px_at(at), butterfly.bend_at(at));
    const SurfaceCurve curve = exact_curve(camera, bent.px, bent.curvatures);
    const LayersBefore rays = [&](const CurveSample& sample) {
      // exact_curve() puts each sample 0.01 farther away than the one before.
      const double place = std::clamp((2.0 - sample.p.z) / 0.01, 0.0, 800.0);
      const auto i = std::min(static_cast<size_t>(place), t.size() - 2);
      return LayersSeen{butterfly.layers_at(glm::mix(t[i], t[i + 1], place - static_cast<double>(i)))};
    };
    const CutCurves cut = cut_by_invisibility({curve}, camera, 5.0, rays, {});
    EXPECT_TRUE(cut.conflicts.empty()) << size_px << " px: " << cut.conflicts[0].what;
    int crossings = 0, cusps = 0, layers = 0;
    for (const CurveEvent& event : cut.curves[0].events) {
      crossings += event.kind == VertexKind::crossing ? 1 : 0;
      cusps += event.kind == VertexKind::cusp ? 1 : 0;
      layers += event.layers.value_or(0);
    }
    EXPECT_EQ(cusps, 3) << size_px << " px";
    EXPECT_EQ(crossings, 3) << size_px << " px";
    EXPECT_EQ(layers, butterfly.layers_at(t.back()) - butterfly.layers_at(t.front())) << size_px << " px";
    // Lines tell it, and no rays have to look for it.
    EXPECT_LT(cut.rays, 10) << size_px << " px";
  }
}

TEST(Swallowtails, ACurveWhoseStepsDoNotAddUpHasAConflictThoughItsFirstPieceIsTooShortForRays) {
  // It goes behind one sheet more at two places 0.98 px apart, and nothing brings it back before them.
  const Camera camera = flat_view();
  SurfaceCurve line;
  line.closed = true;
  double z = 0.0;
  add_way(camera, {0.4, 10.0}, {20.0, 10.0}, 40, z, 1.0, line);
  add_way(camera, {20.0, 10.0}, {20.0, -10.0}, 40, z, 1.0, line);
  add_way(camera, {20.0, -10.0}, {-20.0, -10.0}, 80, z, 1.0, line);
  add_way(camera, {-20.0, -10.0}, {-20.0, 10.0}, 40, z, 1.0, line);
  add_way(camera, {-20.0, 10.0}, {0.4, 10.0}, 40, z, 1.0, line);
  for (const size_t step : {2u, 4u}) line.samples[step].pierced.push_back({.t = 0.5, .layers = 1});
  const CutCurves cut = cut_by_invisibility({line}, camera, 5.0, [](const CurveSample&) { return LayersSeen{0}; }, {});
  ASSERT_EQ(cut.curves[0].pieces.size(), 2u);
  EXPECT_LT(cut.curves[0].pieces[0].length_px, 1.0);
  EXPECT_EQ(cut.curves[0].pieces[0].invisibility, 1);
  EXPECT_EQ(cut.curves[0].pieces[1].invisibility, 0);
  EXPECT_EQ(cut.conflicts.size(), 1u);
}

}  // namespace
}  // namespace limn
