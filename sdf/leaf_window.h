#pragma once
// Internal: a leaf of a level set with the nodes around it, as rows along z: which of them are in the band, and their values.

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>

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

  /// Three blocks on top of each other.
  struct Column {
    const NanoLeaf* const* leaves;
    const float* tiles;

    /// Values at (x, y, -1..8).
    void load_row(int x, int y, float* to) const {
      to[0] = value(0, x, y, 7);
      if (const NanoLeaf* here = leaves[1])
        std::memcpy(to + 1, here->data()->mValues + row_of(x, y), 8 * sizeof(float));  // std::copy_n calls a function for it
      else
        std::fill_n(to + 1, 8, tiles[1]);
      to[9] = value(2, x, y, 0);
    }
    /// Values at (x, y, -3..10).
    void load_wide_row(int x, int y, float* to) const {
      load_row(x, y, to + 2);
      for (int z = 0; z < 2; ++z) {
        to[z] = value(0, x, y, 5 + z);
        to[12 + z] = value(2, x, y, 1 + z);
      }
    }

   private:
    float value(int block, int x, int y, int z) const {
      return leaves[block] ? leaves[block]->data()->mValues[row_of(x, y) | z] : tiles[block];
    }
  };

  /// Nodes of a block at x that are in the band: bit z of byte y. The blocks are numbered along x, y and z, from 0 to 2.
  std::uint64_t active_plane(int block_x, int block_y, int block_z, int x) const {
    const int block = 9 * block_x + 3 * block_y + block_z;
    if (!leaves_[block]) return active_[block] ? ~std::uint64_t{0} : 0;
    return leaves_[block]->valueMask().template getWord<std::uint64_t>(x & 7);
  }

  /// Calls visit(column, x, y) for each row of nodes from `first` to `last` along x and y, which lie between -8 and 15.
  template <class Visit>
  void for_each_column(int first, int last, const Visit& visit) const {
    for (int block = 0; block < 9; ++block) {
      const int x0 = 8 * (block / 3 - 1), y0 = 8 * (block % 3 - 1);
      const Column column{leaves_ + 3 * block, tiles_ + 3 * block};
      for (int x = std::max(x0, first); x <= std::min(x0 + 7, last); ++x)
        for (int y = std::max(y0, first); y <= std::min(y0 + 7, last); ++y) visit(column, x, y);
    }
  }

 private:
  static int row_of(int x, int y) { return (x & 7) << 6 | (y & 7) << 3; }

  nanovdb::Coord origin_;
  const NanoLeaf* leaves_[27];
  float tiles_[27];
  bool active_[27];
};

}  // namespace limn
