#pragma once
// Internal: ink as thin lines of pixels.

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "sdf/image.h"

namespace limn {

using InkMask = Image<std::uint8_t>;

/// The pixels of ink wider than about four pixels, with what surrounds them.
InkMask wide_ink(const Image<float>& coverage);

/// Peels the mask to lines one pixel thin.
void thin_to_lines(InkMask& mask);

/// A line of pixels from end or junction to end or junction.
struct PixelLine {
  std::vector<glm::ivec2> pixels{};
  bool closed = false;
  bool junction_first = false, junction_last = false;  ///< Other lines end there, too.
};
/// Of a thinned mask. Spurs of up to two pixels at junctions are left out.
std::vector<PixelLine> trace_pixel_lines(InkMask mask);

}  // namespace limn
