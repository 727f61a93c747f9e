#pragma once
// Lines of level sets that fall to pieces: a grid turns a crease over a voxel or two, and where those cover several pixels an operator that
// compares neighbouring pixels finds the turn in some of them only.

#include <functional>

#include "raymarch/border.h"

namespace limn {

/// A line of fewer pixels than this is a speck.
inline constexpr int kSpeckPx = 6;

/// Pieces of ink (coverage above 1/2, 8-connected) of fewer than `least_px` pixels, of which `counts` holds for every pixel (by index).
std::int64_t count_specks(const Image<float>& coverage, int least_px, const std::function<bool(size_t)>& counts);

/// "roberts: 3 pieces of line are shorter than 6 px …" where the ink on level sets falls to pieces; empty where it does not.
std::string broken_lines_note(const std::string& name, const BorderInput& input, const Image<float>& coverage);

}  // namespace limn
