#pragma once
// Internal: the regions into which border curves divide a picture.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace limn {

/// Pixels of a row, side by side, that no curve goes through.
struct UntouchedRun {
  std::size_t first = 0, last = 0;  ///< The last one's successor.
};

/// Runs of pixels that no curve separates: connected by their sides. In order of their first pixels, which come first.
using PixelRegion = std::vector<UntouchedRun>;

/// Of a picture's pixels, row by row, those that no curve goes through (0), in order of their regions' first pixels.
std::vector<PixelRegion> untouched_regions(const std::vector<std::uint8_t>& touched, int width, int height);

}  // namespace limn
