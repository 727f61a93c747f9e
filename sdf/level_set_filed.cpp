// Grids of files that are in order, without OpenVDB: it takes longer to load than such a grid to be made.

#include <algorithm>
#include <array>
#include <atomic>
#include <functional>

#include "sdf/level_set_nano.h"
#include "sdf/read_vdb.h"

namespace limn {
namespace {

using Tree = nanovdb::FloatGrid::TreeType;
using Accessor = nanovdb::FloatGrid::AccessorType;
/// How many tiles inside the surface a tree has, by their level: 1 to 3.
using TileCounts = std::array<size_t, 4>;

template <class Node>
size_t tiles_inside(const Tree& tree) {
  constexpr int kLevel = static_cast<int>(Node::LEVEL);
  const Node* const nodes = tree.getFirstNode<kLevel>();
  return parallel_reduce(
      size_t{tree.nodeCount(kLevel)}, size_t{1}, size_t{0},
      [&](const IndexRange<size_t>& part, size_t count) {
        for (size_t i = part.first; i < part.last; ++i) {
          const auto& data = *nodes[i].data();
          for (std::uint32_t n = 0; n < Node::SIZE; ++n) count += !data.mChildMask.isOn(n) && data.getValue(n) < 0.0f ? 1 : 0;
        }
        return count;
      },
      std::plus<>());
}

TileCounts tiles_inside_of(const Tree& tree) {
  TileCounts counts{0, tiles_inside<nanovdb::NanoLower<float>>(tree), tiles_inside<nanovdb::NanoUpper<float>>(tree), 0};
  const auto& root = *tree.root().data();
  for (std::uint32_t i = 0; i < root.mTableSize; ++i) counts[3] += !root.tile(i)->isChild() && root.tile(i)->value < 0.0f ? 1 : 0;
  return counts;
}

/// Whether the tree has just these tiles inside. As many of each level, and each of the list among them: so there are no others.
bool has_tiles(const nanovdb::FloatGrid& grid, std::span<const VdbTile> tiles) {
  TileCounts listed{};
  for (const VdbTile& tile : tiles) ++listed[static_cast<size_t>(tile.level)];
  if (listed != tiles_inside_of(grid.tree())) return false;
  const auto are_there = [&](const IndexRange<size_t>& part, bool so_far) {
    const Accessor accessor = grid.getAccessor();
    return so_far && std::all_of(tiles.begin() + static_cast<std::ptrdiff_t>(part.first),
                                 tiles.begin() + static_cast<std::ptrdiff_t>(part.last), [&](const VdbTile& tile) {
                                   const nanovdb::Coord at(tile.origin.x, tile.origin.y, tile.origin.z);
                                   return accessor.getNodeInfo(at).mLevel == static_cast<std::uint32_t>(tile.level) &&
                                          accessor.getValue(at) < 0.0f;
                                 });
  };
  return parallel_reduce(tiles.size(), size_t{1024}, true, are_there, std::logical_and<>());
}

bool has_values(const nanovdb::FloatGrid& grid, std::span<const LevelSetBlock> blocks) {
  std::atomic<bool> same = true;
  parallel_parts(blocks.size(), size_t{64}, [&](const IndexRange<size_t>& part) {
    const Accessor accessor = grid.getAccessor();
    for (size_t i = part.first; i < part.last && same; ++i) {
      const LevelSetBlock& block = blocks[i];
      const auto* leaf = accessor.probeLeaf(nanovdb::Coord(block.origin.x, block.origin.y, block.origin.z));
      if (leaf == nullptr || !std::equal(std::begin(block.values), std::end(block.values), leaf->data()->mValues)) same = false;
    }
  });
  return same;
}

}  // namespace

std::optional<nanovdb::GridHandle<nanovdb::HostBuffer>> nano_grid_as_filed(std::span<const LevelSetBlock> blocks,
                                                                           std::span<const VdbTile> tiles, float background) {
  const auto are_active = [&](const IndexRange<size_t>& part, bool so_far) {
    for (size_t i = part.first; i < part.last; ++i) so_far = so_far && has_active_node(blocks[i]);
    return so_far;
  };
  if (blocks.empty() || !parallel_reduce(blocks.size(), size_t{256}, true, are_active, std::logical_and<>())) return std::nullopt;
  nanovdb::GridHandle<nanovdb::HostBuffer> handle = nano_grid(blocks, background);
  const nanovdb::FloatGrid& grid = *handle.grid<float>();
  if (!has_tiles(grid, tiles) || !has_values(grid, blocks)) return std::nullopt;
  return handle;
}

}  // namespace limn
