#pragma once
// Letters as pictures, by FreeType.

#include <cstdint>
#include <string>
#include <vector>

namespace limn {

/// A letter at one size. Its box begins `left_px` right of the pen and `top_px` above the baseline.
struct Glyph {
  int left_px = 0, top_px = 0, width_px = 0, height_px = 0;
  int advance_px = 0;                    ///< To the next letter's pen.
  std::vector<std::uint8_t> coverage{};  ///< Row after row, 255 for all.
};

/// Letters of a line of text in their order, each drawn once and then kept; none where the font cannot be read. All threads may ask, and
/// what it returns stays where it is.
std::vector<const Glyph*> glyphs_of(const std::string& text, const std::string& font_file, int size_px);

}  // namespace limn
