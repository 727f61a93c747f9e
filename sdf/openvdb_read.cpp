#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <ios>

#include "sdf/error.h"
#include "sdf/finite.h"
#include "sdf/openvdb_grid.h"
#include "sdf/openvdb_metadata.h"
#include "sdf/openvdb_settle.h"
#include "sdf/openvdb_stored.h"
#include "sdf/parallel.h"
#include "sdf/read_vdb.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

std::string described(const StoredGrid& grid) { return "'" + grid.shown + "' (" + grid.grid_class + ", " + grid.value_type + ")"; }

std::string all_described(const std::vector<StoredGrid>& grids) {
  std::string text;
  for (const StoredGrid& grid : grids) text += (text.empty() ? "" : ", ") + described(grid);
  return text.empty() ? "none" : text;
}

void check_kind(const StoredGrid& grid) {
  const std::string what = "the grid '" + grid.shown + "'";
  if (!grid.is_distance) refuse_volume("grid", grid.value_type, what + " does not hold distances", "a level set of float, double or half");
  if (grid.grid_class == "fog volume")
    refuse_volume("grid", "fog volume", what + " is a fog volume: densities, without a surface of their own",
                  "a grid of class 'level set' (extract the surface of the fog first)");
  if (grid.grid_class != "level set" && grid.grid_class != "unknown")
    refuse_volume("grid", grid.grid_class, what + " is not a level set by its class", "a grid of class 'level set'");
  if (!grid.warped.empty())
    refuse_volume("grid", grid.warped, what + " has a frustum transform, in which no distance is true",
                  "a linear transform (resample it onto a uniform grid)");
}

/// The grids that a name can mean: one, or all that have it where it is no more than that.
std::vector<size_t> meant_by(const std::string& name, const std::vector<StoredGrid>& grids) {
  std::vector<size_t> found;
  for (size_t i = 0; i < grids.size(); ++i) {
    if (!name.empty() && grids[i].shown == name) return {i};
    if (name.empty() ? grids[i].is_level_set() : grids[i].name == name) found.push_back(i);
  }
  if (!name.empty() || !found.empty()) return found;
  for (size_t i = 0; i < grids.size(); ++i)
    if (grids[i].may_be_level_set()) found.push_back(i);
  return found;
}

size_t choose(const std::vector<StoredGrid>& grids, const std::string& name) {
  const std::vector<size_t> found = meant_by(name, grids);
  if (found.size() == 1) return found.front();
  if (name.empty() && found.empty()) {
    if (grids.size() == 1) check_kind(grids.front());
    refuse_volume("grid", "", "no level set in the file", "one of class 'level set'; grids: " + all_described(grids));
  }
  if (name.empty()) refuse_volume("grid", "", "more than one level set", "one of them by name; grids: " + all_described(grids));
  if (!found.empty())
    refuse_volume("grid", name, "more than one grid has that name", "one of them by its index; grids: " + all_described(grids));
  std::vector<std::string> names;
  for (const StoredGrid& grid : grids) names.push_back(grid.shown);
  const std::string near = nearest_name(name, names);
  refuse_volume("grid", name, "no such grid", "one of " + all_described(grids) + (near.empty() ? "" : "; did you mean '" + near + "'?"));
}

openvdb::FloatGrid::Ptr as_float(const openvdb::GridBase::Ptr& grid) {
  if (const auto single = openvdb::gridPtrCast<openvdb::FloatGrid>(grid)) return single;
  return std::make_shared<openvdb::FloatGrid>(*openvdb::gridPtrCast<openvdb::DoubleGrid>(grid));
}

void check_voxels(const openvdb::FloatGrid& grid, const std::string& name) {
  const std::string what = "the grid '" + name + "'";
  const float background = grid.background();
  if (grid.activeVoxelCount() == 0) refuse_volume("grid", name, what + " is empty: it has no active voxel", "a narrow band of distances");
  if (!std::isfinite(background) || background <= 0.0f)
    refuse_volume("grid", std::to_string(background), what + " is not initialised: its background is not a distance",
                  "the band's half width, above 0");
  if (grid.tree().activeTileCount() > 0)
    refuse_volume("grid", name, what + " has constant regions that are active: no band of distances",
                  "active voxels in a narrow band only");
}

/// A grid without a class is a level set where it has distances of both signs.
void check_signs(const openvdb::FloatGrid& grid, const StoredGrid& stored) {
  if (stored.is_level_set()) return;
  bool inside = false, outside = false;
  for (auto value = grid.cbeginValueOn(); value && !(inside && outside); ++value) (*value < 0.0f ? inside : outside) = true;
  if (!inside || !outside)
    refuse_volume("grid", stored.grid_class, "the grid '" + stored.shown + "' has no class, and its values do not change sign",
                  "a grid of class 'level set', or distances that are negative inside");
}

