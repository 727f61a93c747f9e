#pragma once
// Level sets and truths for the tests, made without the code under test: an ellipsoid's exact distance, and grids by brute force.

#include <cmath>
#include <functional>
#include <random>

#include "sdf/level_set.h"
#include "sdf/shape.h"

namespace limn::testing_tools {

inline glm::dvec3 random_direction(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
}

/// An ellipsoid anywhere, turned anyhow.
struct Ellipsoid {
  glm::dvec3 radii{1.0, 0.7, 0.5};
  glm::dvec3 center{0.0};
  glm::dvec3 axis{0.0, 1.0, 0.0};
  double angle = 0.0;

  static Ellipsoid jittered(std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> unit;
    Ellipsoid e;
    e.center = {unit(random), unit(random), unit(random)};
    e.axis = random_direction(random);
    e.angle = 6.28 * unit(random);
    return e;
  }

  /// Rodrigues' rotation.
  glm::dvec3 turned(const glm::dvec3& p, double by) const {
    return p * std::cos(by) + glm::cross(axis, p) * std::sin(by) + axis * (glm::dot(axis, p) * (1.0 - std::cos(by)));
  }
  glm::dvec3 to_body(const glm::dvec3& world) const { return turned(world - center, -angle); }
  glm::dvec3 to_world(const glm::dvec3& body) const { return turned(body, angle) + center; }

  Field field() const { return translate(rotate(make_shape("ellipsoid", {{"radii", {radii.x, radii.y, radii.z}}}), axis, angle), center); }
  glm::dvec3 surface_point(const glm::dvec3& direction) const { return to_world(direction * radii); }
  /// At a surface point, or anywhere as the direction of the closest point's normal.
  glm::dvec3 normal(const glm::dvec3& world) const { return turned(glm::normalize(foot(to_body(world)) / (radii * radii)), angle); }
  double distance(const glm::dvec3& world) const {
    const glm::dvec3 p = to_body(world);
    return std::copysign(glm::distance(p, foot(p)), glm::length(p / radii) - 1.0);
  }

  /// Closest point q of the body: p = q + t q / r^2, so q = r^2 p / (t + r^2) with t the largest root of |r p / (t + r^2)| = 1. Newton's
  /// method from the left of a convex falling function never oversteps.
  glm::dvec3 foot(const glm::dvec3& p) const {
    const glm::dvec3 r2 = radii * radii, start = radii * glm::abs(p) - r2;
    double t = std::max({start.x, start.y, start.z});
    for (int i = 0; i < 60; ++i) {
      const glm::dvec3 u = radii * p / (t + r2);
      const double step = 0.5 * (glm::dot(u, u) - 1.0) / glm::dot(u, u / (t + r2));
      t += step;
      if (!(step > 1e-17)) break;
    }
    return r2 * p / (t + r2);
  }

  /// The same, or only its sign and a size above `width` where a glance tells that it is beyond `width`.
  double distance_within(const glm::dvec3& world, double width) const {
    const double level = glm::length(to_body(world) / radii) - 1.0;
    // |p / r| changes by at most 1 / (smallest radius) per length.
    const double at_least = std::abs(level) * std::min({radii.x, radii.y, radii.z});
    return at_least > width ? std::copysign(at_least, level) : distance(world);
  }

  /// First hit of a ray from outside, or infinity; `discriminant` tells how far from grazing it is (1 through the centre).
  double intersect(const glm::dvec3& origin, const glm::dvec3& direction, double* discriminant = nullptr) const {
    const glm::dvec3 o = to_body(origin) / radii, d = turned(direction, -angle) / radii;
    const double a = glm::dot(d, d), b = glm::dot(o, d);
    // The closest approach to the centre is subtracted as a vector: the textbook discriminant cancels.
    const glm::dvec3 nearest = o - d * (b / a);
    const double rest = 1.0 - glm::dot(nearest, nearest);
    if (discriminant) *discriminant = rest;
    return rest < 0.0 ? std::numeric_limits<double>::infinity() : -b / a - std::sqrt(rest / a);
  }
};

/// Every node of a box, by brute force: active where |distance| <= half width (or everywhere).
inline LevelSet brute_force_level_set(const std::function<double(const glm::dvec3&)>& distance, const glm::ivec3& lower_block,
                                      const glm::ivec3& upper_block, double voxel_size, double half_width_voxels, bool all_active = false,
                                      const glm::dvec3& origin = glm::dvec3(0.0)) {
  std::vector<LevelSetBlock> blocks;
  const double width = voxel_size * half_width_voxels;
  for (int bx = lower_block.x; bx < upper_block.x; ++bx)
    for (int by = lower_block.y; by < upper_block.y; ++by)
      for (int bz = lower_block.z; bz < upper_block.z; ++bz) {
        LevelSetBlock& block = blocks.emplace_back();
        block = {};
        block.origin = 8 * glm::ivec3(bx, by, bz);
        for (int n = 0; n < 512; ++n) {
          const double value = distance(origin + voxel_size * glm::dvec3(block.origin + glm::ivec3(n >> 6, (n >> 3) & 7, n & 7)));
          const bool active = all_active || std::abs(value) <= width;
          if (active) block.active[n >> 6] |= std::uint64_t{1} << (n & 63);
          block.values[n] = static_cast<float>(active ? value : std::copysign(width, value));
        }
      }
  return level_set_from_blocks(blocks, voxel_size, half_width_voxels, "brute force", origin);
}

}  // namespace limn::testing_tools
