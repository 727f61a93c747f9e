// The cubic spline's value, gradient and Hessian against sums over all 64 coefficients.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "sdf/gradients/spline_jet.h"
#include "tests/random_seed.h"
#include "tests/simd_targets.h"

namespace limn::test {
namespace {

/// The spline of one coefficient along one axis, `order` times derived: of the node k - 1 at local place u, by truncated powers.
double basis(int k, double u, int order) {
  const double x = u - (k - 1);
  double sum = 0.0;
  const double binomials[] = {1.0, -4.0, 6.0, -4.0, 1.0};
  for (int i = 0; i <= 4; ++i) {
    const double from = x + 2.0 - i;
    if (from <= 0.0) continue;
    sum += binomials[i] * (order == 0 ? from * from * from / 6.0 : order == 1 ? from * from / 2.0 : from);
  }
  return sum;
}

double brute_force(const SplineCoefficients& c, const glm::dvec3& local, const glm::ivec3& order) {
  double sum = 0.0;
  for (int x = 0; x < 4; ++x)
    for (int y = 0; y < 4; ++y)
      for (int z = 0; z < 4; ++z)
        sum += c[spline_place(x, y, z)] * basis(x, local.x, order.x) * basis(y, local.y, order.y) * basis(z, local.z, order.z);
  return sum;
}

bool same_bits(const FieldJet& a, const FieldJet& b) { return a.value == b.value && a.gradient == b.gradient && a.hessian == b.hessian; }

TEST(SplineJet, IsTheSumOverAllCoefficients) {
  std::mt19937 random(random_seed());
  std::uniform_real_distribution<double> real(0.0, 1.0);
  constexpr double kNear = 1e-12;
  for (int round = 0; round < 200; ++round) {
    SplineCoefficients c;
    for (double& one : c) one = 4.0 * real(random) - 2.0;
    const glm::dvec3 local(real(random), real(random), round % 7 == 0 ? static_cast<double>(random() % 2) : real(random));
    const FieldJet jet = spline_jet(c, local), slope = slope_of_spline(c, local);
    EXPECT_NEAR(jet.value, brute_force(c, local, {0, 0, 0}), kNear);
    EXPECT_NEAR(slope.value, jet.value, kNear);
    EXPECT_EQ(value_of_spline(c, local), slope.value);
    EXPECT_EQ(spline_value(c, local), jet.value);
    for (int a = 0; a < 3; ++a) {
      glm::ivec3 order(0);
      ++order[a];
      EXPECT_NEAR(jet.gradient[a], brute_force(c, local, order), kNear);
      EXPECT_NEAR(slope.gradient[a], jet.gradient[a], kNear);
      for (int b = 0; b < 3; ++b) {
        glm::ivec3 twice = order;
        ++twice[b];
        EXPECT_NEAR(jet.hessian[a][b], brute_force(c, local, twice), kNear) << a << b;
      }
    }
    for_each_simd_target(
        [&](const char* target) { EXPECT_TRUE(same_bits(spline_jet(c, local), jet) && spline_value(c, local) == jet.value) << target; });
  }
}

}  // namespace
}  // namespace limn::test
