#define NANOVDB_USE_TBB
#include <nanovdb/util/GridStats.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <iterator>

#include "sdf/level_set_fill.h"
#include "sdf/level_set_nano.h"
#include "sdf/nano_memory.h"
#include "sdf/page_advice.h"
#include "sdf/parallel.h"
#include "sdf/volume_module.h"

namespace limn {
namespace {

using Handle = nanovdb::GridHandle<nanovdb::HostBuffer>;
using Leaf = nanovdb::NanoLeaf<float>;

nanovdb::Coord coord(const glm::ivec3& p) { return {p.x, p.y, p.z}; }

Handle copied(const Handle& from) {
  nanovdb::HostBuffer buffer = in_nano_memory([&] { return nanovdb::HostBuffer::create(from.size()); });
  ask_for_large_pages(buffer.data(), from.size());
  parallel_parts(from.size(), size_t{1} << 20, [&](const IndexRange<size_t>& part) {
    std::copy(from.data() + part.first, from.data() + part.last, buffer.data() + part.first);
  });
  return Handle(std::move(buffer));
}

/// Into the values and the mask of a leaf, or of what will be one.
void write_nodes(const FilledBlock& block, float* values, std::uint64_t* active) {
  for (size_t word = 0; word < 8; ++word) {
    for (std::uint64_t nodes = block.filled[word] | block.kept_out[word]; nodes != 0; nodes &= nodes - 1) {
      const size_t n = 64 * word + static_cast<size_t>(std::countr_zero(nodes));
      values[n] = block.values[n];
    }
    active[word] = (active[word] | block.filled[word]) & ~block.kept_out[word];
  }
}

/// How many nodes more lie in the band then.
std::int64_t write_nodes(const FilledBlock& block, Leaf& leaf) {
  auto& data = *leaf.data();
  const auto before = static_cast<std::int64_t>(data.mValueMask.countOn());
  write_nodes(block, data.mValues, &data.mValueMask.getWord<std::uint64_t>(0));
  return static_cast<std::int64_t>(data.mValueMask.countOn()) - before;
}

std::shared_ptr<LevelSetData> as_before(const LevelSet& level_set, Handle handle) {
  const LevelSetInfo& info = level_set.info();
  return make_level_set(std::move(handle), info.world_from_index, info.name, info.half_width_voxels);
}

/// Every block has its leaf.
std::shared_ptr<LevelSetData> filled_in_place(const LevelSet& level_set, const std::vector<FilledBlock>& blocks) {
  Handle handle = copied(level_set.data().handle);
  nanovdb::FloatGrid& grid = *handle.grid<float>();
  std::atomic<std::int64_t> more{0};
  parallel_parts(blocks.size(), size_t{64}, [&](const IndexRange<size_t>& range) {
    const nanovdb::FloatGrid::AccessorType accessor = grid.getAccessor();
    std::int64_t of_part = 0;
    for (size_t i = range.begin(); i < range.end(); ++i)
      of_part += write_nodes(blocks[i], const_cast<Leaf&>(*accessor.probeLeaf(coord(blocks[i].origin))));
    more += of_part;
  });
  grid.tree().data()->mVoxelCount += static_cast<std::uint64_t>(more.load());
  nanovdb::gridStats(grid, nanovdb::StatsMode::BBox);
  return as_before(level_set, std::move(handle));
}

/// The leaves that a grid has, and those that it will have besides, each with what is filled in.
struct Leaves {
  std::vector<glm::ivec3> origins{};
  std::vector<const FilledBlock*> filled{};
};

Leaves leaves_of(const nanovdb::FloatGrid& grid, const std::vector<FilledBlock>& blocks) {
  const Leaf* const first = grid.tree().getFirstNode<0>();
  const std::uint32_t count = grid.tree().nodeCount(0);
  Leaves leaves;
  for (std::uint32_t i = 0; i < count; ++i) {
    const nanovdb::Coord origin = first[i].origin();
    leaves.origins.emplace_back(origin[0], origin[1], origin[2]);
  }
  leaves.filled.resize(count, nullptr);
  const nanovdb::FloatGrid::AccessorType accessor = grid.getAccessor();
  for (const FilledBlock& block : blocks) {
    if (const Leaf* const leaf = accessor.probeLeaf(coord(block.origin))) {
      leaves.filled[static_cast<size_t>(leaf - first)] = &block;
    } else {
      leaves.origins.push_back(block.origin);
      leaves.filled.push_back(&block);
    }
  }
  return leaves;
}

/// Of the grid, without what is filled in. Where it has no leaf, of a tile.
LevelSetBlock block_of(const nanovdb::FloatGrid::AccessorType& accessor, const glm::ivec3& origin) {
  LevelSetBlock block{};
  block.origin = origin;
  if (const Leaf* const leaf = accessor.probeLeaf(coord(origin))) {
    std::copy_n(leaf->data()->mValues, 512, block.values);
    for (int word = 0; word < 8; ++word) block.active[word] = leaf->data()->mValueMask.getWord<std::uint64_t>(word);
  } else {
    std::fill_n(block.values, 512, accessor.getValue(coord(origin)));
  }
  return block;
}

/// What nano_grid() writes as it is: nodes outside the band hold the background, either way.
bool is_plain(const LevelSetBlock& block, float background) {
  for (size_t n = 0; n < 512; ++n)
    if ((block.active[n >> 6] >> (n & 63) & 1) == 0 && std::abs(block.values[n]) != background) return false;
  return has_active_node(block);
}

/// With leaves more. Null for grids that are not as limn makes them: OpenVDB keeps whatever they hold.
std::shared_ptr<LevelSetData> filled_anew(const LevelSet& level_set, const std::vector<FilledBlock>& blocks) {
  const nanovdb::FloatGrid& grid = *level_set.data().grid;
  const float background = std::abs(grid.tree().background());
  const auto& tiles = grid.tree().data()->mTileCount;
  if (std::any_of(std::begin(tiles), std::end(tiles), [](auto count) { return count != 0; })) return nullptr;
  const Leaves leaves = leaves_of(grid, blocks);
  std::atomic<bool> plain{true};
  const FillLeaves fill = [&](const IndexRange<size_t>& part, const WriteLeaf& write) {
    const nanovdb::FloatGrid::AccessorType accessor = grid.getAccessor();
    for (size_t i = part.first; i < part.last; ++i) {
      LevelSetBlock block = block_of(accessor, leaves.origins[i]);
      if (leaves.filled[i] != nullptr) write_nodes(*leaves.filled[i], block.values, block.active);
      if (!is_plain(block, background)) plain = false;
      write(i, block);
    }
  };
  const auto inside = [&grid](const glm::dvec3& place) {
    const glm::ivec3 node(glm::floor(place));
    return grid.tree().getValue(coord(node)) < 0.0f;
  };
  Handle handle = nano_grid(leaves.origins, fill, background, inside);
  return plain ? as_before(level_set, std::move(handle)) : nullptr;
}

}  // namespace

std::shared_ptr<LevelSetData> with_filled_nodes(const LevelSet& level_set, const std::vector<FilledBlock>& blocks) {
  std::shared_ptr<LevelSetData> data;
  if (level_set.data().handle.gridCount() == 1) {
    const nanovdb::FloatGrid::AccessorType has = level_set.data().accessor();
    const bool all =
        std::all_of(blocks.begin(), blocks.end(), [&](const FilledBlock& block) { return has.probeLeaf(coord(block.origin)) != nullptr; });
    data = all ? filled_in_place(level_set, blocks) : filled_anew(level_set, blocks);
  }
  if (!data) data = volume_module().with_filled_nodes(level_set, blocks);
  data->info.build_ms = level_set.info().build_ms;
  take_over(level_set, *data);
  return data;
}

}  // namespace limn
