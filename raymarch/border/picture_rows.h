#pragma once
// Image methods work on lines of the picture, in parallel on the threads of the surrounding task arena.

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>

#include <algorithm>

namespace limn {

/// Lines that one task takes. Fixed, so that the bytes of a result never depend on how many threads there are.
inline constexpr int kBandRows = 32;

/// Calls `band(y0, y1)` for all bands of `kBandRows` lines [y0, y1) of a picture of `height` lines.
template <class Band>
void for_each_band(int height, const Band& band) {
  const int bands = (height + kBandRows - 1) / kBandRows;
  tbb::parallel_for(
      tbb::blocked_range<int>(0, bands, 1),
      [&](const tbb::blocked_range<int>& range) {
        for (int b = range.begin(); b < range.end(); ++b) band(b * kBandRows, std::min(height, (b + 1) * kBandRows));
      },
      tbb::simple_partitioner());
}

}  // namespace limn
