#pragma once
// Which cells of a block of 8^3 the surface crosses.

#include <bit>
#include <cstdint>

namespace limn {

/// Bit z of cells[x][y].
struct CrossedCells {
  std::uint8_t cells[8][8] = {};
  bool any = false;
};

/// From the signs at the 9^3 nodes: `row(x, y)` points to the nine values along z.
template <class Row>
CrossedCells crossed_cells(const Row& row) {
  std::uint32_t negative[9][9];
  for (int x = 0; x < 9; ++x) {
    for (int y = 0; y < 9; ++y) {
      const auto* const values = row(x, y);
      std::uint32_t bits = 0;
      for (int z = 0; z < 9; ++z) bits |= (values[z] < 0 ? 1u : 0u) << z;
      negative[x][y] = bits;
    }
  }
  CrossedCells result;
  for (int x = 0; x < 8; ++x) {
    for (int y = 0; y < 8; ++y) {
      const std::uint32_t some = negative[x][y] | negative[x + 1][y] | negative[x][y + 1] | negative[x + 1][y + 1];
      const std::uint32_t every = negative[x][y] & negative[x + 1][y] & negative[x][y + 1] & negative[x + 1][y + 1];
      const auto bits = static_cast<std::uint8_t>((some | some >> 1) & ~(every & every >> 1));
      result.cells[x][y] = bits;
      result.any |= bits != 0;
    }
  }
  return result;
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

/// Calls `visit(x, y, z)` for each node of a crossed cell.
template <class Visit>
void for_each_node(const CrossedCells& crossed, const Visit& visit) {
  for (int x = 0; x < 9; ++x) {
    for (int y = 0; y < 9; ++y) {
      std::uint32_t cells = 0;
      for (int dx = x > 0 ? -1 : 0; dx <= (x < 8 ? 0 : -1); ++dx) {
        for (int dy = y > 0 ? -1 : 0; dy <= (y < 8 ? 0 : -1); ++dy) cells |= crossed.cells[x + dx][y + dy];
      }
      for (std::uint32_t bits = cells | cells << 1; bits != 0; bits &= bits - 1) visit(x, y, std::countr_zero(bits));
    }
  }
}

}  // namespace limn
