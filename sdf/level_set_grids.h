#pragma once
// Volume files with several grids.

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "sdf/level_set.h"

namespace limn {

/// A grid of a file by the name that list_grids shows: "ball", or "ball[1]" where several have that name.
struct NamedLevelSet {
  std::string name;
  LevelSet level_set;
};

struct ReadLevelSets {
  std::vector<NamedLevelSet> grids{};
  std::vector<std::string> left_out{};  ///< Grids that were not asked for by name and cannot be drawn, each with the reason.
};

/// `names` empty or {"all"}: all level sets of the file. Each grid is read as read_level_set does, and refused as it does where it was
/// named, or where nothing else is left.
ReadLevelSets read_level_sets(const std::filesystem::path& file, std::span<const std::string> names);

/// Writes grids with their names, metadata and value types (float, double, half), class "level set", zipped with active-mask compression;
/// whole or not at all. Grids of one name are told apart by their place in the file, as OpenVDB does it.
void write_level_sets(std::span<const LevelSet> level_sets, const std::filesystem::path& file);

/// The same voxels elsewhere. The transform's linear part must keep angles; distances grow with it.
LevelSet moved(const LevelSet& level_set, const Affine& world_from_grid);

}  // namespace limn
