#pragma once
// Borders are blank nearly everywhere.

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "sdf/image.h"

namespace limn {

/// visit(i) for each pixel, in order, but for those of blank stretches: where the coverages in both pictures are 0, at which sums of
/// coverage stay as they are.
template <class Visit>
void visit_inked(const Image<float>& a, const Image<float>& b, const Visit& visit) {
  constexpr size_t kStretch = 32;
  for (size_t first = 0; first < a.size(); first += kStretch) {
    const size_t last = std::min(first + kStretch, a.size());
    std::uint32_t any = 0;
    for (size_t i = first; i < last; ++i) {
      std::uint32_t bits_a = 0, bits_b = 0;
      std::memcpy(&bits_a, &a.pixels[i], sizeof bits_a);
      std::memcpy(&bits_b, &b.pixels[i], sizeof bits_b);
      any |= bits_a | bits_b;
    }
    if (any == 0) continue;
    for (size_t i = first; i < last; ++i) visit(i);
  }
}

}  // namespace limn
