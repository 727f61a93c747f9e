#pragma once
// Internal: the rays of one tile against its bricks, in packets of the machine's widest SIMD.

#include <span>

#include "raymarch/level_set/brick_tree.h"
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

/// Most sizes of voxels in one surface.
inline constexpr size_t kMostBrickSizes = 24;

/// Traces the rays of `tile` (lanes in blocks of 4 x 4 pixels, see PixelTile) and fills `hits`: the first hits in the bricks of all of
/// `sizes`, at most kMostBrickSizes of them.
void trace_bricks(std::span<const BrickTrace> sizes, const PixelTile& tile, const RayBatch& rays, HitBatch& hits);

/// The same for rays that have nothing in common but the side of the surface on which they start: the views' tiles are not read. `trees`
/// has one for each of `sizes`. Packets are whole: `rays.count` is a multiple of 16, and lanes without a ray are idle (t_min above t_max).
void trace_bricks_singly(std::span<const BrickTrace> sizes, std::span<const BrickTree* const> trees, const RayBatch& rays, HitBatch& hits);

}  // namespace limn
