#pragma once
// Which cells of a block of 8^3 the surface crosses.

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <glm/glm.hpp>

namespace limn {

/// Bit z of cells[x][y].
struct CrossedCells {
  std::uint8_t cells[8][8] = {};
  bool any = false;
};

/// A block of 8^3 cells of which the surface crosses some.
struct CrossedBlock {
  glm::ivec3 origin{0};
  float largest = 0.0f;  ///< |value| at the nodes of crossed cells.
  CrossedCells cells{};
};

/// Bit z of [x][y]: whether the node (x, y, z) of 9^3 is inside.
using SignRows = std::array<std::array<std::uint32_t, 9>, 9>;

inline CrossedCells crossed_cells_of_signs(const SignRows& inside) {
  CrossedCells result;
  std::uint32_t all = 0;
  for (std::size_t x = 0; x < 8; ++x) {
    std::uint32_t some = inside[x][0] | inside[x + 1][0], every = inside[x][0] & inside[x + 1][0];
    for (std::size_t y = 0; y < 8; ++y) {
      const std::uint32_t next_some = inside[x][y + 1] | inside[x + 1][y + 1], next_every = inside[x][y + 1] & inside[x + 1][y + 1];
      some |= next_some, every &= next_every;
      const std::uint32_t bits = (some | some >> 1) & ~(every & every >> 1) & 0xffu;
      result.cells[x][y] = static_cast<std::uint8_t>(bits);
      all |= bits;
      some = next_some, every = next_every;
    }
  }
  result.any = all != 0;
  return result;
}

/// From the signs at the 9^3 nodes: `row(x, y)` points to the nine values along z.
template <class Row>
CrossedCells crossed_cells(const Row& row) {
  SignRows inside;
  for (std::size_t x = 0; x < 9; ++x) {
    for (std::size_t y = 0; y < 9; ++y) {
      const auto* const values = row(static_cast<int>(x), static_cast<int>(y));
      std::uint32_t bits = 0;
      for (int z = 0; z < 9; ++z) bits |= (values[z] < 0 ? 1u : 0u) << z;
      inside[x][y] = bits;
    }
  }
  return crossed_cells_of_signs(inside);
}

/// Calls `visit(x, y, z)` for each crossed cell.
template <class Visit>
void for_each_cell(const CrossedCells& crossed, const Visit& visit) {
  for (int x = 0; x < 8; ++x) {
    for (int y = 0; y < 8; ++y) {
      for (std::uint32_t bits = crossed.cells[x][y]; bits != 0; bits &= bits - 1) visit(x, y, std::countr_zero(bits));
    }
  }
}

/// Bits along z of cells at (x, y), for all y at once: byte y of `rows`, and those at y = 8.
struct CellPlane {
  std::uint64_t rows;
  std::uint32_t last;
  std::uint32_t at(int y) const { return y < 8 ? static_cast<std::uint32_t>(rows >> (8 * y)) & 0xffu : last; }
};

/// The crossed ones at (x, y), `across_x` those at x - 1, too, and `across_y` those at y - 1; none outside of the block. x from 0 to 8.
inline CellPlane cells_about(const CrossedCells& crossed, int x, bool across_x = true, bool across_y = true) {
  const auto cells = [&](int at) {
    std::uint64_t rows = 0;
    if (at >= 0 && at < 8) std::memcpy(&rows, crossed.cells[at], sizeof rows);
    return rows;
  };
  const std::uint64_t rows = cells(x) | (across_x ? cells(x - 1) : 0u);
  if (!across_y) return {rows, 0};
  return {rows | rows << 8, static_cast<std::uint32_t>(rows >> 56)};
}

/// Calls `visit(x, y, bits)` for each row of nodes (x, y, 0..8); bit z: whether a crossed cell has the node.
template <class Visit>
void for_each_node_row(const CrossedCells& crossed, const Visit& visit) {
  for (int x = 0; x < 9; ++x) {
    const CellPlane plane = cells_about(crossed, x);
    for (int y = 0; y < 9; ++y) visit(x, y, plane.at(y) | plane.at(y) << 1);
  }
}

/// Calls `visit(x, y, z)` for each node of a crossed cell.
template <class Visit>
void for_each_node(const CrossedCells& crossed, const Visit& visit) {
  for_each_node_row(crossed, [&](int x, int y, std::uint32_t row) {
    for (std::uint32_t bits = row; bits != 0; bits &= bits - 1) visit(x, y, std::countr_zero(bits));
  });
}

}  // namespace limn
