#include "subdiv/column_crossings.h"

#include <algorithm>
#include <cmath>

namespace limn {
namespace {

/// Of the two axes across `axis`, in the order x, y, z, and whether the three turn like x, y, z.
struct Across {
  int first, second;
  double turn;
};
Across across(int axis) {
  if (axis == 0) return {1, 2, 1.0};
  if (axis == 1) return {0, 2, -1.0};
  return {0, 1, 1.0};
}

}  // namespace

ColumnCrossings::ColumnCrossings(const Winding& winding, std::span<const std::uint32_t> triangles, const BlockColumns& columns,
                                 std::uint64_t wanted) {
  const auto [first, second, turn] = across(columns.axis);
  const glm::dvec3 origin(columns.origin);
  // Corners are rounded as they are divided, by half a unit in the last place of a coordinate; a block's own are small beside that.
  rounding_ = 1e-9 + 1e-15 * (std::max({std::abs(origin.x), std::abs(origin.y), std::abs(origin.z)}) + 8.0);
  const double per_voxel = 1.0 / columns.voxel_size;
  for (const std::uint32_t t : triangles) {
    std::array<glm::dvec3, 3> corners;
    for (size_t i = 0; i < 3; ++i) {
      const glm::dvec3 at = per_voxel * winding.corner(t, static_cast<int>(i)) - origin;
      corners[i] = {at[first], at[second], turn * at[columns.axis]};
    }
    add(corners, winding.times(t), wanted);
  }
  if (turn < 0.0)
    for (Crossing& crossing : crossings_) crossing.at = -crossing.at, crossing.change = -crossing.change;
}

/// The columns that pass through the triangle, or so near to it that rounding leaves it open.
void ColumnCrossings::add(const std::array<glm::dvec3, 3>& corners, int times, std::uint64_t wanted) {
  const auto& [a, b, c] = corners;
  const glm::dvec3 lower = glm::min(a, glm::min(b, c)) - rounding_, upper = glm::max(a, glm::max(b, c)) + rounding_;
  // Most triangles are smaller than voxels, and pass between all columns.
  const double x0 = std::max(std::ceil(lower.x), 0.0), x1 = std::min(std::floor(upper.x), 7.0);
  const double y0 = std::max(std::ceil(lower.y), 0.0), y1 = std::min(std::floor(upper.y), 7.0);
  for (double x = x0; x <= x1; ++x)
    for (double y = y0; y <= y1; ++y) {
      const int column = 8 * static_cast<int>(x) + static_cast<int>(y);
      if ((wanted >> column & 1) != 0) meet(corners, times, column);
    }
}

void ColumnCrossings::meet(const std::array<glm::dvec3, 3>& corners, int times, int column) {
  const int row = column / 8;
  const double x = row, y = column % 8;
  std::array<double, 3> weights;  // of each corner: twice the area that the column and the edge facing the corner span
  double all_unsure = 0.0;
  int left = 0, right = 0;
  for (size_t i = 0; i < 3; ++i) {
    const glm::dvec3 &from = corners[(i + 1) % 3], &to = corners[(i + 2) % 3];
    weights[i] = (to.x - from.x) * (y - from.y) - (to.y - from.y) * (x - from.x);
    const double unsure = 4.0 * rounding_ * (std::abs(to.x - from.x) + std::abs(to.y - from.y) + rounding_);
    all_unsure += unsure;
    left += weights[i] > unsure ? 1 : 0, right += weights[i] < -unsure ? 1 : 0;
  }
  if (left > 0 && right > 0) return;
  if (left < 3 && right < 3) {
    unclear_ |= std::uint64_t{1} << column;
    return;
  }
  const double area = weights[0] + weights[1] + weights[2];
  double at = 0.0;
  for (size_t i = 0; i < 3; ++i) at += weights[i] * corners[i].z;
  at /= area;
  const double height = std::max({corners[0].z, corners[1].z, corners[2].z}) - std::min({corners[0].z, corners[1].z, corners[2].z});
  const double unsure = 4.0 * rounding_ + all_unsure / std::abs(area) * height;
  // Seen from where the third axis points to, a triangle that turns left shows its outside: beyond it the number is less.
  crossings_.push_back({column, at, unsure, left == 3 ? -times : times});
}

std::optional<int> ColumnCrossings::change(int column, int from, int to) const {
  if ((unclear_ >> column & 1) != 0) return std::nullopt;
  const double low = std::min(from, to), high = std::max(from, to);
  int sum = 0;
  for (const Crossing& crossing : crossings_) {
    if (crossing.column != column) continue;
    if (std::abs(crossing.at - low) <= crossing.unsure || std::abs(crossing.at - high) <= crossing.unsure) return std::nullopt;
    if (crossing.at > low && crossing.at < high) sum += to > from ? crossing.change : -crossing.change;
  }
  return sum;
}

}  // namespace limn
