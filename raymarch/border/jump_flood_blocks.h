#pragma once
// Which blocks of a picture jump flooding has to look at: most of a picture is far from any crossing.

#include <cstdint>
#include <vector>

#include "raymarch/border/jump_flood_pass.h"
#include "raymarch/border/silhouette.h"

namespace limn {

/// One flag for each block of a picture, row by row. The last blocks of a row or column may lie partly outside of the picture.
struct BlockFlags {
  int columns = 0, rows = 0;
  std::vector<std::uint8_t> flags{};

  BlockFlags(int columns_, int rows_)
      : columns(columns_), rows(rows_), flags(static_cast<size_t>(columns_) * static_cast<size_t>(rows_), 0) {}
  size_t index(int column, int row) const { return static_cast<size_t>(row) * static_cast<size_t>(columns) + static_cast<size_t>(column); }
  bool at(int column, int row) const { return flags[index(column, row)] != 0; }
  /// Whether any flag of [column0, column1] x [row0, row1] is set; there are none outside of the picture.
  bool any(int column0, int row0, int column1, int row1) const;
};

/// Blocks of which a pixel may lie beside a crossing; at least all of those.
BlockFlags blocks_beside_crossings(const Silhouette& silhouette);

/// Blocks of which a pixel may lie within `reach_px` of a pixel of a flagged one; at least all of those, and the flagged ones.
BlockFlags within_reach(const BlockFlags& blocks, int reach_px);

}  // namespace limn
