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

#include "sdf/answer.h"
#include "sdf/level_set.h"
#include "sdf/level_set_grids.h"

namespace limn {

/// A constant block of the tree that lies inside the surface; those outside go without saying.
struct VdbTile {
  glm::ivec3 origin;   ///< Index coordinates.
  std::int32_t level;  ///< 1: 8 nodes to a side, 2: 128, 3: 4096.
};

/// Puts the list of a file's grids: count, then name (with its index where several have it), value type, class, active voxels (int64),
/// voxel size (double) of each. Throws InputError.
void put_vdb_list(const std::filesystem::path& file, ByteWriter& answer);

/// Puts one grid: name, linear part of world_from_index by columns and translation (12 doubles), background (float), blocks (put_room),
/// tiles, and what the file says beside (GridFile: value type, class, metadata of the grid and of the file, each as count and name, type
/// and bytes; blocks of doubles). Throws InputError, without the name of the file, for all that read_level_set refuses but a grid without
/// a surface.
void put_vdb_grid(const std::filesystem::path& file, const std::string& grid, ByteWriter& answer);

/// Puts the list, and all level sets of the file (grids without a class where there is none): whether there are several (uint8); of a
/// single one what put_vdb_grid puts, as a part; of several for each the name as shown, whether it could be read (uint8), and the same as
/// a part, or, as text, why not. Where there is none, throws InputError as put_vdb_grid does. A process a grid would take 30 ms more for
/// each. All three read .vdb and .nvdb, and tell which by a file's first bytes.
void put_vdb_all(const std::filesystem::path& file, ByteWriter& answer);

/// All level sets of a file.
struct VdbFile {
  std::vector<GridSummary> grids{};      ///< All that are in it.
  std::shared_ptr<LevelSetData> only{};  ///< Where there is one level set. Null where there are several:
  ReadLevelSets several{};
};

/// Our side of these answers, of which nothing is taken on trust. Throws InputError, naming `file`, for bytes that are no such answer; the
/// other two also where the values never change sign.
std::vector<GridSummary> grids_from_answer(std::span<const std::byte> bytes, const std::filesystem::path& file);
std::shared_ptr<LevelSetData> level_set_from_answer(std::span<const std::byte> bytes, const std::filesystem::path& file);
VdbFile vdb_file_from_answer(std::span<const std::byte> bytes, const std::filesystem::path& file);

/// By one process.
VdbFile read_vdb_file(const std::filesystem::path& file);

/// The tree as it was, from checked parts. Throws what OpenVDB throws.
std::shared_ptr<LevelSetData> rebuild(std::span<const LevelSetBlock> blocks, std::span<const VdbTile> tiles, float background,
                                      const Affine& world_from_index, const std::string& name);

}  // namespace limn
