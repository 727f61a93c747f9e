#pragma once
// Internal to the sdf/openvdb_*.cpp files: the grids of a file, whatever its format, before and after their voxels are read.

#include <openvdb/openvdb.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "sdf/error.h"
#include "sdf/level_set_metadata.h"

namespace limn {

/// What a file says of one of its grids.
struct StoredGrid {
  std::string name{};   ///< Its own.
  std::string shown{};  ///< The same, with an index where several have it: ball[1].
  std::string value_type{};
  std::string grid_class{};  ///< In OpenVDB's words: "level set".
  std::string warped{};      ///< The kind of its transform where that is not linear.
  std::int64_t voxels = 0;   ///< Active ones; -1 where the file does not say.
  double voxel_size = 0.0;   ///< The smallest of the three.
  bool is_distance = false;  ///< Of a value type that distances can be read from.

  bool is_level_set() const { return grid_class == "level set" && is_distance; }
  /// Grids made by scripts often have no class; their values tell.
  bool may_be_level_set() const { return grid_class == "unknown" && is_distance && voxels != 0; }
};

struct StoredGrids {
  std::vector<StoredGrid> list{};
  std::vector<GridMetadata> metadata{};  ///< Of the file itself.
  /// Reads the voxels of one: a grid of float or double with its name, class, transform and metadata.
  std::function<openvdb::GridBase::Ptr(size_t)> read{};
};

/// Both throw InputError without the name of the file, std::ios::failure where it breaks off, and whatever OpenVDB throws.
StoredGrids stored_in_vdb(const std::filesystem::path& file);
StoredGrids stored_in_nvdb(const std::filesystem::path& file);
/// Tells by its first bytes, not by its name.
bool is_nvdb(const std::filesystem::path& file);

/// ball, ball: ball[0], ball[1], as OpenVDB numbers them; names that are there once stay as they are.
void number_equal_names(std::vector<StoredGrid>& grids);

/// An InputError of the file that is being read, whose name the caller adds.
[[noreturn]] inline void refuse_volume(const std::string& field, const std::string& value, const std::string& problem,
                                       const std::string& expected) {
  throw InputError({.file = {}, .field = field, .value = value, .problem = problem, .expected = expected});
}

}  // namespace limn