using Leaf = openvdb::FloatTree::LeafNodeType;

void write_block(const Leaf& leaf, float background, LevelSetBlock& block) {
  block.origin = {leaf.origin().x(), leaf.origin().y(), leaf.origin().z()};
  for (openvdb::Index word = 0; word < 8; ++word) block.active[word] = leaf.valueMask().getWord<openvdb::Index64>(word);
  const float* const values = leaf.buffer().data();
  for (openvdb::Index word = 0; word < 8; ++word) {
    for (openvdb::Index bit = 0; bit < 64; ++bit) {
      const openvdb::Index n = 64 * word + bit;
      const bool active = (block.active[word] >> bit & 1) != 0;
      block.values[n] = active ? values[n] : values[n] < 0.0f ? -background : background;
    }
  }
}

void check_finite(std::span<const LevelSetBlock> blocks, const std::string& name) {
  for (const LevelSetBlock& block : blocks) {
    const float* const wrong = std::find_if_not(std::begin(block.values), std::end(block.values), [](float v) { return std::isfinite(v); });
    if (wrong != std::end(block.values))
      refuse_volume("grid", std::to_string(*wrong), "the grid '" + name + "' holds a distance that is no number", "finite values");
  }
}

/// Where a band was cut, leaves without a distance may still have an inside and an outside.
bool has_both_signs(const Leaf& leaf) {
  const bool inside = leaf.getFirstValue() < 0.0f;
  for (openvdb::Index n = 1; n < 512; ++n)
    if ((leaf.getValue(n) < 0.0f) != inside) return true;
  return false;
}

void put_blocks(const openvdb::FloatGrid& grid, const std::string& name, ByteWriter& answer) {
  std::vector<const Leaf*> leaves;
  leaves.reserve(grid.tree().leafCount());
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf)
    if (!leaf->isEmpty() || has_both_signs(*leaf)) leaves.push_back(leaf.getLeaf());
  const std::span<LevelSetBlock> blocks = answer.put_room<LevelSetBlock>(leaves.size());
  std::atomic<bool> good = true;
  const auto write = [&](const IndexRange<size_t>& part) {
    for (size_t i = part.first; i < part.last; ++i) {
      write_block(*leaves[i], grid.background(), blocks[i]);
      if (!all_finite(blocks[i].values)) good = false;
    }
  };
  // Threads take address space, of which the helper may have little: a few of them, for many leaves.
  constexpr size_t kManyLeaves = 4096;
  constexpr int kThreads = 4;
  if (leaves.size() < kManyLeaves)
    write({0, leaves.size()});
  else
    tbb::task_arena(kThreads).execute([&] { parallel_parts(leaves.size(), size_t{256}, write); });
  if (!good) check_finite(blocks, name);
}

std::vector<VdbTile> inner_tiles_of(const openvdb::FloatGrid& grid) {
  std::vector<VdbTile> tiles;
  auto tile = grid.tree().cbeginValueOff();
  tile.setMaxDepth(openvdb::FloatTree::ValueOffCIter::LEAF_DEPTH - 1);
  for (; tile; ++tile)
    if (*tile < 0.0f)
      tiles.push_back({{tile.getCoord().x(), tile.getCoord().y(), tile.getCoord().z()}, static_cast<std::int32_t>(tile.getLevel())});
  // A leaf without an active voxel is not sent; inside, it becomes a tile.
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf)
    if (leaf->isEmpty() && !has_both_signs(*leaf) && leaf->getFirstValue() < 0.0f)
      tiles.push_back({{leaf->origin().x(), leaf->origin().y(), leaf->origin().z()}, 1});
  return tiles;
}

/// OpenVDB's exceptions name the class they belong to, which says nothing to anyone who gave us a file.
template <class Read>
void reading(Read&& read) {
  try {
    read();
  } catch (const InputError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::ios::failure&) {
    refuse_volume("", "", "breaks off before its end", "an undamaged file");
  } catch (const std::exception& problem) {
    refuse_volume("", "", std::string("cannot be read as a volume: ") + problem.what(), "an undamaged .vdb");
  }
}

StoredGrids stored_in(const fs::path& file) { return is_nvdb(file) ? stored_in_nvdb(file) : stored_in_vdb(file); }

/// What single precision does not hold of a grid of doubles; nothing of any other.
std::vector<DoubleBlock> doubles_of(const openvdb::GridBase::Ptr& grid) {
  std::vector<DoubleBlock> blocks;
  const auto doubles = openvdb::gridPtrCast<openvdb::DoubleGrid>(grid);
  if (!doubles) return blocks;
  blocks.reserve(doubles->tree().leafCount());
  for (auto leaf = doubles->tree().cbeginLeaf(); leaf; ++leaf) {
    DoubleBlock& block = blocks.emplace_back();
    block.origin = {leaf->origin().x(), leaf->origin().y(), leaf->origin().z()};
    for (openvdb::Index n = 0; n < 512; ++n) block.values[n] = leaf->isValueOn(n) ? leaf->getValue(n) : 0.0;
  }
  return blocks;
}

