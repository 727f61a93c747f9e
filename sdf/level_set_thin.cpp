#include "sdf/level_set_thin.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sdf/error.h"

namespace limn {
namespace {

// Quarters of a voxel: eight inwards, four outwards. The first is far enough in for the error of the foot point.
constexpr std::array<double, 12> kSteps{-0.25, -0.5, -0.75, -1.0, -1.25, -1.5, -1.75, -2.0, 0.25, 0.5, 0.75, 1.0};
constexpr size_t kInward = 8;
constexpr size_t kMostLookedAt = 128;  ///< Every fourth node of a block.

bool is_looked_at(size_t node, double distance, double voxel_size) {
  const size_t x = node >> 6, y = (node >> 3) & 7, z = node & 7;
  return (x + 2 * y + 3 * z) % 4 == 0 && std::abs(distance) <= 0.75 * voxel_size;
}

}  // namespace

ThinPlaces find_thin_places(DistanceEvaluator& distance, std::span<const std::uint16_t> nodes, std::span<const glm::dvec3> points,
                            std::span<const double> distances, double voxel_size) {
  std::array<glm::dvec3, kMostLookedAt> near, gradients;
  std::array<double, kMostLookedAt> near_distances, values;
  size_t count = 0;
  for (size_t i = 0; i < nodes.size(); ++i) {
    if (!is_looked_at(nodes[i], distances[i], voxel_size)) continue;
    LIMN_CHECK(count < kMostLookedAt);
    near[count] = points[i];
    near_distances[count++] = distances[i];
  }
  ThinPlaces found;
  if (count == 0) return found;
  distance.evaluator.gradients(std::span(near).first(count), std::span(values).first(count), std::span(gradients).first(count));

  std::array<glm::dvec3, kMostLookedAt * kSteps.size()> samples;
  std::array<double, kMostLookedAt>
      clear;  // What counts as off the surface: along the edge of a box the normal of one face runs within the other.
  size_t lines = 0, sample = 0;
  for (size_t i = 0; i < count; ++i) {
    const double slope = glm::length(gradients[i]);
    if (!(slope > 0.0)) continue;
    const glm::dvec3 normal = gradients[i] / slope, foot = near[i] - near_distances[i] * normal;
    clear[lines++] = 1e-3 * voxel_size * slope;
    for (const double step : kSteps) samples[sample++] = foot + step * voxel_size * normal;
  }
  std::array<double, kMostLookedAt * kSteps.size()> along_lines;
  field_values(distance, std::span(samples).first(sample), std::span(along_lines).first(sample));
  for (size_t i = 0; i < lines; ++i) {
    const auto along = std::span(along_lines).subspan(i * kSteps.size(), kSteps.size());
    ++found.looked_at;
    found.walls += std::any_of(along.begin(), along.begin() + kInward, [&](double f) { return f > clear[i]; });
    found.gaps += std::any_of(along.begin() + kInward, along.end(), [&](double f) { return f < -clear[i]; });
  }
  return found;
}

}  // namespace limn
