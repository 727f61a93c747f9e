#pragma once
// PNG's filters: what makes rows small before they are compressed.

#include <cstdint>
#include <span>

namespace limn {

/// The row with the number of its filter before it, into `to`: a row itself (0), less the pixel to the left (1) or less the row above (2),
/// whichever has the least sum of bytes as signed numbers (the usual heuristic: PNG specification, 12.8), the first of equals. Average and
/// Paeth gain nothing on flat and shaded surfaces, and take as long again. `above` is null for the first row; `to` has one byte more than
/// the row. True where nothing is left of it but noughts.
bool filter_png_row(std::span<const std::uint8_t> row, const std::uint8_t* above, size_t pixel_bytes, std::uint8_t* to);

}  // namespace limn
