// The solved border of scenes without a closed form, and at the edges of what there is to solve.

#include <fmt/core.h>

#include "raymarch/truth.h"
#include "tests/raymarch/border_distance.h"
#include "tests/raymarch/scenes.h"

namespace limn::test {
namespace {

constexpr double kThreshold = 0.4;

BorderTruth solved(const Scene& scene, const Camera& camera, int threads = 0, double threshold = kThreshold) {
  TruthSettings settings;
  settings.threshold = threshold;
  ExecutionSettings how;
  how.threads = threads;
  return solve_truth(scene, camera, settings, how);
}

Camera looking(const glm::dvec3& eye, const glm::dvec3& target, Projection projection, int width = 320, int height = 240) {
  CameraSettings settings = view(width, height, projection);
  settings.eye = eye;
  settings.target = target;
  if (projection == Projection::orthographic) settings.ortho_height = 2.6;
  return resolve_camera(settings, {});
}

/// A drilled block with a rounded boss on it: sharp, concave and blended seams.
Field block() {
  const Field body = make_shape("box", {{"half", {0.7, 0.35, 0.5}}});
  const Field boss = translate(make_shape("cylinder", {{"radius", {0.3}}, {"half_height", {0.4}}}), {-0.2, 0.4, 0.0});
  const Field drill = rotate(make_shape("cylinder", {{"radius", {0.16}}, {"half_height", {2.0}}}), {1.0, 0.2, 0.0}, 1.3);
  return combine(Csg::difference, combine(Csg::union_, body, boss, 0.12), translate(drill, {0.35, 0.0, 0.0}));
}

bool ink_at(const PointSample& sample, double threshold) {
  return sample.status == HitStatus::hit && static_cast<double>(sample.n_dot_v) < threshold;
}

/// Ink by counting, from a grid of rays, each at random in its cell, in each of a few pixels.
testing::AssertionResult has_coverage_of_rays(const Scene& scene, const Camera& camera, const BorderTruth& truth, const std::string& name) {
  constexpr int kGrid = 32;
  const SceneModel model = model_of(scene);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place;
  std::vector<glm::ivec2> mixed, others;
  for (int y = 0; y < truth.coverage.height; ++y) {
    for (int x = 0; x < truth.coverage.width; ++x) {
      const float share = truth.coverage.at(x, y);
      (share > 0.0f && share < 1.0f ? mixed : others).push_back({x, y});
    }
  }
  if (mixed.size() <= 100) return testing::AssertionFailure() << name << ": only " << mixed.size() << " pixels of mixed ink";
  Errors errors;
  std::string faults;
  for (int i = 0; i < 300; ++i) {
    const auto& from = i < 250 ? mixed : others;
    const glm::ivec2 pixel = from[random() % from.size()];
    std::vector<glm::dvec2> points;
    for (int k = 0; k < kGrid * kGrid; ++k)
      points.push_back(glm::dvec2(pixel) + (glm::dvec2(k % kGrid, k / kGrid) + glm::dvec2(place(random), place(random))) / double{kGrid});
    std::vector<PointSample> samples(points.size());
    sample_points(model, camera, points, samples);
    double ink = 0.0;
    for (const PointSample& sample : samples) ink += ink_at(sample, kThreshold) ? 1.0 / (kGrid * kGrid) : 0.0;
    const double error = std::fabs(ink - static_cast<double>(truth.coverage.at(pixel.x, pixel.y)));
    // The rays' own error: each of the grid's cells that a border goes through is a toss; three standard deviations of two borders.
    const double most = 3.0 * std::sqrt(2.0 * kGrid) / (kGrid * kGrid);
    if (!(error < most)) faults += fmt::format("pixel {}, {}: {} from the rays', should be below {}; ", pixel.x, pixel.y, error, most);
    errors.add(error);
  }
  if (!(errors.mean() < 1.0 / 256.0)) faults += fmt::format("mean difference {}, should be below {}; ", errors.mean(), 1.0 / 256.0);
  fmt::print("{}: coverage differs from rays by {:.5f} (mean), {:.4f} (worst)\n", name, errors.mean(), errors.largest);
  if (faults.empty()) return testing::AssertionSuccess();
  return testing::AssertionFailure() << name << ": " << faults;
}

struct Sides {
  int checked = 0, wrong = 0;
};

/// Whether each side of every step is what the curve says it is: steps into the picture by a fiftieth of a pixel.
Sides sides_of(const Scene& scene, const Camera& camera, const BorderTruth& truth) {
  const SceneModel model = model_of(scene);
  Sides sides;
  for (const BorderCurve& curve : truth.curves.curves) {
    for (size_t i = 0; i + 1 < curve.points.size(); i += 3) {
      const glm::dvec2 step = curve.points[i + 1].px - curve.points[i].px;
      if (glm::length(step) < 0.2) continue;
      const glm::dvec2 middle = 0.5 * (curve.points[i].px + curve.points[i + 1].px), away = glm::dvec2(-step.y, step.x) / glm::length(step);
      const std::array<glm::dvec2, 2> points = {middle - 0.03 * away, middle + 0.03 * away};
      std::array<PointSample, 2> samples;
      sample_points(model, camera, points, samples);
      const double depth = curve.points[i].depth;
      const auto depth_of = [&](const PointSample& s) { return s.status == HitStatus::hit ? project(camera, s.position).z : 1e9; };
      ++sides.checked;
      if (curve.kind == CurveKind::silhouette) {
        // Left is the near sheet; right is farther away, or something that is not this sheet.
        sides.wrong += !(samples[0].id == curve.object && std::fabs(depth_of(samples[0]) - depth) < 0.1 &&
                         depth_of(samples[1]) > depth_of(samples[0]));
      } else {
        sides.wrong += !(ink_at(samples[0], kThreshold) && samples[1].status == HitStatus::hit && !ink_at(samples[1], kThreshold));
      }
    }
  }
  return sides;
}

TEST(Truth, CoverageAndSidesAreWhatRaysSee) {
  const Scene scene = scene_of({object_of(block())});
  for (const Projection projection : {Projection::orthographic, Projection::perspective}) {
    const Camera camera = looking({2.1, 2.4, 2.9}, {0.0, 0.1, 0.0}, projection);
    const BorderTruth truth = solved(scene, camera);
    const std::string name = projection == Projection::perspective ? "block, perspective" : "block, parallel";
    EXPECT_LT(truth.bound_px, 0.01) << name;
    for (const std::string& note : truth.notes) fmt::print("{}: {}\n", name, note);
    EXPECT_TRUE(has_coverage_of_rays(scene, camera, truth, name));
    const Sides sides = sides_of(scene, camera, truth);
    fmt::print("{}: {} of {} steps do not have what they bound on the left\n", name, sides.wrong, sides.checked);
    EXPECT_GT(sides.checked, 100) << name;
    // At corners a side is not what it is along the curve.
    EXPECT_LE(sides.wrong, sides.checked / 50) << name;
  }
}

TEST(Truth, IsTheSameForAnyNumberOfThreads) {
  const Scene scene = scene_of({object_of(block()), object_of(translate(make_shape("sphere", {{"radius", {0.4}}}), {0.3, 0.6, 0.4}))});
  const Camera camera = looking({2.1, 2.4, 2.9}, {0.0, 0.1, 0.0}, Projection::perspective);
  const BorderTruth a = solved(scene, camera, 1), b = solved(scene, camera, 3);
  EXPECT_EQ(a.coverage.pixels, b.coverage.pixels);
  EXPECT_EQ(a.notes, b.notes);
  EXPECT_EQ(a.bound_px, b.bound_px);
  ASSERT_EQ(a.curves.curves.size(), b.curves.curves.size());
  for (size_t i = 0; i < a.curves.curves.size(); ++i) {
    const auto &p = a.curves.curves[i].points, &q = b.curves.curves[i].points;
    ASSERT_EQ(p.size(), q.size());
    for (size_t k = 0; k < p.size(); ++k) ASSERT_EQ(p[k].px, q[k].px);
  }
}

double total_length(const BorderTruth& truth, CurveKind kind) {
  double length = 0.0;
  for (const BorderCurve& curve : truth.curves.curves) {
    const size_t n = curve.points.size();
    for (size_t i = 0; i + (curve.closed ? 0 : 1) < n; ++i) {
      length += curve.kind == kind ? glm::distance(curve.points[i].px, curve.points[(i + 1) % n].px) : 0.0;
    }
  }
  return length;
}

/// The farthest that a point of one is from the other.
double apart(const BorderTruth& a, const BorderTruth& b) {
  double worst = 0.0;
  for (const BorderCurve& curve : a.curves.curves) {
    for (const BorderPoint& point : curve.points) worst = std::max(worst, distance_to(b.curves, {}, point.px));
  }
  for (const BorderCurve& curve : b.curves.curves) {
    for (const BorderPoint& point : curve.points) worst = std::max(worst, distance_to(a.curves, {}, point.px));
  }
  return worst;
}

TEST(Truth, IsTheSameFarFromTheOriginAndAtOtherScales) {
  const glm::dvec3 eye(2.1, 2.4, 2.9), target(0.0, 0.1, 0.0);
  const BorderTruth plain = solved(scene_of({object_of(block())}), looking(eye, target, Projection::perspective));
  const glm::dvec3 far(1e6, -2e6, 5e5);
  const BorderTruth away =
      solved(scene_of({object_of(translate(block(), far))}), looking(eye + far, target + far, Projection::perspective));
  EXPECT_LT(apart(plain, away), plain.bound_px + 1e-4);
  for (const double factor : {1e-3, 1e3}) {
    const BorderTruth scaled =
        solved(scene_of({object_of(scale(block(), factor))}), looking(factor * eye, factor * target, Projection::perspective));
    EXPECT_LT(apart(plain, scaled), plain.bound_px + 1e-4) << factor;
    EXPECT_EQ(plain.contour_generators, scaled.contour_generators);
  }
}

TEST(Truth, WhatIsBehindAnotherObjectIsLeftOutButCounted) {
  const Field ball = make_shape("sphere", {{"radius", {0.5}}});
  const Camera camera = looking({0.0, 0.0, 4.0}, {0.0, 0.0, 0.0}, Projection::perspective);
  const BorderTruth hidden = solved(scene_of({object_of(ball), object_of(translate(scale(ball, 0.5), {0.0, 0.0, -2.0}))}), camera);
  EXPECT_EQ(hidden.contour_generators, 2);
  EXPECT_EQ(hidden.level_curves, 2);
  ASSERT_EQ(hidden.curves.curves.size(), 2u);
  for (const BorderCurve& curve : hidden.curves.curves) EXPECT_EQ(curve.object, 1);

  // Half behind: its own outline ends on the nearer one, to the bound.
  const Camera aside = looking({0.9, 0.0, 4.0}, {0.0, 0.0, 0.0}, Projection::perspective);
  const Scene scene = scene_of({object_of(ball), object_of(translate(ball, {0.4, 0.1, -1.5}))});
  const BorderTruth half = solved(scene, aside);
  const BorderTruth alone = solved(scene_of({object_of(ball)}), aside);
  int ends = 0;
  for (const BorderCurve& curve : half.curves.curves) {
    if (curve.closed) continue;
    EXPECT_EQ(curve.object, 2);
    for (const BorderPoint* end : {&curve.points.front(), &curve.points.back()}) {
      ++ends;
      EXPECT_LT(distance_to(alone.curves, {}, end->px), half.bound_px);
    }
  }
  EXPECT_GE(ends, 2);
  EXPECT_EQ(ends % 2, 0);
}

TEST(Truth, OverlappingObjectsHideWhatIsInsideTheOther) {
  const Field ball = make_shape("sphere", {{"radius", {0.6}}});
  const Scene two = scene_of({object_of(translate(ball, {-0.35, 0.0, 0.0})), object_of(translate(ball, {0.35, 0.05, 0.1}))});
  const Camera camera = looking({0.4, 0.7, 3.0}, {0.0, 0.0, 0.0}, Projection::orthographic);
  const BorderTruth truth = solved(two, camera);
  const SceneModel model = model_of(two);
  for (const BorderCurve& curve : truth.curves.curves) {
    for (const BorderPoint& point : curve.points) {
      const glm::dvec3 a(-0.35, 0.0, 0.0), b(0.35, 0.05, 0.1);
      EXPECT_GT(glm::distance(point.position, curve.object == 1 ? b : a), 0.6 - 1e-5);
    }
  }
  EXPECT_LT(total_length(truth, CurveKind::silhouette), 2.0 * 2.0 * 3.1415926536 * 0.6 * camera.pixels_per_unit);
  EXPECT_TRUE(has_coverage_of_rays(two, camera, truth, "two balls"));
  // Touching in a point: both outlines whole.
  const Scene touching = scene_of({object_of(translate(ball, {-0.6, 0.0, 0.0})), object_of(translate(ball, {0.6, 0.0, 0.0}))});
  const BorderTruth both = solved(touching, looking({0.0, 0.0, 3.0}, {0.0, 0.0, 0.0}, Projection::orthographic));
  EXPECT_NEAR(total_length(both, CurveKind::silhouette), 2.0 * 2.0 * 3.1415926536 * 0.6 * 240.0 / 2.6, 0.5);
}

TEST(Truth, CuspsComeInPairsWhereTheTorusIsThick) {
  // Parallel projection: cusps where minor > major cos^2(angle of axis and view).
  const double major = 1.0, minor = 0.38;
  const Scene scene = scene_of({object_of(make_shape("torus", {{"major", {major}}, {"minor", {minor}}}))});
  for (const double degrees : {20.0, 35.0, 45.0, 60.0, 70.0}) {
    const double angle = degrees * 3.1415926536 / 180.0;
    const Camera camera =
        looking(5.0 * glm::dvec3(std::sin(angle) * 0.8, std::cos(angle), std::sin(angle) * 0.6), {}, Projection::orthographic);
    const BorderTruth truth = solved(scene, camera, 0, 0.0);
    int cusps = 0;
    for (const BorderCurve& curve : truth.curves.curves) {
      if (curve.closed) continue;
      for (const BorderPoint* end : {&curve.points.front(), &curve.points.back()}) cusps += std::fabs(end->radial_curvature) < 0.05;
    }
    EXPECT_EQ(truth.contour_generators, 2) << degrees;
    EXPECT_EQ(cusps % 2, 0) << degrees;
    EXPECT_EQ(cusps > 0, minor > major * std::cos(angle) * std::cos(angle)) << degrees;
  }
}

TEST(Truth, SeenExactlyEdgeOnFacesCountOnce) {
  // All sides of a box along the view: the outline is the front's, and no side is drawn twice or torn.
  const Scene scene = scene_of({object_of(make_shape("box", {{"half", {0.5, 0.4, 0.6}}}))});
  const BorderTruth truth = solved(scene, looking({0.0, 0.0, 3.0}, {0.0, 0.0, 0.0}, Projection::orthographic));
  EXPECT_EQ(truth.contour_generators, 1);
  EXPECT_NEAR(total_length(truth, CurveKind::silhouette), 2.0 * (1.0 + 0.8) * 240.0 / 2.6, 0.1);
}

TEST(Truth, NothingToSeeIsNoBorder) {
  const Scene scene = scene_of({object_of(make_shape("sphere", {{"radius", {0.5}}}))});
  const BorderTruth away = solved(scene, looking({0.0, 0.0, 4.0}, {0.0, 0.0, 8.0}, Projection::perspective));
  EXPECT_TRUE(away.curves.curves.empty());
  EXPECT_EQ(*std::max_element(away.coverage.pixels.begin(), away.coverage.pixels.end()), 0.0f);
  const BorderTruth none = solved(scene_of({}), looking({0.0, 0.0, 4.0}, {0.0, 0.0, 0.0}, Projection::perspective));
  EXPECT_TRUE(none.curves.curves.empty());
  EXPECT_EQ(none.coverage.pixels.size(), 320u * 240u);
}

TEST(Truth, FromInsideThereIsNoBorder) {
  const Scene scene = scene_of({object_of(make_shape("sphere", {{"radius", {0.5}}}))});
  const BorderTruth truth = solved(scene, looking({0.1, 0.0, 0.2}, {0.0, 0.0, 0.0}, Projection::perspective));
  EXPECT_TRUE(truth.curves.curves.empty());
}

TEST(Truth, APlaneIsFollowedAroundTheScene) {
  const Scene scene = scene_of({object_of(make_shape("plane"))});
  const Camera camera = looking({0.0, 1.0, 3.0}, {0.0, 0.0, 0.0}, Projection::perspective);
  const BorderTruth truth = solved(scene, camera);
  EXPECT_FALSE(truth.notes.empty());
}

TEST(Truth, RefusesWhatIsNoThreshold) {
  const Scene scene = scene_of({object_of(make_shape("sphere"))});
  const Camera camera = looking({0.0, 0.0, 4.0}, {0.0, 0.0, 0.0}, Projection::perspective);
  for (const double threshold : {-0.1, 1.0, std::nan("")}) EXPECT_THROW(solved(scene, camera, 0, threshold), InputError);
}

TEST(Truth, StopsWhenToldTo) {
  const Scene scene = scene_of({object_of(block())});
  ExecutionSettings how;
  how.cancelled = [] { return true; };
  EXPECT_THROW(solve_truth(scene, looking({2.1, 2.4, 2.9}, {}, Projection::perspective), {}, how), Cancelled);
}

}  // namespace
}  // namespace limn::test
