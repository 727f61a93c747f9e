#pragma once
// Internal: points of a block, axis by axis, as lanes read them.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>

namespace limn {

inline constexpr std::size_t kMostLanePoints = 512;

struct LanePoints {
  /// Not a page apart: stores to one axis would hold up loads from another.
  alignas(64) double at[3][kMostLanePoints + 32];
  std::size_t count = 0;

  glm::dvec3 point(std::size_t i) const { return {at[0][i], at[1][i], at[2][i]}; }
  void add(const glm::dvec3& point) {
    for (int axis = 0; axis < 3; ++axis) at[axis][count] = point[axis];
    ++count;
  }
  /// To the next multiple of sixteen the last point stands again: whole vectors are read.
  void fill_up() {
    if (count == 0) return;
    const std::size_t end = (count + 15) / 16 * 16;
    for (auto& axis : at) std::fill(axis + count, axis + end, axis[count - 1]);
  }
};

/// A number for each of them; beyond their count whole vectors are written, too.
struct alignas(64) LaneNumbers {
  double at[kMostLanePoints];
  double& operator[](std::size_t i) { return at[i]; }
  const double& operator[](std::size_t i) const { return at[i]; }
};

/// Bit i % 16 of word i / 16 says something of point i.
using LaneFlags = std::uint16_t[kMostLanePoints / 16];
inline bool flag_of(const LaneFlags& flags, std::size_t i) { return (flags[i / 16] >> (i % 16) & 1u) != 0; }

}  // namespace limn
