#pragma once
// Internal: which bricks each 16 x 16-pixel tile of a picture sees, nearest first.

#include <span>

#include "raymarch/level_set/bricks.h"
#include "raymarch/surface.h"

namespace limn {

inline constexpr int kViewTile_px = 16;

/// A group of bricks in a tile: the pixels of the tile whose rays may meet it, first to last inclusive, from the tile's corner.
struct GroupInTile {
  std::uint32_t group = 0;
  std::uint8_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

struct BrickView {
  std::shared_ptr<const RayBricks> bricks{};
  const BrickGroups* groups = nullptr;  ///< Those that the tiles list; null where there are none.
  Affine index_from_render{};
  /// By how much boxes and slabs are widened, so that no root is lost to the rounding of a ray's places.
  float slack_voxels = 1e-3f;
  float side = 1.0f;  ///< +1 where the rays start outside the surface, -1 inside.
  int columns = 0, rows = 0;
  std::vector<std::uint32_t> first{};  ///< Of each tile in `entries`, and the end; row by row.
  std::vector<GroupInTile> entries{};

  std::span<const GroupInTile> tile(int column, int row) const {
    const auto i = static_cast<size_t>(row) * static_cast<size_t>(columns) + static_cast<size_t>(column);
    return std::span(entries).subspan(first[i], first[i + 1] - first[i]);
  }
};

/// False where no brick is listed in the tile, which may start anywhere.
bool touches(const BrickView& view, const PixelTile& tile);

/// Lists the bricks by tile, without those that show the camera only their back. Empty where it cannot tell on which side of the surface
/// the rays start (a parallel projection whose plane Z = 0 cuts the surface). `inside`: the eye is inside the surface.
std::shared_ptr<const BrickView> view_bricks(const std::shared_ptr<const RayBricks>& bricks, const Affine& index_from_render, bool inside,
                                             const ViewRequest& request);

}  // namespace limn
