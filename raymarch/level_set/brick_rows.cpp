#include "raymarch/level_set/brick_rows.h"

#include <algorithm>

namespace limn {
namespace {

/// The nodes that cells have along an axis: the cell's own and the one behind it.
std::uint64_t nodes_of(std::uint64_t cells) { return cells | cells << 1; }

/// Bit y of [x]: whether a cell of the column is among `bits`.
struct Columns {
  std::uint64_t of[8];

  Columns(const CrossedCells& crossed, std::uint8_t bits) {
    for (int x = 0; x < 8; ++x) {
      of[x] = 0;
      for (int y = 0; y < 8; ++y) of[x] |= std::uint64_t{(crossed.cells[x][y] & bits) != 0} << y;
    }
  }
  std::uint64_t at(int x) const { return x < 0 || x > 7 ? 0 : of[x]; }
  /// Of the cells on both sides of the nodes at x.
  std::uint64_t about(int x) const { return at(x - 1) | at(x); }
};

constexpr std::uint64_t kNine = 0x1ff;

}  // namespace

BrickRows rows_read(const CrossedCells& crossed) {
  const Columns columns(crossed, 0xff);
  BrickRows rows;
  for (int x = 0; x < 9; ++x) {
    // Beside the cells one node farther along x, or along y.
    const std::uint64_t about = columns.about(x), beside = columns.at(x + 1) | columns.at(x - 2);
    rows.add_at(x, (nodes_of(about | beside) | about >> 1 | about << 2) & kNine);
  }
  return rows;
}

BrickRows rows_read_over(const CrossedCells& crossed, int face, int at) {
  const bool first = face % 2 == 0;
  BrickRows rows;
  if (face < 2) {
    rows.add_at(at, nodes_of(Columns(crossed, 0xff).at(first ? 0 : 7)));
  } else if (face < 4) {
    const Columns columns(crossed, 0xff);
    for (int x = 0; x < 9; ++x) rows.add_at(x, (columns.about(x) >> (first ? 0 : 7) & 1) << at);
  } else {
    const Columns columns(crossed, first ? 1 : 128);
    for (int x = 0; x < 9; ++x) rows.add_at(x, nodes_of(columns.about(x)));
  }
  return rows;
}

std::array<std::uint64_t, 8> cells_within(const BrickRows& rows) {
  std::array<std::uint64_t, 8> cells{};
  for (int x = 0; x < 8; ++x)
    for (int y = 0; y < 8; ++y) {
      const int row = 9 * x + y;
      if (rows.has(row) && rows.has(row + 1) && rows.has(row + 9) && rows.has(row + 10))
        cells[static_cast<size_t>(x)] |= std::uint64_t{0xff} << 8 * y;
    }
  return cells;
}

std::int64_t RowPacking::place(const BrickRows& rows) {
  if (!rows.any()) return 0;
  // From its first row on.
  const int skipped = rows.low != 0 ? std::countr_zero(rows.low) : 64 + std::countr_zero(rows.high);
  std::uint64_t low = rows.low, high = rows.high;
  if (skipped >= 64)
    low = high >> (skipped - 64), high = 0;
  else if (skipped > 0)
    low = low >> skipped | high << (64 - skipped), high >>= skipped;
  const auto words_at = [&](size_t word, int bit, std::uint64_t& first, std::uint64_t& second) {
    first = taken_[word] >> bit, second = taken_[word + 1] >> bit;
    if (bit > 0) first |= taken_[word + 1] << (64 - bit), second |= taken_[word + 2] << (64 - bit);
  };
  // Farther back gaps are too small for most.
  constexpr size_t kWordsBack = 4;
  const auto last = static_cast<size_t>(end_ >> 6);
  for (size_t word = last > kWordsBack ? last - kWordsBack : 0;; ++word) {
    if (taken_.size() < word + 4) taken_.resize(word + 4);
    for (std::uint64_t free = ~taken_[word]; free != 0; free &= free - 1) {
      const int bit = std::countr_zero(free);
      std::uint64_t first = 0, second = 0;
      words_at(word, bit, first, second);
      if (((first & low) | (second & high)) != 0) continue;
      taken_[word] |= low << bit;
      taken_[word + 1] |= high << bit | (bit > 0 ? low >> (64 - bit) : 0);
      if (bit > 0) taken_[word + 2] |= high >> (64 - bit);
      const std::int64_t at = static_cast<std::int64_t>(word) * 64 + bit;
      end_ = std::max(end_, at + (high != 0 ? 64 : 0) + static_cast<std::int64_t>(std::bit_width(high != 0 ? high : low)));
      return at - skipped;
    }
  }
}

}  // namespace limn
