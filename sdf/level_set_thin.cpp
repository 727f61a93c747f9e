#include "sdf/level_set_thin.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "sdf/error.h"
#include "sdf/level_set_lanes.h"

namespace limn {
namespace {

// Quarters of a voxel: eight inwards, four outwards. The first is far enough in for the error of the foot point.
constexpr std::array<double, 12> kSteps{-0.25, -0.5, -0.75, -1.0, -1.25, -1.5, -1.75, -2.0, 0.25, 0.5, 0.75, 1.0};
constexpr size_t kInward = 8;
constexpr size_t kMostLookedAt = 128;  ///< Every fourth node of a block.

/// Of sixteen nodes in a plane across x those with x + 2 y + 3 z = 0 modulo 4: y and z start at multiples of 4.
std::uint16_t every_fourth(size_t x) {
  unsigned bits = 0;
  for (size_t i = 0; i < 16; ++i) bits |= ((x + 2 * (i / 4) + 3 * (i % 4)) % 4 == 0 ? 1u : 0u) << i;
  return static_cast<std::uint16_t>(bits);
}

constexpr size_t kMostLines = kMostLanePoints / kSteps.size();

/// Along normals, kSteps of each.
struct NormalLines {
  size_t count = 0;
  LanePoints samples;
  /// What counts as off the surface: along the edge of a box the normal of one face runs within the other.
  std::array<double, kMostLines> clear;
};

/// Counts what is found along the lines, and takes them away.
void look_along(DistanceEvaluator& distance, NormalLines& lines, ThinPlaces& found) {
  LaneNumbers values;
  lines.samples.fill_up();
  field_values(distance, lines.samples, values);
  for (size_t i = 0; i < lines.count; ++i) {
    const auto along = std::span(values.at).subspan(i * kSteps.size(), kSteps.size());
    ++found.looked_at;
    found.walls += std::any_of(along.begin(), along.begin() + kInward, [&](double f) { return f > lines.clear[i]; });
    found.gaps += std::any_of(along.begin() + kInward, along.end(), [&](double f) { return f < -lines.clear[i]; });
  }
  lines.count = lines.samples.count = 0;
}

}  // namespace

ThinPlaces find_thin_places(DistanceEvaluator& distance, std::span<const std::uint16_t> first, const LanePoints& points,
                            const LaneNumbers& distances, double voxel_size) {
  static const std::array<std::uint16_t, 4> kFourth{every_fourth(0), every_fourth(1), every_fourth(2), every_fourth(3)};
  std::array<glm::dvec3, kMostLookedAt> near, gradients;
  std::array<double, kMostLookedAt> near_distances, values;
  LaneFlags within;
  find_within(distances, points.count, 0.75 * voxel_size, within);
  size_t count = 0;
  for (size_t k = 0; k < first.size(); ++k) {
    for (unsigned bits = within[k] & kFourth[first[k] >> 6 & 3]; bits != 0; bits &= bits - 1) {
      const size_t i = 16 * k + static_cast<size_t>(std::countr_zero(bits));
      LIMN_CHECK(count < kMostLookedAt);
      near[count] = points.point(i);
      near_distances[count++] = distances[i];
    }
  }
  ThinPlaces found;
  if (count == 0) return found;
  distance.evaluator.gradients(std::span(near).first(count), std::span(values).first(count), std::span(gradients).first(count));

  NormalLines lines;
  for (size_t i = 0; i < count; ++i) {
    const double slope = glm::length(gradients[i]);
    if (!(slope > 0.0)) continue;
    const glm::dvec3 normal = gradients[i] / slope, foot = near[i] - near_distances[i] * normal;
    if (lines.count == kMostLines) look_along(distance, lines, found);
    lines.clear[lines.count++] = 1e-3 * voxel_size * slope;
    for (const double step : kSteps) lines.samples.add(foot + step * voxel_size * normal);
  }
  look_along(distance, lines, found);
  return found;
}

}  // namespace limn
