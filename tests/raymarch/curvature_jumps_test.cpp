// Contours that go from one face to another of another curvature: what rounding cannot say is left to rays.

#include "raymarch/lines/curvature_jumps.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/random_seed.h"

namespace limn {
namespace {

/// A contour in the plane z = 0 of faces whose normal is z there, which bends by `turn` radians where the curvature jumps. The eye looks
/// along y.
SurfaceCurve bent_contour(double turn, double before, double after) {
  SurfaceCurve curve;
  curve.smooth = true;
  for (int i = -3; i <= 3; ++i) {
    if (i == 0) continue;
    CurveSample sample;
    const glm::dvec3 way = i < 0 ? glm::dvec3(1.0, 0.0, 0.0) : glm::dvec3(std::cos(turn), std::sin(turn), 0.0);
    sample.p = 0.01 * i * way;
    sample.high = sample.low = {0.0, 0.0, 1.0};
    sample.radial_curvature = i < 0 ? before : after;
    curve.samples.push_back(sample);
  }
  return curve;
}

Camera from_side() {
  Camera camera;
  camera.eye = {0.3, 50.0, 0.0};
  return camera;
}

TEST(CurvatureJumps, SayNothingWhereTheContourRunsAlongTheFacesLine) {
  std::mt19937 random(random_seed());
  std::uniform_real_distribution<double> size(1.0, 20.0), rounding(-1e-9, 1e-9);
  const Camera camera = from_side();
  for (int k = 0; k < 100; ++k) {
    const double before = size(random), after = -size(random);
    // Straight on: S v of both faces points across the contour, so that their common line runs along it.
    const SurfaceCurve straight = bent_contour(rounding(random), before, after);
    const auto none = jump_at({straight, 2, 3, camera});
    ASSERT_TRUE(none);
    EXPECT_FALSE(none->layers);
    const SurfaceCurve bent = bent_contour(0.6, before, after);
    const auto one = jump_at({bent, 2, 3, camera});
    ASSERT_TRUE(one && one->layers);
    // Walked the other way the same place adds what it took away.
    SurfaceCurve back = bent;
    std::reverse(back.samples.begin(), back.samples.end());
    const auto other = jump_at({back, 2, 3, camera});
    ASSERT_TRUE(other && other->layers);
    EXPECT_EQ(*other->layers, -*one->layers);
  }
}

}  // namespace
}  // namespace limn
