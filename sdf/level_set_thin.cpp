#include "sdf/level_set_thin.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace limn {
namespace {

// Quarters of a voxel: eight inwards, four outwards. The first is far enough in for the error of the foot point.
constexpr std::array<double, 12> kSteps{-0.25, -0.5, -0.75, -1.0, -1.25, -1.5, -1.75, -2.0, 0.25, 0.5, 0.75, 1.0};
constexpr size_t kInward = 8;

bool is_looked_at(size_t node, double distance, double voxel_size) {
  const size_t x = node >> 6, y = (node >> 3) & 7, z = node & 7;
  return (x + 2 * y + 3 * z) % 4 == 0 && std::abs(distance) <= 0.75 * voxel_size;
}

}  // namespace

ThinPlaces find_thin_places(FieldEvaluator& evaluator, std::span<const glm::dvec3> points, std::span<const double> distances,
                            double voxel_size) {
  std::vector<glm::dvec3> near;
  std::vector<double> near_distances;
  for (size_t i = 0; i < points.size(); ++i)
    if (is_looked_at(i, distances[i], voxel_size)) {
      near.push_back(points[i]);
      near_distances.push_back(distances[i]);
    }
  std::vector<double> values(near.size());
  std::vector<glm::dvec3> gradients(near.size());
  evaluator.gradients(near, values, gradients);

  std::vector<glm::dvec3> samples;
  std::vector<double> clear;  // What counts as off the surface: along the edge of a box the normal of one face runs within the other.
  for (size_t i = 0; i < near.size(); ++i) {
    const double slope = glm::length(gradients[i]);
    if (!(slope > 0.0)) continue;
    const glm::dvec3 normal = gradients[i] / slope, foot = near[i] - near_distances[i] * normal;
    clear.push_back(1e-3 * voxel_size * slope);
    for (const double step : kSteps) samples.push_back(foot + step * voxel_size * normal);
  }
  values.resize(samples.size());
  evaluator.values(samples, values);
  ThinPlaces found;
  for (size_t i = 0; i < clear.size(); ++i) {
    const auto along = std::span(values).subspan(i * kSteps.size(), kSteps.size());
    ++found.looked_at;
    found.walls += std::any_of(along.begin(), along.begin() + kInward, [&](double f) { return f > clear[i]; });
    found.gaps += std::any_of(along.begin() + kInward, along.end(), [&](double f) { return f < -clear[i]; });
  }
  return found;
}

}  // namespace limn
