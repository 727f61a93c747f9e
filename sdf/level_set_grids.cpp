#include "sdf/level_set_grids.h"

#include <algorithm>

#include "sdf/error.h"
#include "sdf/local_grid.h"
#include "sdf/read_vdb.h"

namespace limn {
namespace {

/// Of a file that no grid is named for: its level sets, or where it has none the grids without a class that may be some.
std::vector<GridSummary> level_sets_among(const std::vector<GridSummary>& grids) {
  constexpr const char* kReadable[] = {"float", "double", "half", "Fp4", "Fp8", "Fp16", "FpN"};
  std::vector<GridSummary> found;
  for (const char* grid_class : {"level set", "unknown"}) {
    for (const GridSummary& grid : grids)
      if (grid.grid_class == grid_class && std::find(std::begin(kReadable), std::end(kReadable), grid.value_type) != std::end(kReadable) &&
          (found.empty() || found.front().grid_class == grid_class) && (grid.grid_class == "level set" || grid.active_voxels != 0))
        found.push_back(grid);
  }
  return found;
}

bool has_grid(const std::filesystem::path& file, const std::string& name) {
  const std::vector<GridSummary> grids = list_grids(file);
  return std::any_of(grids.begin(), grids.end(), [&](const GridSummary& grid) { return grid.name == name; });
}

}  // namespace

ReadLevelSets read_level_sets(const std::filesystem::path& file, std::span<const std::string> names) {
  ReadLevelSets result;
  if (names.empty() || (std::find(names.begin(), names.end(), "all") != names.end() && !has_grid(file, "all"))) {
    VdbFile read = read_vdb_file(file);
    if (!read.only) return std::move(read.several);
    const std::vector<GridSummary> level_sets = level_sets_among(read.grids);
    LevelSet only(std::move(read.only));
    if (const auto said = local_grid_of(only, file.string()); said && said->sizes > 1)
      throw InputError({file.string(), "grid", only.info().name, "the other voxel sizes of its local level set are missing",
                        "a file as limn exported it; grids = NAME draws one by itself"});
    result.grids.push_back({level_sets.empty() ? only.info().name : level_sets.front().name, std::move(only)});
    return result;
  }
  for (const std::string& name : names) result.grids.push_back({name, read_level_set(file, name)});
  return result;
}

}  // namespace limn
