// What the certificate goes by, on curves and rays made up for it: narrow swallowtails, rays that say nothing, curves followed from seeds
// that were joined in the wrong way, and both sheets of shallow folds.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "raymarch/lines/invisibility.h"
#include "raymarch/lines/level_set_layers.h"
#include "raymarch/lines/line_memory.h"
#include "raymarch/lines/missed_changes.h"
#include "raymarch/lines/missed_contours.h"
#include "raymarch/truth/followed_curves.h"
#include "sdf/field_program.h"
#include "sdf/level_set.h"
#include "sdf/shape.h"
#include "tests/random_seed.h"
#include "tests/raymarch/made_up_curves.h"

namespace limn {
using namespace test;
namespace {

constexpr double kPi = std::numbers::pi;

/// The contour of a flat face seen edge-on: it comes from above, turns at a cusp, goes along the face's one edge to its other end, turns
/// there and comes back along the other edge, behind where it came from.
SurfaceCurve edge_on_face(const Camera& camera, double tail_px, double apart_px) {
  SurfaceCurve curve;
  curve.smooth = true;
  double z = 2.0;
  add_way(camera, {8.0, 14.0}, {0.3, 0.4}, 60, z, 1.0, curve);
  add_way(camera, {0.3, 0.02}, {0.0, 0.0}, 6, z, 1.0, curve);
  add_way(camera, {0.0, 0.0}, {tail_px, 0.0}, 40, z, -1.0, curve);
  add_way(camera, {tail_px, -apart_px}, {-12.0, -apart_px}, 100, z, 1.0, curve);
  for (CurveSample& sample : curve.samples) sample.more_on_left = 2;
  return curve;
}

TEST(LineEvents, TheContourOfAFlatFaceSeenEdgeOnKeepsItsCuspsAndCrossesItselfAtTheFacesEnd) {
  const Camera camera = flat_view();
  for (const double tail_px : {1.5, 5.0, 12.0}) {
    for (const double apart_px : {1e-7, 1e-5, 1e-4}) {
      const SurfaceCurve curve = edge_on_face(camera, tail_px, apart_px);
      const double first = curve.samples[66].p.z, second = curve.samples[106].p.z;
      // Nothing before the first cusp, one sheet more behind each, and neither beyond the face.
      const auto truth = [&](const glm::dvec3& p) { return p.z > first ? 0 : p.z > second ? 1 : p.x > 0.0 ? 2 : 0; };
      const LayersBefore rays = [&](const CurveSample& sample) { return LayersSeen{truth(sample.p)}; };
      const CutCurves cut = cut_by_invisibility({curve}, camera, 5.0, rays, {});
      const std::string what = fmt::format("{} px, {} px apart", tail_px, apart_px);
      EXPECT_TRUE(cut.conflicts.empty()) << what << ": " << cut.conflicts.front().what;
      std::vector<int> seen;
      for (const CurvePiece& piece : cut.curves[0].pieces) {
        EXPECT_TRUE(piece.certain) << what;
        seen.push_back(piece.invisibility);
      }
      EXPECT_EQ(seen, (std::vector<int>{0, 1, 2, 0})) << what;
      const CurveEvent& crossing = *std::find_if(cut.curves[0].events.begin(), cut.curves[0].events.end(),
                                                 [](const CurveEvent& event) { return event.kind == VertexKind::crossing; });
      EXPECT_EQ(crossing.layers, -2) << what;
      const size_t at = static_cast<size_t>(crossing.at);
      EXPECT_NEAR(curve.samples[at].px.x, 50.0, 1.0) << what;
    }
  }
}

TEST(LineEvents, TheSameContourWalkedBackwardsHasTheSameLayers) {
  const Camera camera = flat_view();
  SurfaceCurve curve = edge_on_face(camera, 5.0, 1e-5);
  const double first = curve.samples[66].p.z, second = curve.samples[106].p.z;
  std::reverse(curve.samples.begin(), curve.samples.end());
  for (CurveSample& sample : curve.samples) sample.more_on_left = -2;
  const LayersBefore rays = [&](const CurveSample& sample) {
    const glm::dvec3& p = sample.p;
    return LayersSeen{p.z > first ? 0 : p.z > second ? 1 : p.x > 0.0 ? 2 : 0};
  };
  const CutCurves cut = cut_by_invisibility({curve}, camera, 5.0, rays, {});
  EXPECT_TRUE(cut.conflicts.empty());
  std::vector<int> seen;
  for (const CurvePiece& piece : cut.curves[0].pieces) seen.push_back(piece.invisibility);
  EXPECT_EQ(seen, (std::vector<int>{0, 2, 1, 0}));
}

TEST(LineEvents, ARayThatAgreesWithNeitherSideDoesNotMoveAMissedChange) {
  const Camera camera = flat_view();
  SurfaceCurve curve;
  double z = 0.0;
  add_way(camera, {-40.0, 0.0}, {40.0, 0.0}, 80, z, 1.0, curve);
  const CurveWalk walk(curve, camera);
  std::mt19937 random(random_seed());
  for (int i = 0; i < 200; ++i) {
    const double change = std::uniform_real_distribution<double>(5.0, 70.0)(random), noise = 37.5;
    const ChangeSearch search{walk,
                              [&](double place) {
                                if (std::fabs(place - noise) < 0.5 && std::fabs(place - change) > 1.0) return LayersSeen{4};
                                return LayersSeen{place < change ? 0 : 2};
                              },
                              [](double) { return 1.0; }};
    const auto found = find_missed(search, 0.0, 75.0);
    ASSERT_TRUE(found) << change;
    EXPECT_EQ(found->layers, 2) << change;
    EXPECT_NEAR(found->at, change, 2e-3);
  }
}

TEST(LineEvents, RaysBesideAFlatPiercingDoNotDenyIt) {
  // The line goes through a sheet 3 px before its end, so flatly that rays from beside it meet the sheet 2 px farther on only.
  const Camera camera = flat_view();
  SurfaceCurve curve;
  double z = 0.0;
  add_way(camera, {-40.0, 0.0}, {40.0, 0.0}, 80, z, 1.0, curve);
  curve.samples[76].pierced.push_back({0.0, 1, 4.0});
  const LayersBefore rays = [&](const CurveSample& sample) { return LayersSeen{sample.p.x > 3.85 ? 1 : 0}; };
  const CutCurves cut = cut_by_invisibility({curve}, camera, 5.0, rays, {});
  EXPECT_TRUE(cut.conflicts.empty());
  ASSERT_EQ(cut.curves[0].pieces.size(), 2u);
  EXPECT_EQ(cut.curves[0].pieces[0].invisibility, 0);
  EXPECT_EQ(cut.curves[0].pieces[1].invisibility, 1);
  EXPECT_NEAR(cut.curves[0].pieces[1].from, 76.0, 1e-6);
}

TEST(LineEvents, RaysBetweenALineAndANearerOneStartNearerToTheLine) {
  // The nearer sheet's open edge lets 2.6 px of the line be seen, over a gap of 0.06 px; rays start 0.1 px beside the line at first.
  const Camera camera = flat_view();
  SurfaceCurve behind, edge;
  double z = 0.0, z_edge = 4.0;
  add_way(camera, {-40.0, 0.0}, {40.0, 0.0}, 81, z, 1.0, behind);
  for (const auto& [from, to, steps] : {std::tuple(glm::dvec2(-20.0, -1.0), glm::dvec2(-1.0, 0.06), 40),
                                        {glm::dvec2(-1.0, 0.06), glm::dvec2(1.0, 0.06), 20},
                                        {glm::dvec2(1.0, 0.06), glm::dvec2(20.0, -1.0), 40}})
    add_way(camera, from, to, steps, z_edge, 1.0, edge);
  for (CurveSample& sample : edge.samples) sample.more_on_left = 1;
  const LayersBefore rays = [&](const CurveSample& sample) {
    if (sample.p.z > 3.0) return LayersSeen{0};
    return LayersSeen{std::fabs(sample.p.x) < 0.2 && sample.lift_share < 0.6 ? 0 : 1};
  };
  const CutCurves cut = cut_by_invisibility({behind, edge}, camera, 5.0, rays, {});
  EXPECT_TRUE(cut.conflicts.empty());
  std::vector<int> seen;
  for (const CurvePiece& piece : cut.curves[0].pieces) seen.push_back(piece.invisibility);
  EXPECT_EQ(seen, (std::vector<int>{1, 0, 1}));
}

/// Seen along the y axis, whose contours lie in the plane y = 0 where the field is its own mirror image there.
Camera view_from_above(int size_px) {
  CameraSettings settings;
  settings.target = {0.0, 0.0, 0.0};
  settings.eye = {0.0, 20.0, 0.0};
  settings.up = {0.0, 0.0, 1.0};
  settings.projection = Projection::orthographic;
  settings.ortho_height = 3.0;
  settings.width_px = settings.height_px = size_px;
  return resolve_camera(settings, {glm::dvec3(-1.5), glm::dvec3(1.5)});
}

double length_of(const std::vector<CurvePoint>& points) {
  double length = 0.0;
  for (size_t i = 0; i < points.size(); ++i) length += glm::distance(points[i].p, points[(i + 1) % points.size()].p);
  return length;
}

TEST(LineEvents, ContoursAreFollowedWholeAndOnceHoweverTheirSeedsWereJoined) {
  // A torus seen along its axis: its contours are circles of known lengths.
  constexpr double kMajor = 1.0, kMinor = 0.35;
  Field torus = make_shape("torus", {{"major", {kMajor}}, {"minor", {kMinor}}});
  const Camera camera = view_from_above(300);
  const Viewer viewer = make_viewer(camera, glm::dvec3(0.0));
  constexpr double kStep = 0.01;
  std::mt19937 random(random_seed());
  std::uniform_real_distribution<double> angle(0.0, 2.0 * kPi), off(-0.1 * kStep, 0.1 * kStep);
  FieldEvaluator evaluator(torus);
  for (int round = 0; round < 30; ++round) {
    // Points of both circles, in one strand, in no order.
    Strand strand;
    for (int i = 0; i < 300; ++i) {
      const double radius = i % 2 == 0 ? kMajor + kMinor : kMajor - kMinor, a = angle(random);
      CurvePoint point;
      point.p = glm::dvec3(radius * std::cos(a), 0.0, radius * std::sin(a)) + glm::dvec3(off(random), off(random), off(random));
      point.uphill = {0.0, 1.0, 0.0};
      strand.points.push_back(point);
    }
    std::vector<Strand> found = follow_strands({strand}, torus, camera, viewer, {0.005, kStep}, {});
    ASSERT_EQ(found.size(), 2u) << round;
    std::sort(found.begin(), found.end(), [](const Strand& a, const Strand& b) { return a.points.size() > b.points.size(); });
    EXPECT_NEAR(length_of(found[0].points), 2.0 * kPi * (kMajor + kMinor), 1e-3) << round;
    EXPECT_NEAR(length_of(found[1].points), 2.0 * kPi * (kMajor - kMinor), 1e-3) << round;
    for (const Strand& curve : found) {
      EXPECT_TRUE(curve.closed && curve.followed);
      for (const CurvePoint& point : curve.points) {
        EXPECT_NEAR(evaluator.value(point.p), 0.0, 1e-9);
        EXPECT_NEAR(point.p.y, 0.0, 1e-6);
      }
    }
  }
}

TEST(LineEvents, FollowedContoursHaveEveryCuspWhateverTheirLongestStep) {
  // A torus turned to where its cusps are born: two close to each other, within one long step.
  constexpr double kMajor = 1.0, kMinor = 0.35;
  const Field torus = make_shape("torus", {{"major", {kMajor}}, {"minor", {kMinor}}});
  int with_cusps = 0;
  for (double tilt = 30.0; tilt < 70.0; tilt += 0.25) {
    CameraSettings settings;
    settings.target = {0.0, 0.0, 0.0};
    settings.eye = 20.0 * glm::dvec3(0.0, std::cos(glm::radians(tilt)), std::sin(glm::radians(tilt)));
    settings.up = {1.0, 0.0, 0.0};
    settings.projection = Projection::orthographic;
    settings.ortho_height = 3.0;
    settings.width_px = settings.height_px = 20;
    const Camera camera = resolve_camera(settings, {glm::dvec3(-1.5), glm::dvec3(1.5)});
    const Viewer viewer = make_viewer(camera, glm::dvec3(0.0));
    const auto cusps = [&](double longest_step) {
      // From above the hole's inner side, where the contour has no cusps.
      Strand strand;
      CurvePoint point;
      point.p = {kMajor - kMinor, 0.0, 0.0};
      strand.points.push_back(point);
      const std::vector<Strand> found = follow_strands({strand}, torus, camera, viewer, {0.05, longest_step}, {});
      int changes = 0;
      for (const Strand& one : found) {
        for (size_t i = 0; i < one.points.size(); ++i)
          changes += (one.points[i].radial_curvature > 0.0) != (one.points[(i + 1) % one.points.size()].radial_curvature > 0.0);
      }
      return found.size() == 1 && found[0].followed ? changes : -1;
    };
    const int fine = cusps(0.01);
    ASSERT_GE(fine, 0) << tilt;
    with_cusps += fine > 0;
    EXPECT_EQ(cusps(0.4), fine) << tilt << " degrees";
  }
  EXPECT_GT(with_cusps, 10);
}

Strand strand_from(const std::vector<glm::dvec3>& points, bool rough) {
  Strand strand;
  for (const glm::dvec3& p : points) {
    CurvePoint point;
    point.p = p;
    point.rough = rough;
    strand.points.push_back(point);
  }
  return strand;
}

TEST(LineEvents, AStepGoesPastNoFoldThatIsNarrowerThanItself) {
  // A ball with a small one beside it: where they flow together the contour goes round the small one. Steps may be a pixel long.
  const Camera camera = view_from_above(15);
  const Viewer viewer = make_viewer(camera, glm::dvec3(0.0));
  std::mt19937 random(random_seed());
  int reached = 0;
  for (int round = 0; round < 60; ++round) {
    const double around = std::uniform_real_distribution<double>(0.0, 2.0 * kPi)(random),
                 radius = std::uniform_real_distribution<double>(0.015, 0.03)(random), away = 1.0 + 0.9 * radius;
    const Field field = make_shape(
        "metaballs", {{"centers", {0.0, 0.0, 0.0, away * std::cos(around), 0.0, away * std::sin(around)}}, {"radii", {1.0, radius}}});
    // From the other side.
    const Strand strand = strand_from({{-std::cos(around), 0.0, -std::sin(around)}}, false);
    const auto followed = [&](double longest_step) {
      const std::vector<Strand> found = follow_strands({strand}, field, camera, viewer, {0.5, longest_step}, {});
      return found.size() == 1 && found[0].followed ? found[0].points : std::vector<CurvePoint>{};
    };
    const double fine = length_of(followed(0.002));
    ASSERT_GT(fine, 6.0) << round;
    const std::vector<CurvePoint> coarse = followed(0.35);
    ASSERT_FALSE(coarse.empty()) << round;
    EXPECT_NEAR(length_of(coarse), fine, 0.02) << round << ", a ball of " << radius;
    reached += std::any_of(coarse.begin(), coarse.end(), [&](const CurvePoint& point) {
      return glm::distance(point.p, glm::dvec3(away * std::cos(around), 0.0, away * std::sin(around))) < 2.0 * radius;
    });
  }
  EXPECT_EQ(reached, 60);
}

TEST(LineEvents, ACurveOfManyPointsIsFollowedToItsEnd) {
  const Camera camera = view_from_above(300);
  const Field ball = make_shape("sphere", {{"radius", {1.0}}});
  const std::vector<Strand> found = follow_strands({strand_from({{1.0, 0.0, 0.0}}, false)}, ball, camera,
                                                   make_viewer(camera, glm::dvec3(0.0)), {0.005, 2.0 * kPi / 120'000.0}, {});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(found[0].followed);
  EXPECT_GT(found[0].points.size(), 100'000u);
  EXPECT_NEAR(length_of(found[0].points), 2.0 * kPi, 1e-6);
}

TEST(LineEvents, RoughStrandsBesideACurveAreToldByFinerCells) {
  // Crossings that lie off the ball, as cells find them beside a thin gap: the ball's contour is all there is, with its own strand or not.
  constexpr double kStep = 0.05;
  const Camera camera = view_from_above(300);
  const Field ball = make_shape("sphere", {{"radius", {1.0}}});
  std::mt19937 random(random_seed());
  std::uniform_real_distribution<double> off(-0.4 * kStep, 0.4 * kStep);
  for (int round = 0; round < 20; ++round) {
    const double around = std::uniform_real_distribution<double>(0.0, 2.0 * kPi)(random);
    std::vector<glm::dvec3> points;
    for (int i = 0; i < 8; ++i) {
      const double a = around + 0.5 * kStep * i;
      points.emplace_back(std::cos(a) + off(random), off(random), std::sin(a) + off(random));
    }
    std::vector<Strand> strands{strand_from(points, true)};
    if (round % 2 == 0) strands.insert(strands.begin(), strand_from({{1.0, 0.0, 0.0}}, false));
    const std::vector<Strand> found = follow_strands(strands, ball, camera, make_viewer(camera, glm::dvec3(0.0)), {0.005, kStep}, {});
    ASSERT_EQ(found.size(), 1u) << round;
    EXPECT_TRUE(found[0].followed) << round;
    EXPECT_NEAR(length_of(found[0].points), 2.0 * kPi, 1e-3) << round;
  }
}

Scene ball_of_voxels(double radius, double voxel) {
  LevelSetSettings settings;
  settings.voxel_size = voxel;
  settings.half_width_voxels = 4.0;
  Scene scene;
  scene.objects.push_back(
      {.name = "ball", .source = LevelSetSource{level_set_from_field(make_shape("sphere", {{"radius", {radius}}}), settings)}});
  return scene;
}

TEST(LineEvents, RaysThatGrazeALevelSetLeadToTheContourThatTheyPass) {
  constexpr double kVoxel = 0.02, kRadius = 0.8;
  const Scene scene = ball_of_voxels(kRadius, kVoxel);
  const Camera camera = flat_view();
  KeptLines kept;
  const LineTask task{scene, camera, glm::dvec3(0.0), 1.0, {}, kept};
  const LevelSetLayers layers({place_level_set(task, 0)}, {{0}}, camera);
  std::mt19937 random(random_seed());
  std::uniform_real_distribution<double> angle(0.0, 2.0 * kPi), within(1e-5 * kVoxel, 3e-4 * kVoxel);
  std::vector<CurveSample> grazing;
  for (int i = 0; i < 100; ++i) {
    const double a = angle(random), r = kRadius - within(random);
    CurveSample sample;
    sample.p = {r * std::cos(a), r * std::sin(a), -1.5};
    project_sample(camera, sample);
    const std::vector<glm::dvec3> points = layers.contours_before(sample);
    ASSERT_EQ(points.size(), 1u) << i;
    EXPECT_NEAR(std::hypot(points[0].x, points[0].y), kRadius, 1e-3 * kVoxel) << i;
    EXPECT_NEAR(points[0].z, 0.0, 0.2 * kVoxel) << i;
    EXPECT_LT(glm::distance(glm::dvec2(points[0]), glm::dvec2(sample.p)), 5e-3 * kVoxel) << i;
    // Not where the half circle below ends.
    if (std::fabs(sample.p.y) > 0.01) grazing.push_back(sample);
    // One that goes by, or through the middle, leads nowhere.
    sample.p = glm::dvec3((i % 2 == 0 ? 0.5 : 1.1) * kRadius * glm::dvec2(std::cos(a), std::sin(a)), -1.5);
    EXPECT_TRUE(layers.contours_before(sample).empty()) << i;
  }
  // Where a curve goes round the ball no contour was missed; where it goes half way round, the other half was.
  std::vector<LineContribution> contributions(1);
  contributions[0].contours_before = [&](const CurveSample& sample) { return layers.contours_before(sample); };
  SurfaceCurve circle;
  for (int i = 0; i < 2000; ++i) {
    CurveSample sample;
    sample.p = {kRadius * std::cos(2.0 * kPi * i / 2000.0), kRadius * std::sin(2.0 * kPi * i / 2000.0), 0.0};
    circle.samples.push_back(sample);
  }
  circle.closed = true;
  EXPECT_TRUE(missed_contours(grazing, contributions, {circle}).empty());
  circle.closed = false;
  circle.samples.resize(1000);
  const std::vector<glm::dvec3> missed = missed_contours(grazing, contributions, {circle});
  const auto below = std::count_if(grazing.begin(), grazing.end(), [](const CurveSample& sample) { return sample.p.y < 0.0; });
  EXPECT_EQ(static_cast<std::ptrdiff_t>(missed.size()), below);
  for (const glm::dvec3& p : missed) EXPECT_LT(p.y, 0.0);
}

TEST(LineEvents, RaysThatGrazeALevelSetGoThroughBothOfItsSheets) {
  // Within a hundredth of a voxel of a ball's silhouette both sheets lie within one of the ray's steps.
  constexpr double kVoxel = 0.02, kRadius = 0.8;
  const Scene scene = ball_of_voxels(kRadius, kVoxel);
  const Camera camera = flat_view();
  KeptLines kept;
  const LineTask task{scene, camera, glm::dvec3(0.0), 1.0, {}, kept};
  const SharedLevelSet placed = place_level_set(task, 0);
  const LevelSetLayers layers({placed}, {{0}}, camera);
  FieldEvaluator evaluator(placed->field);
  std::mt19937 random(random_seed());
  std::uniform_real_distribution<double> angle(0.0, 2.0 * kPi), off(-0.01 * kVoxel, 0.005 * kVoxel);
  int through = 0, past = 0;
  for (int i = 0; i < 400; ++i) {
    const double a = angle(random), r = kRadius + off(random);
    CurveSample sample;
    sample.p = {r * std::cos(a), r * std::sin(a), -1.5};
    project_sample(camera, sample);
    double least = std::numeric_limits<double>::infinity();
    for (int k = -4000; k <= 4000; ++k) least = std::min(least, evaluator.value({sample.p.x, sample.p.y, k * 0.0005 * kVoxel * 2.0}));
    if (std::fabs(least) < 1e-6 * kVoxel) continue;
    (least < 0.0 ? through : past) += 1;
    EXPECT_EQ(layers.before(sample).count, least < 0.0 ? 2 : 0) << i << ": " << least / kVoxel << " voxels";
  }
  EXPECT_GT(through, 50);
  EXPECT_GT(past, 20);
}

}  // namespace
}  // namespace limn
