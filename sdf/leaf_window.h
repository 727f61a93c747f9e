#pragma once
// Internal: a leaf of a level set with the nodes around it, as rows along z: which of them are in the band, and their values.

#include <bit>
#include <cstdint>

#include "sdf/level_set_data.h"

namespace limn {

using NanoLeaf = nanovdb::FloatGrid::TreeType::LeafNodeType;
using NanoAccessor = nanovdb::FloatGrid::AccessorType;

/// The 27 blocks of 8^3 nodes about one that starts at `origin`; some may be no leaves but parts of a tile.
class LeafWindow {
 public:
  LeafWindow(const NanoAccessor& accessor, const nanovdb::Coord& origin) : origin_(origin) {
    for (int block = 0; block < 27; ++block) {
      const nanovdb::Coord at = origin.offsetBy(8 * (block / 9 - 1), 8 * (block / 3 % 3 - 1), 8 * (block % 3 - 1));
      leaves_[block] = accessor.probeLeaf(at);
      tiles_[block] = leaves_[block] ? 0.0f : accessor.getValue(at);
      active_[block] = !leaves_[block] && accessor.isActive(at);
    }
  }

  const nanovdb::Coord& origin() const { return origin_; }
  /// Of the middle block; null where it is none.
  const NanoLeaf* leaf() const { return leaves_[13]; }

  /// Nodes (x, y, -2..10) that are in the band, as bits 0..12; x and y from -8 to 15.
  std::uint32_t active_row(int x, int y) const {
    const int column = column_of(x, y);
    const std::uint32_t below = octet(column, x, y), here = octet(column + 1, x, y), above = octet(column + 2, x, y);
    return below >> 6 | here << 2 | (above & 7u) << 10;
  }
  /// Values at (x, y, -1..8).
  void load_row(int x, int y, float* to) const {
    const int column = column_of(x, y);
    to[0] = value(column, x, y, 7);
    if (const NanoLeaf* here = leaves_[column + 1])
      std::copy_n(here->data()->mValues + row_of(x, y), 8, to + 1);
    else
      std::fill_n(to + 1, 8, tiles_[column + 1]);
    to[9] = value(column + 2, x, y, 0);
  }
  /// Values at (x, y, -3..10).
  void load_wide_row(int x, int y, float* to) const {
    const int column = column_of(x, y);
    load_row(x, y, to + 2);
    for (int z = 0; z < 2; ++z) {
      to[z] = value(column, x, y, 5 + z);
      to[12 + z] = value(column + 2, x, y, 1 + z);
    }
  }

 private:
  static int column_of(int x, int y) { return ((x + 8) >> 3) * 9 + ((y + 8) >> 3) * 3; }
  static int row_of(int x, int y) { return (x & 7) << 6 | (y & 7) << 3; }
  float value(int block, int x, int y, int z) const {
    return leaves_[block] ? leaves_[block]->data()->mValues[row_of(x, y) | z] : tiles_[block];
  }
  std::uint32_t octet(int block, int x, int y) const {
    if (!leaves_[block]) return active_[block] ? 0xffu : 0u;
    return leaves_[block]->valueMask().template getWord<std::uint8_t>(row_of(x, y) >> 3);
  }

  nanovdb::Coord origin_;
  const NanoLeaf* leaves_[27];
  float tiles_[27];
  bool active_[27];
};

}  // namespace limn
