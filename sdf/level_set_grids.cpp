#include "sdf/level_set_grids.h"

#include <algorithm>
#include <optional>

#include "sdf/error.h"

namespace limn {
namespace {

bool is_level_set(const GridSummary& grid) {
  constexpr const char* kReadable[] = {"float", "double", "half", "Fp4", "Fp8", "Fp16", "FpN"};
  return grid.grid_class == "level set" && std::find(std::begin(kReadable), std::end(kReadable), grid.value_type) != std::end(kReadable);
}

ReadLevelSets read_all(const std::filesystem::path& file, const std::vector<GridSummary>& grids) {
  ReadLevelSets result;
  std::optional<InputError> first;
  for (const GridSummary& grid : grids) {
    if (!is_level_set(grid)) continue;
    try {
      result.grids.push_back({grid.name, read_level_set(file, grid.name)});
    } catch (const InputError& error) {
      if (!first) first = error;
      result.left_out.push_back("'" + grid.name + "' is left out: " + error.fault().problem);
    }
  }
  if (result.grids.empty() && first) throw *first;
  return result;
}

}  // namespace

ReadLevelSets read_level_sets(const std::filesystem::path& file, std::span<const std::string> names) {
  const std::vector<GridSummary> grids = list_grids(file);
  const auto there = [&](const std::string& name) {
    return std::any_of(grids.begin(), grids.end(), [&](const GridSummary& grid) { return grid.name == name; });
  };
  const bool all = names.empty() || (names.size() == 1 && names.front() == "all" && !there("all"));
  if (all && std::count_if(grids.begin(), grids.end(), is_level_set) > 1) return read_all(file, grids);
  ReadLevelSets result;
  if (all) {
    LevelSet only = read_level_set(file, "");
    const auto found = std::find_if(grids.begin(), grids.end(), is_level_set);
    result.grids.push_back({found == grids.end() ? only.info().name : found->name, std::move(only)});
  }
  for (const std::string& name : names)
    if (!all) result.grids.push_back({name, read_level_set(file, name)});
  return result;
}

}  // namespace limn
