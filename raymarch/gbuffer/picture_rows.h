#pragma once
// Image methods work on lines of the picture, in parallel on the threads of the surrounding task arena.

#include <algorithm>

#include "sdf/parallel.h"

namespace limn {

/// Lines that one task takes. Fixed, so that the bytes of a result never depend on how many threads there are.
inline constexpr int kBandRows = 32;

/// Calls `band(y0, y1)` for all bands of `kBandRows` lines [y0, y1) of a picture of `height` lines.
template <class Band>
void for_each_band(int height, const Band& band) {
  const int bands = (height + kBandRows - 1) / kBandRows;
  parallel_each(bands, [&](int b) { band(b * kBandRows, std::min(height, (b + 1) * kBandRows)); });
}

}  // namespace limn
