#define NANOVDB_USE_TBB
#include <nanovdb/util/GridStats.h>

#include <algorithm>
#include <atomic>
#include <bit>

#include "sdf/level_set_fill.h"
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

/// How many nodes more lie in the band then.
std::int64_t write_nodes(const FilledBlock& block, Leaf& leaf) {
  auto& data = *leaf.data();
  const auto active = [&](std::uint32_t word) -> std::uint64_t& { return data.mValueMask.getWord<std::uint64_t>(static_cast<int>(word)); };
  std::int64_t more = 0;
  for (std::uint32_t word = 0; word < 8; ++word) {
    const std::uint64_t before = active(word);
    for (std::uint64_t nodes = block.filled[word] | block.kept_out[word]; nodes != 0; nodes &= nodes - 1) {
      const std::uint32_t n = word * 64 + static_cast<std::uint32_t>(std::countr_zero(nodes));
      data.mValues[n] = block.values[n];
    }
    active(word) = (before | block.filled[word]) & ~block.kept_out[word];
    more += std::popcount(active(word)) - std::popcount(before);
  }
  return more;
}

/// Null where there is no leaf for one of the blocks: OpenVDB finds new ones their places in the tree.
std::shared_ptr<LevelSetData> filled_in_place(const LevelSet& level_set, const std::vector<FilledBlock>& blocks) {
  const LevelSetData& from = level_set.data();
  if (from.handle.gridCount() != 1) return nullptr;
  const nanovdb::FloatGrid::AccessorType has = from.accessor();
  if (!std::all_of(blocks.begin(), blocks.end(), [&](const FilledBlock& block) { return has.probeLeaf(coord(block.origin)) != nullptr; }))
    return nullptr;
  Handle handle = copied(from.handle);
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
  const LevelSetInfo& info = level_set.info();
  return make_level_set(std::move(handle), info.world_from_index, info.name, info.half_width_voxels);
}

}  // namespace

std::shared_ptr<LevelSetData> with_filled_nodes(const LevelSet& level_set, const std::vector<FilledBlock>& blocks) {
  std::shared_ptr<LevelSetData> data = filled_in_place(level_set, blocks);
  if (!data) data = volume_module().with_filled_nodes(level_set, blocks);
  data->info.build_ms = level_set.info().build_ms;
  take_over(level_set, *data);
  return data;
}

}  // namespace limn
