#include "sdf/openvdb_settle.h"

#include <openvdb/tools/SignedFloodFill.h>

#include <cmath>
#include <set>
#include <vector>

namespace limn {
namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;

// Values this near to the background, and beyond it, are no distances.
constexpr float kWithin = 0.999f;
// Of constant regions in the band as leaves: more would be no band.
constexpr openvdb::Index64 kMostTileVoxels = openvdb::Index64{1} << 25;
// Constants that tools leave outside the band are few; distances there are many.
constexpr size_t kManyValues = 16;
constexpr openvdb::Index64 kLookedAt = 4096;

void settle_tiles(openvdb::FloatGrid& grid) {
  if (grid.tree().activeTileCount() == 0) return;
  struct Tile {
    openvdb::Coord origin;
    openvdb::Index level;
    float value;
  };
  const float background = grid.background();
  std::vector<Tile> far_tiles;
  openvdb::Index64 near_voxels = 0;
  auto tile = grid.tree().cbeginValueOn();
  tile.setMaxDepth(openvdb::FloatTree::ValueOnCIter::LEAF_DEPTH - 1);
  for (; tile; ++tile) {
    if (std::abs(*tile) >= kWithin * background)
      far_tiles.push_back({tile.getCoord(), tile.getLevel(), std::copysign(background, *tile)});
    else
      near_voxels += tile.getVoxelCount();
  }
  for (const Tile& each : far_tiles) grid.tree().addTile(each.level, each.origin, each.value, false);
  if (near_voxels > 0 && near_voxels <= kMostTileVoxels) grid.tree().voxelizeActiveTiles();
}

bool is_distance(float value, float background) { return std::abs(value) > 0.0f && std::abs(value) < kWithin * background; }

bool holds_distances_outside(const openvdb::FloatGrid& grid) {
  std::set<float> seen;
  // Of a large grid some leaves tell.
  const openvdb::Index64 step = grid.tree().leafCount() / kLookedAt + 1;
  openvdb::Index64 number = 0;
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
    if (number++ % step != 0 || leaf->isDense()) continue;
    for (openvdb::Index n = 0; n < Leaf::SIZE; ++n) {
      if (leaf->isValueOn(n) || !is_distance(leaf->getValue(n), grid.background())) continue;
      seen.insert(std::abs(leaf->getValue(n)));
      if (seen.size() >= kManyValues) return true;
    }
  }
  return false;
}

int blocks_to_a_side(const VdbTile& tile) { return tile.level == 1 ? 1 : tile.level == 2 ? 16 : 512; }

/// Whether the block of a tile touches a tile outside the surface.
bool touches_outside(const openvdb::FloatGrid::ConstAccessor& accessor, const openvdb::Coord& block) {
  for (int k = 0; k < 27; ++k) {
    const openvdb::Coord other = block.offsetBy(8 * (k / 9 - 1), 8 * (k / 3 % 3 - 1), 8 * (k % 3 - 1));
    if (k != 13 && !accessor.probeConstLeaf(other) && accessor.getValue(other) >= 0.0f) return true;
  }
  return false;
}

}  // namespace

void settle_band(openvdb::FloatGrid& grid) {
  if (!(grid.background() > 0.0f) || !std::isfinite(grid.background())) return;
  settle_tiles(grid);
  if (!holds_distances_outside(grid)) return;
  for (auto leaf = grid.tree().beginLeaf(); leaf; ++leaf)
    for (openvdb::Index n = 0; n < Leaf::SIZE; ++n)
      if (is_distance(leaf->getValue(n), grid.background())) leaf->setValueOn(n);
}

void seal_tiles(openvdb::FloatGrid& grid, std::span<const VdbTile> inside) {
  std::vector<openvdb::Coord> found;
  // Far from every leaf no band was cut: what tiles do there is no surface.
  openvdb::CoordBBox leaves;
  if (!grid.tree().evalLeafBoundingBox(leaves)) return;
  leaves.expand(8);
  const openvdb::FloatGrid::ConstAccessor accessor = grid.getConstAccessor();
  // A torn band is sealed by about as many leaves as it has: what would take many more is no band, and nothing is worth its time.
  const size_t most = 4 * static_cast<size_t>(grid.tree().leafCount()) + 4096;
  size_t looked_at = 0;
  for (const VdbTile& tile : inside) {
    const int last = blocks_to_a_side(tile) - 1;
    const openvdb::Coord origin(tile.origin.x, tile.origin.y, tile.origin.z);
    openvdb::CoordBBox within = openvdb::CoordBBox::createCube(origin, 8 * (last + 1));
    within.intersect(leaves);
    if (within.empty()) continue;
    const openvdb::Coord from = (within.min() - origin) >> 3, to = (within.max() - origin) >> 3;
    for (int x = from.x(); x <= to.x(); ++x)
      for (int y = from.y(); y <= to.y(); ++y) {
        const bool side = x == 0 || y == 0 || x == last || y == last;
        for (int z = from.z(); z <= to.z(); ++z) {
          if (!side && z != 0 && z != last) continue;
          const openvdb::Coord block = origin.offsetBy(8 * x, 8 * y, 8 * z);
          if (++looked_at > 64 * most || found.size() > most) return;
          if (touches_outside(accessor, block)) found.push_back(block);
        }
      }
  }
  for (const openvdb::Coord& block : found)
    if (grid.tree().probeLeaf(block) == nullptr) grid.tree().touchLeaf(block);
}

openvdb::FloatGrid::Ptr flood_filled(const openvdb::FloatGrid& grid) {
  openvdb::FloatGrid::Ptr copy = grid.deepCopy();
  openvdb::tools::signedFloodFill(copy->tree());
  return copy;
}

}  // namespace limn
