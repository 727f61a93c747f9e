#include "raymarch/border/jump_flood_blocks.h"

#include <algorithm>
#include <cstring>

#include "raymarch/gbuffer/picture_rows.h"

namespace limn {
namespace {

/// Whether any of the places is a crossing; kNoCrossing is the only negative one.
bool any_crossing(const std::int8_t* places, int count) {
  std::uint64_t all = ~std::uint64_t{0};
  int i = 0;
  for (; i + 8 <= count; i += 8) {
    std::uint64_t eight;
    std::memcpy(&eight, places + i, 8);
    all &= eight;
  }
  for (; i < count; ++i) all &= static_cast<std::uint64_t>(std::int64_t{places[i]});
  return all != ~std::uint64_t{0};
}

/// Pixels between two blocks that are `blocks` apart along a row or column of blocks.
int gap_px(int blocks, int size_px) { return blocks == 0 ? 0 : (blocks - 1) * size_px + 1; }

/// For each block how many blocks away the next flagged one of its row is; more than the row has where there is none.
std::vector<int> distance_in_row(const BlockFlags& blocks) {
  std::vector<int> distance(blocks.flags.size());
  for (int row = 0; row < blocks.rows; ++row) {
    int past = blocks.columns;
    for (int column = 0; column < blocks.columns; ++column) {
      past = blocks.at(column, row) ? 0 : past + 1;
      distance[blocks.index(column, row)] = past;
    }
    past = blocks.columns;
    for (int column = blocks.columns - 1; column >= 0; --column) {
      int& nearest = distance[blocks.index(column, row)];
      past = std::min(past + 1, nearest);
      nearest = past;
    }
  }
  return distance;
}

}  // namespace

bool BlockFlags::any(int column0, int row0, int column1, int row1) const {
  for (int row = std::max(row0, 0); row <= std::min(row1, rows - 1); ++row) {
    for (int column = std::max(column0, 0); column <= std::min(column1, columns - 1); ++column) {
      if (at(column, row)) return true;
    }
  }
  return false;
}

BlockFlags blocks_beside_crossings(const Silhouette& silhouette) {
  const int width = silhouette.inside.width, height = silhouette.inside.height;
  BlockFlags has((width + kBlockWidth_px - 1) / kBlockWidth_px, (height + kBlockHeight_px - 1) / kBlockHeight_px);
  static_assert(kBandRows % kBlockHeight_px == 0, "a block belongs to one task");
  for_each_band(height, [&](int y0, int y1) {
    for (int y = y0; y < y1; ++y) {
      for (int column = 0; column < has.columns; ++column) {
        const int x = column * kBlockWidth_px, count = std::min(kBlockWidth_px, width - x);
        std::uint8_t& flag = has.flags[has.index(column, y / kBlockHeight_px)];
        if (any_crossing(&silhouette.to_right.at(x, y), count) || any_crossing(&silhouette.downwards.at(x, y), count)) flag = 1;
      }
    }
  });
  // A crossing is kept with the left or upper one of its two pixels; the other one may belong to the next block.
  BlockFlags beside = has;
  for (int row = 0; row < has.rows; ++row) {
    for (int column = 0; column < has.columns; ++column) {
      beside.flags[has.index(column, row)] = has.any(column - 1, row, column, row) || has.any(column, row - 1, column, row);
    }
  }
  return beside;
}

BlockFlags within_reach(const BlockFlags& blocks, int reach_px) {
  const std::vector<int> distance = distance_in_row(blocks);
  BlockFlags within(blocks.columns, blocks.rows);
  const auto near = [&](int column, int row, int rows_away) {
    if (row < 0 || row >= blocks.rows) return false;
    const int away = distance[blocks.index(column, row)];
    const std::int64_t x = gap_px(away, kBlockWidth_px), y = gap_px(rows_away, kBlockHeight_px);
    return away < blocks.columns && x * x + y * y <= std::int64_t{reach_px} * reach_px;
  };
  for (int row = 0; row < blocks.rows; ++row) {
    for (int column = 0; column < blocks.columns; ++column) {
      for (int away = 0; away < blocks.rows && gap_px(away, kBlockHeight_px) <= reach_px; ++away) {
        if (!near(column, row - away, away) && !near(column, row + away, away)) continue;
        within.flags[within.index(column, row)] = 1;
        break;
      }
    }
  }
  return within;
}

}  // namespace limn
