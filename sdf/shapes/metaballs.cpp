// Blobs that flow together: the surface is where the density sum of (radius_i / distance_i)^4 equals `level` (the idea of a density sum is
// Blinn's, "A generalization of algebraic surface drawing", 1982; the inverse fourth power is ours). Taken to the power -1/4 the sum is
//   G = (sum of u_i^-4)^(-1/4),   u_i = distance_i / radius_i,   f = (G - level^(-1/4)) * least radius,
// which grows like a distance far away instead of saturating. The weights dG/du_i = (G/u_i)^5 are at most (G/u_i)^4 and so add up to no
// more than 1; each u_i has slope 1/radius_i: f is no steeper than 1 anywhere.

#include <algorithm>
#include <cmath>
#include <limits>

#include "sdf/shapes/entry.h"

namespace limn {
namespace {

struct Ball {
  glm::dvec3 center;
  double inverse_radius;
};

struct Metaballs {
  std::vector<Ball> balls;
  double threshold;  // of G
  double least_radius;

  template <class T>
  T scaled_distance(const Ball& ball, const Vector3<T>& p) const {
    return norm(p.x - scalar<T>(ball.center.x), p.y - scalar<T>(ball.center.y), p.z - scalar<T>(ball.center.z)) *
           scalar<T>(ball.inverse_radius);
  }

  template <class T>
  T joined(const Vector3<T>& p) const {
    if constexpr (Real<T>) {
      T density(0);  // infinite in a centre, where G is 0
      for (const Ball& ball : balls) density += T(1) / square(square(scaled_distance(ball, p)));
      return T(1) / std::sqrt(std::sqrt(density));
    } else {
      T result = scaled_distance(balls[0], p);
      for (size_t i = 1; i < balls.size(); ++i) result = power_norm(result, scaled_distance(balls[i], p), -4.0);
      return result;
    }
  }

  template <class T>
  T operator()(const Vector3<T>& p) const {
    return (joined(p) - scalar<T>(threshold)) * scalar<T>(least_radius);
  }

  /// Beyond the plane dot(direction, p) = s no density exceeds that of all balls at their distances from the plane; where that is
  /// below the one wanted there is no surface. Bisection from above keeps the safe side.
  double support(const glm::dvec3& direction, double level) const {
    const double length = glm::length(direction);
    const double wanted = threshold + level / least_radius;
    if (!(wanted > 0.0)) return -std::numeric_limits<double>::infinity();
    const double density_wanted = std::pow(wanted, -4.0);
    const double count = static_cast<double>(balls.size());
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Ball& ball : balls) {
      const double at = glm::dot(direction, ball.center) / length;
      low = std::min(low, at);
      high = std::max(high, at + wanted * std::pow(count, 0.25) / ball.inverse_radius);
    }
    const auto may_reach = [&](double s) {
      double density = 0.0;
      for (const Ball& ball : balls) {
        const double away = std::max(0.0, s - glm::dot(direction, ball.center) / length) * ball.inverse_radius;
        density += std::pow(away, -4.0);
      }
      return density >= density_wanted;
    };
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (may_reach(middle) ? low : high) = middle;
    }
    return high * length;
  }
};

Field make(const Parameters& p) {
  const auto centers = p.list("centers");
  const auto radii = p.list("radii");
  if (radii.size() != centers.size() / 3) {
    combination_fault("metaballs.radii", static_cast<double>(radii.size()), "not one radius for each centre",
                      fmt::format("{} radii for these centers", centers.size() / 3));
  }
  Metaballs shape;
  shape.least_radius = *std::min_element(radii.begin(), radii.end());
  shape.threshold = std::pow(p.number("level"), -0.25);
  for (size_t i = 0; i < radii.size(); ++i) {
    shape.balls.push_back({{centers[3 * i], centers[3 * i + 1], centers[3 * i + 2]}, 1.0 / radii[i]});
  }
  const bool is_sphere = shape.balls.size() == 1;
  return field_from_shape(std::move(shape), 1.0, is_sphere);
}

}  // namespace

ShapeDescriptor describe_metaballs() {
  Parameter level =
      length_parameter("level", 1.0, "density at the surface: 1 keeps a lone ball at its radius, less makes all of them grow");
  level.unit.clear();
  return {{"metaballs", "balls that flow together", "density sum after Blinn 1982, inverse fourth power; limn"},
          {list_parameter("centers", {-0.55, -0.2, 0.1, 0.45, -0.25, -0.2, 0.05, 0.5, 0.0, 0.25, -0.1, 0.55}, -greatest_length, 3,
                          "[x, y, z] each"),
           list_parameter("radii", {0.45, 0.5, 0.4, 0.3}, least_length, 1, "one for each centre: the ball's radius when alone"), level},
          make};
}

}  // namespace limn
