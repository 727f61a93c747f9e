#pragma once
// Internal: which triangle each ray of a tile meets first.

#include "raymarch/mesh/mesh_view.h"

namespace limn {

/// The nearest triangle so far in each lane. Of equally near ones that of lower index counts.
struct TileCover {
  alignas(64) double nearness[kRayBatchSize];  ///< As ScreenVertex::nearness; -infinity: none yet.
  alignas(64) double triangle[kRayBatchSize];  ///< Its index, a whole number.
  /// The hit's weights in space of the second and third corner, and the sum of all three's, by which to divide.
  alignas(64) double weight_b[kRayBatchSize], weight_c[kRayBatchSize], weight_sum[kRayBatchSize];
};

/// Tests the triangles that `view` lists for the tile's pixels. `lanes`: how many the tile has, a multiple of 16.
void cover_tile(const MeshView& view, const PixelTile& tile, int lanes, TileCover& cover);

}  // namespace limn
