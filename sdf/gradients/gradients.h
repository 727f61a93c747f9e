#pragma once
// What the gradients, one a file, share.

#include <cmath>
#include <numbers>

#include "sdf/level_set_data.h"

namespace limn {

/// The nodes of the box [lower, upper]^3 about a cell's first node and, if `beyond`, those one step from it along one axis.
constexpr Stencil box_stencil(int lower, int upper, bool beyond) {
  Stencil stencil{};
  for (int x = -2; x <= 3; ++x)
    for (int y = -2; y <= 3; ++y)
      for (int z = -2; z <= 3; ++z) {
        int outside = 0, farthest = 0;
        for (const int at : {x, y, z}) {
          const int off = at < lower ? lower - at : at > upper ? at - upper : 0;
          outside += off > 0 ? 1 : 0;
          farthest = off > farthest ? off : farthest;
        }
        if (outside == 0 || (beyond && outside == 1 && farthest == 1)) {
          const int from_first_x = x + 2, from_first_y = y + 2;
          std::uint8_t& row = stencil[static_cast<size_t>(from_first_x)][static_cast<size_t>(from_first_y)];
          row = static_cast<std::uint8_t>(row | 1 << (z + 2));
        }
      }
  return stencil;
}

}  // namespace limn
