#pragma once
// Pieces of ink that are smaller than any line.

#include <functional>

#include "sdf/image.h"

namespace limn {

/// A line of fewer pixels than this is a speck.
inline constexpr int kSpeckPx = 6;

/// Pieces of ink (coverage above 1/2, 8-connected) of fewer than `least_px` pixels, of which `counts` holds for every pixel (by index).
std::int64_t count_specks(const Image<float>& coverage, int least_px, const std::function<bool(size_t)>& counts);

/// Takes them away.
void drop_specks(int least_px, const std::function<bool(size_t)>& counts, Image<float>& coverage);

}  // namespace limn
