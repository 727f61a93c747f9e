#pragma once
// Internal: which rows of nodes rays read of a brick, and where they lie. A surface passes few of a brick's rows: bricks lie in each
// other's gaps.

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sdf/crossed_cells.h"

namespace limn {

/// Rows of nine nodes along z, of a brick's 81: bit 9 x + y, the first 64 in `low`.
struct BrickRows {
  std::uint64_t low = 0, high = 0;

  bool any() const { return (low | high) != 0; }
  bool has(int row) const { return ((row < 64 ? low >> row : high >> (row - 64)) & 1) != 0; }
  void add(const BrickRows& more) { low |= more.low, high |= more.high; }
  /// Bit y of nine.
  void add_at(int x, std::uint64_t of_y) {
    const int at = 9 * x;
    if (at < 64) low |= of_y << at;
    if (at + 9 > 64) high |= at < 64 ? of_y >> (64 - at) : of_y << (at - 64);
  }
};
inline constexpr int kBrickRows = 81;

/// Cells all of whose nodes lie in the rows. (x, y, z) is bit 64 x + 8 y + z, of eight words.
std::array<std::uint64_t, 8> cells_within(const BrickRows& rows);

/// Of a brick what its crossed cells and the stencils of their gradients read.
BrickRows rows_read(const CrossedCells& crossed);
/// What those stencils read over a face (see BrickNeighbors): of nodes that lie at x or y = `at` in what stands there; over a face across
/// z, of all rows.
BrickRows rows_read_over(const CrossedCells& crossed, int face, int at);

/// Lays sets of rows into one list of rows, each into the gaps of those before it.
class RowPacking {
 public:
  /// Where row 0 of the set lies: no other set has a row where it has one. As far as 80 rows before the first one of the list.
  std::int64_t place(const BrickRows& rows);
  std::int64_t size() const { return end_; }  ///< Rows of the list.

 private:
  std::vector<std::uint64_t> taken_{};  ///< A bit for each row, and three words behind them.
  std::int64_t end_ = 0;
};

}  // namespace limn
