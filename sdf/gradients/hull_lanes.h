#pragma once
// Internal: bounds of a spline's cells by the convex hulls of their Bernstein coefficients (Farin 2002, section 6.3), a cell in each lane.

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>

namespace limn {

inline constexpr size_t kHullCells = 16;

/// A number for each of some cells.
using OfCells = std::array<float, kHullCells>;

/// Spline coefficients of up to so many cells: of each place (spline_place()) those of all cells beside each other. In floats: bounds allow
/// for what these round by.
struct HullCells {
  alignas(64) std::array<OfCells, 64> coefficients{};
  size_t count = 0;
};

/// A bit for each cell.
using CellBits = std::uint32_t;

/// Cones that hold all normals of a cell.
struct NormalCones {
  CellBits may_hold_zero = 0;
  CellBits bounded = 0;             ///< Of the others nothing is known.
  std::array<OfCells, 3> normal{};  ///< By axes; unit.
  OfCells sine_squared{};           ///< Of the greatest angle from that.
};
/// `world_from_slope`: of gradients by index coordinates.
void find_normal_cones(const HullCells& cells, const glm::mat3& world_from_slope, NormalCones& cones);

/// From the lower and the upper corner of each cell towards a point, or along a direction; index coordinates, by axes.
struct WaysToTarget {
  std::array<OfCells, 3> from_low{}, from_high{};
};
/// False of a cell where its coefficients show that its spline has no zero, or that its slope along the ways has none, or that they share
/// none.
CellBits may_turn_from(const HullCells& cells, const WaysToTarget& ways);

}  // namespace limn
