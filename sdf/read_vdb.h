#pragma once
// Internal: what the helper program limn-read-vdb sends, written in openvdb_read.cpp (the helper's side) and read in
// level_set_file.cpp (ours).

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sdf/level_set.h"
#include "sdf/level_set_grids.h"

namespace limn {

/// A constant block of the tree that lies inside the surface; those outside go without saying.
struct VdbTile {
  glm::ivec3 origin;   ///< Index coordinates.
  std::int32_t level;  ///< 1: 8 nodes to a side, 2: 128, 3: 4096.
};

/// Answer: count, then name (with its index where several have it), value type, class, active voxels (int64), voxel size (double) of each
/// grid. Throws InputError.
std::vector<std::byte> vdb_list_answer(const std::filesystem::path& file);

/// Answer: name, linear part of world_from_index by columns and translation (12 doubles), background (float), blocks, tiles,
/// and what the file says beside (GridFile: value type, class, metadata of the grid and of the file, each as count and name, type and
/// bytes; blocks of doubles). Throws InputError, without the name of the file, for all that read_level_set refuses but a grid without a
/// surface.
std::vector<std::byte> vdb_grid_answer(const std::filesystem::path& file, const std::string& grid);

/// Answer: of each level set of the file (grids without a class where there is none) the name as shown, whether it could be read (uint8),
/// and what vdb_grid_answer says of it, as a span of bytes, or, as text, why not. A process a grid would take 80 ms for each.
/// All three read .vdb and .nvdb, and tell which by a file's first bytes.
std::vector<std::byte> vdb_all_answer(const std::filesystem::path& file);

/// Our side of these answers, of which nothing is taken on trust. Throws InputError, naming `file`, for bytes that are no such answer; the
/// second also where the values never change sign.
std::vector<GridSummary> grids_from_answer(std::span<const std::byte> bytes, const std::filesystem::path& file);
std::shared_ptr<LevelSetData> level_set_from_answer(std::span<const std::byte> bytes, const std::filesystem::path& file);
ReadLevelSets level_sets_from_answer(std::span<const std::byte> bytes, const std::filesystem::path& file);

/// All level sets of a file by one process.
ReadLevelSets read_all_level_sets(const std::filesystem::path& file);

/// The tree as it was, from checked parts. Throws what OpenVDB throws.
std::shared_ptr<LevelSetData> rebuild(std::span<const LevelSetBlock> blocks, std::span<const VdbTile> tiles, float background,
                                      const Affine& world_from_index, const std::string& name);

}  // namespace limn
