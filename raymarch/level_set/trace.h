#pragma once
// Internal: the rays of one tile against its bricks, in packets of the machine's widest SIMD.

#include "raymarch/level_set/level_set_view.h"

namespace limn {

enum class BrickGradient : std::uint8_t { cell, central, cubic };

struct BrickTrace {
  const BrickView* view = nullptr;
  BrickGradient gradient = BrickGradient::central;
  const std::uint8_t* lowered = nullptr;  ///< By BrickHits::cell: 0, or 1 + the gradient that the cell takes instead. Null: none does.
  float normal_from_index[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< Column by column: gradients by index coordinates to render space.
};

/// Where the first root of each ray lies, and in which cell.
struct BrickHits {
  alignas(64) float t[kRayBatchSize];
  alignas(64) std::int32_t cell[kRayBatchSize];  ///< Brick times 512, and the cell's number in it (x 64 + y 8 + z); -1: none.
};

/// Traces the rays of `tile` (lanes in blocks of 4 x 4 pixels, see PixelTile) and fills `hits`.
void trace_bricks(const BrickTrace& what, const PixelTile& tile, const RayBatch& rays, HitBatch& hits);

}  // namespace limn
