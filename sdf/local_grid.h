#pragma once
// What a .vdb file says of the grids of a local level set, beside their voxels: one grid a voxel size, each with the bricks that it has.

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "sdf/level_set.h"
#include "sdf/level_set_metadata.h"

namespace limn {

/// Of one of the grids.
struct LocalGrid {
  std::string object{};              ///< The same in all grids of an object.
  int size = 0, sizes = 0;           ///< Its number among the object's voxel sizes, the smallest is 0.
  std::string gradient{};            ///< Whose stencils' nodes the grid holds.
  double half_width = 0.0;           ///< Of its band, in the values' unit: 32767 steps.
  Box bounds{};                      ///< Of the object.
  std::vector<glm::ivec3> bricks{};  ///< Places, in bricks of 8^3 cells; by x, y and z, each once.
};

/// As an entry of the grid's metadata.
GridMetadata local_metadata(const LocalGrid& grid);

/// Empty for a grid of any other kind. Throws InputError, naming the grid, for an entry that is not in order.
std::optional<LocalGrid> local_grid_of(const LevelSet& level_set, const std::string& file);

/// A level set of several voxel sizes, as its file has it. The level set that has it is its grid of the smallest voxels.
struct LocalVolume {
  std::vector<LevelSet> larger{};  ///< The other grids, rising.
  std::vector<LocalGrid> said{};   ///< Of all grids, the smallest voxels first.
};
/// What to say where only a level set of one voxel size will do.
inline constexpr const char* kLocalVolume = "it is a local level set, of several voxel sizes, which is drawn as it is";

/// Null for a level set of one voxel size. Valid as long as a copy of the level set is.
const LocalVolume* local_volume(const LevelSet& level_set);
/// Of a local one all its grids, the smallest voxels first; else the level set.
std::vector<LevelSet> grids_of(const LevelSet& level_set);

/// A grid as it was read, and its name as the file shows it.
struct ReadGrid {
  std::string name{};
  std::shared_ptr<LevelSetData> data{};
};
/// The grids of each local level set become one, named as its object; all others stay. Throws InputError, naming the grid, where what a
/// grid says of itself is not in order or a size is missing.
std::vector<ReadGrid> join_local_grids(std::vector<ReadGrid> grids, const std::string& file);

}  // namespace limn