/// Quantised values of NanoVDB are floats once they are read; whatever is filed as half is one of single precision.
std::string filed_type(const StoredGrid& grid) {
  return grid.value_type == "double" || grid.value_type == "half" ? grid.value_type : "float";
}

void put_metadata(const std::vector<GridMetadata>& metadata, ByteWriter& answer) {
  answer.put(static_cast<std::uint64_t>(metadata.size()));
  for (const GridMetadata& entry : metadata) {
    answer.put_text(entry.name);
    answer.put_text(entry.type);
    answer.put_text(entry.bytes);
  }
}

void put_file(const StoredGrid& stored, const openvdb::GridBase::Ptr& grid, const std::vector<GridMetadata>& of_file, ByteWriter& answer) {
  answer.put_text(filed_type(stored));
  answer.put_text(stored.grid_class);
  put_metadata(plain_metadata(*grid), answer);
  put_metadata(of_file, answer);
  answer.put_span(std::span<const DoubleBlock>(filed_type(stored) == "double" ? doubles_of(grid) : std::vector<DoubleBlock>{}));
}

openvdb::GridBase::Ptr put_grid(const StoredGrids& grids, size_t chosen, ByteWriter& answer) {
  const StoredGrid& stored = grids.list[chosen];
  check_kind(stored);
  const openvdb::GridBase::Ptr filed = grids.read(chosen);
  const openvdb::FloatGrid::Ptr grid = as_float(filed);
  settle_band(*grid);
  check_voxels(*grid, stored.shown);
  check_signs(*grid, stored);

  answer.put_text(stored.name);
  const openvdb::math::Mat4d matrix = filed->transform().baseMap()->getAffineMap()->getMat4();
  for (int row = 0; row < 4; ++row)
    for (int k = 0; k < 3; ++k) answer.put(matrix(row, k));
  answer.put(grid->background());
  put_blocks(*grid, stored.shown, answer);
  answer.put_span(std::span<const VdbTile>(inner_tiles_of(*grid)));
  put_file(stored, filed, grids.metadata, answer);
  return filed;
}

/// To take a large tree apart takes a while, and the process is about to end.
void keep_to_the_end(openvdb::GridBase::Ptr grid) {
  static auto* const kept = new std::vector<openvdb::GridBase::Ptr>;
  kept->push_back(std::move(grid));
}

void put_list(const StoredGrids& grids, ByteWriter& answer) {
  answer.put(static_cast<std::uint64_t>(grids.list.size()));
  for (const StoredGrid& grid : grids.list) {
    answer.put_text(grid.shown);
    answer.put_text(grid.value_type);
    answer.put_text(grid.grid_class);
    answer.put(grid.voxels);
    answer.put(grid.voxel_size);
  }
}

void put_each(const StoredGrids& grids, std::span<const size_t> chosen, ByteWriter& answer) {
  for (const size_t i : chosen) {
    answer.put_text(grids.list[i].shown);
    const size_t before = answer.size();
    try {
      reading([&] {
        answer.put(std::uint8_t{1});
        const size_t begun = answer.begin_part();
        put_grid(grids, i, answer);
        answer.end_part(begun);
      });
    } catch (const InputError& error) {
      answer.shrink(before);
      answer.put(std::uint8_t{0});
      answer.put_text(error.fault().problem);
    }
  }
}

}  // namespace

void put_vdb_list(const fs::path& file, ByteWriter& answer) {
  reading([&] { put_list(stored_in(file), answer); });
}

void put_vdb_grid(const fs::path& file, const std::string& name, ByteWriter& answer) {
  reading([&] {
    const StoredGrids grids = stored_in(file);
    keep_to_the_end(put_grid(grids, choose(grids.list, name), answer));
  });
}

void put_vdb_all(const fs::path& file, ByteWriter& answer) {
  reading([&] {
    const StoredGrids grids = stored_in(file);
    put_list(grids, answer);
    const std::vector<size_t> chosen = meant_by("", grids.list);
    answer.put(static_cast<std::uint8_t>(chosen.size() > 1 ? 1 : 0));
    if (chosen.size() > 1) return put_each(grids, chosen, answer);
    const size_t begun = answer.begin_part();
    keep_to_the_end(put_grid(grids, choose(grids.list, ""), answer));
    answer.end_part(begun);
  });
}

}  // namespace limn
