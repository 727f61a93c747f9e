#pragma once
// Included by contestant.h.

#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>

#include <algorithm>

namespace limn::bench {

inline constexpr int kTile_px = 16;

template <class Work>
void for_each_tile(int width, int height, const Work& tile) {
  const int columns = (width + kTile_px - 1) / kTile_px, rows = (height + kTile_px - 1) / kTile_px;
  tbb::parallel_for(tbb::blocked_range2d<int>(0, rows, 1, 0, columns, 8), [&](const tbb::blocked_range2d<int>& part) {
    for (int row = part.rows().begin(); row < part.rows().end(); ++row) {
      for (int column = part.cols().begin(); column < part.cols().end(); ++column) {
        const int x = column * kTile_px, y = row * kTile_px;
        tile(x, y, std::min(x + kTile_px, width), std::min(y + kTile_px, height));
      }
    }
  });
}

}  // namespace limn::bench
