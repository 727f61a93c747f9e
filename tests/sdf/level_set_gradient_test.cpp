#include <fmt/core.h>
#include <gtest/gtest.h>

#include "sdf/error.h"
#include "tests/random_seed.h"
#include "tests/sdf/level_set_maker.h"

namespace limn {
namespace {

using testing_tools::brute_force_level_set;
using testing_tools::Ellipsoid;

struct Polynomial {
  std::function<double(const glm::dvec3&)> value;
  std::function<glm::dvec3(const glm::dvec3&)> gradient;
  std::function<glm::dmat3(const glm::dvec3&)> hessian;
};

Polynomial linear() {
  return {[](const glm::dvec3& p) { return 3.0 * p.x - 2.0 * p.y + 5.0 * p.z + 1.0; },
          [](const glm::dvec3&) { return glm::dvec3(3.0, -2.0, 5.0); }, [](const glm::dvec3&) { return glm::dmat3(0.0); }};
}

/// Every monomial kind of degree 3, with mixed terms.
Polynomial cubic() {
  return {[](const glm::dvec3& p) { return p.x * p.x * p.x - 2.0 * p.x * p.x * p.y + p.x * p.y * p.z + 3.0 * p.z * p.z - p.y * p.z * p.z; },
          [](const glm::dvec3& p) {
            return glm::dvec3(3.0 * p.x * p.x - 4.0 * p.x * p.y + p.y * p.z, -2.0 * p.x * p.x + p.x * p.z - p.z * p.z,
                              p.x * p.y + 6.0 * p.z - 2.0 * p.y * p.z);
          },
          [](const glm::dvec3& p) {
            return glm::dmat3(6.0 * p.x - 4.0 * p.y, -4.0 * p.x + p.z, p.y, -4.0 * p.x + p.z, 0.0, p.x - 2.0 * p.z, p.y, p.x - 2.0 * p.z,
                              6.0 - 2.0 * p.y);
          }};
}

/// Node values are small multiples of powers of two: exact in float, so that errors below are the reconstruction's.
LevelSet sampled(const Polynomial& polynomial, double voxel_size) {
  return brute_force_level_set(polynomial.value, {-2, -2, -2}, {2, 2, 2}, voxel_size, 4.0, true);
}

double worst_gradient(const GradientDescriptor& gradient, const Polynomial& polynomial, double voxel_size) {
  const LevelSet level_set = sampled(polynomial, voxel_size);
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> place(-8.0 * voxel_size, 8.0 * voxel_size);
  double worst = 0.0;
  for (int i = 0; i < 500; ++i) {
    const glm::dvec3 p(place(random), place(random), i % 5 == 0 ? voxel_size * (i % 7 - 3) : place(random));
    glm::dvec3 found;
    gradient.gradients(level_set.data(), std::span(&p, 1), std::span(&found, 1));
    worst = std::max(worst, glm::distance(found, polynomial.gradient(p)));
  }
  return worst;
}

TEST(LevelSetGradients, EveryGradientIsExactOnLinearFields) {
  for (const GradientDescriptor& gradient : gradients())
    for (const double h : {1.0, 0.25}) EXPECT_LT(worst_gradient(gradient, linear(), h), 1e-11) << gradient.about.name << " at " << h;
}

TEST(LevelSetGradients, TheSplineIsExactOnCubicFieldsAndTheOthersAreNot) {
  for (const double h : {1.0, 0.25}) EXPECT_LT(worst_gradient(find_gradient("cubic"), cubic(), h), 1e-9) << h;
  EXPECT_GT(worst_gradient(find_gradient("central"), cubic(), 1.0), 0.1);
  EXPECT_GT(worst_gradient(find_gradient("cell"), cubic(), 1.0), 0.5);
}

TEST(LevelSetGradients, TheSplinesHessianIsExactOnCubicFields) {
  for (const double h : {1.0, 0.25}) {
    const LevelSet level_set = sampled(cubic(), h);
    std::mt19937_64 random(8);
    std::uniform_real_distribution<double> place(-8.0 * h, 8.0 * h);
    for (int i = 0; i < 300; ++i) {
      const glm::dvec3 p(place(random), place(random), place(random));
      FieldJet jet;
      find_gradient("cubic").hessians(level_set.data(), std::span(&p, 1), std::span(&jet, 1));
      EXPECT_NEAR(jet.value, cubic().value(p), 1e-8);
      EXPECT_LT(glm::distance(jet.gradient, cubic().gradient(p)), 1e-9);
      for (int c = 0; c < 3; ++c) EXPECT_LT(glm::distance(jet.hessian[c], cubic().hessian(p)[c]), 1e-9);
    }
  }
}

/// A gradient must not change by a bit when nodes outside the half width that it declares do; and a band a tenth of a voxel thinner
/// must be too thin for some point, or the declaration is wider than needed.
double largest_change(const GradientDescriptor& gradient, double half_width, std::uint64_t seed) {
  const Ellipsoid shape = Ellipsoid::jittered(seed);
  const double h = 0.08;
  const auto true_distance = [&](const glm::dvec3& p) { return shape.distance(p); };
  const auto spoiled = [&](const glm::dvec3& p) {
    const double d = shape.distance(p);
    return std::abs(d) <= half_width * h ? d : std::copysign(100.0, d);
  };
  const LevelSet whole = brute_force_level_set(true_distance, {-2, -2, -2}, {4, 4, 4}, h, 6.0, true);
  const LevelSet cut = brute_force_level_set(spoiled, {-2, -2, -2}, {4, 4, 4}, h, 6.0, true);
  std::mt19937_64 random(seed);
  double worst = 0.0;
  for (int i = 0; i < 30'000; ++i) {
    const glm::dvec3 p = shape.surface_point(testing_tools::random_direction(random));
    glm::dvec3 a, b;
    gradient.gradients(whole.data(), std::span(&p, 1), std::span(&a, 1));
    gradient.gradients(cut.data(), std::span(&p, 1), std::span(&b, 1));
    worst = std::max(worst, glm::distance(a, b));
  }
  return worst;
}

TEST(LevelSetGradients, NoStencilLeavesTheDeclaredBandAndTheBandIsNoWiderThanNeeded) {
  const std::uint64_t seed = 20;
  for (const GradientDescriptor& gradient : gradients()) {
    EXPECT_EQ(largest_change(gradient, gradient.half_width_voxels, seed), 0.0) << gradient.about.name;
    // The outermost node of the spline has next to no weight until the point is well inside the corner; hence the different margins.
    const double margin = gradient.about.name == "cubic" ? 0.6 : 0.15;
    EXPECT_GT(largest_change(gradient, gradient.half_width_voxels - margin, seed), 0.0) << gradient.about.name;
  }
}

struct Errors {
  double worst = 0.0, rms = 0.0;
};

/// Angles between the reconstructed and the true normal at exact surface points.
Errors normal_errors(const GradientDescriptor& gradient, const LevelSet& level_set, const Ellipsoid& shape, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<glm::dvec3> points(20'000), found(points.size());
  for (glm::dvec3& p : points) p = shape.surface_point(testing_tools::random_direction(random));
  gradient.gradients(level_set.data(), points, found);
  Errors errors;
  for (size_t i = 0; i < points.size(); ++i) {
    const glm::dvec3 truth = shape.normal(points[i]);
    const double angle = std::atan2(glm::length(glm::cross(found[i], truth)), glm::dot(found[i], truth));
    errors.worst = std::max(errors.worst, angle);
    errors.rms += angle * angle;
  }
  errors.rms = std::sqrt(errors.rms / static_cast<double>(points.size()));
  return errors;
}

testing::AssertionResult has_its_order(const GradientDescriptor& gradient, bool exact_distances, double first_h, std::uint64_t seed) {
  const Ellipsoid shape = Ellipsoid::jittered(seed);
  std::array<Errors, 3> errors;
  for (size_t k = 0; k < 3; ++k) {
    const double h = first_h / static_cast<double>(1 << k), width = std::max(1.8, gradient.half_width_voxels);
    const int blocks = static_cast<int>(std::ceil(1.4 / h / 8.0));
    const glm::ivec3 middle(glm::round(shape.center / h / 8.0));
    const LevelSet level_set = exact_distances
                                   ? brute_force_level_set([&](const glm::dvec3& p) { return shape.distance_within(p, width * h); },
                                                           middle - blocks, middle + blocks, h, width)
                                   : level_set_from_field(shape.field(), {.voxel_size = h, .half_width_voxels = width});
    errors[k] = normal_errors(gradient, level_set, shape, seed);
  }
  const double worst_order = 0.5 * std::log2(errors[0].worst / errors[2].worst);
  const double rms_order = 0.5 * std::log2(errors[0].rms / errors[2].rms);
  const std::string figures = fmt::format(
      "{:8} seed {}: worst {:.2e} {:.2e} {:.2e} (order {:.2f}), rms {:.2e} {:.2e} {:.2e} (order {:.2f})", gradient.about.name, seed,
      errors[0].worst, errors[1].worst, errors[2].worst, worst_order, errors[0].rms, errors[1].rms, errors[2].rms, rms_order);
  fmt::print("{}\n", figures);
  const double least = gradient.order == 3 ? 2.7 : gradient.order - 0.2;
  const auto failure = [&](double order) { return testing::AssertionFailure() << figures << "; order " << order; };
  if (!(worst_order >= least)) return failure(worst_order) << " of the worst should be at least " << least;
  if (!(rms_order >= least)) return failure(rms_order) << " of the rms should be at least " << least;
  if (!(rms_order < gradient.order + 1.0)) return failure(rms_order) << " of the rms is better than it can be: the test is blind";
  return testing::AssertionSuccess();
}

std::uint64_t recorded_seed() {
  const std::uint64_t seed = random_seed();
  testing::Test::RecordProperty("seed", std::to_string(seed));
  return seed;
}

TEST(LevelSetGradients, NormalsOfAJitteredEllipsoidConvergeWithTheirOrderOnExactDistances) {
  const std::uint64_t seed = recorded_seed();
  for (const GradientDescriptor& gradient : gradients()) EXPECT_TRUE(has_its_order(gradient, true, 0.06, seed));
}

TEST(LevelSetGradients, NormalsOfAJitteredEllipsoidConvergeWithTheirOrderOnTheBuildersDistances) {
  const std::uint64_t seed = recorded_seed();
  for (const GradientDescriptor& gradient : gradients()) EXPECT_TRUE(has_its_order(gradient, false, 0.05, seed));
}

TEST(LevelSetGradients, UnknownNamesAreAnsweredWithTheNearest) {
  try {
    find_gradient("cubik", "scene.toml", "surface.gradient");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("did you mean 'cubic'"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace limn
