#include "sdf/volume_module.h"

#include "sdf/late_module.h"
#include "sdf/level_set_grids.h"
#include "sdf/output_file.h"

namespace limn {

const VolumeModule& volume_module() {
  // Its pages, and the stacks of log4cplus's threads.
  constexpr size_t kBytes = size_t{54} << 20;
  static const VolumeModule module = load_late_module<VolumeModule>(kVolumeModuleFile, kVolumeModuleFunction, kBytes);
  return module;
}

std::shared_ptr<LevelSetData> rebuild(std::span<const LevelSetBlock> blocks, std::span<const VdbTile> tiles, float background,
                                      const Affine& world_from_index, const std::string& name) {
  return volume_module().rebuild(blocks, tiles, background, world_from_index, name);
}

LevelSet moved(const LevelSet& level_set, const Affine& world_from_grid) { return volume_module().moved(level_set, world_from_grid); }

PolygonSoup mesh_from_level_set(const LevelSet& level_set) { return volume_module().mesh_from_level_set(level_set); }

void write_level_set(const LevelSet& level_set, const std::filesystem::path& file) { write_level_sets(std::span(&level_set, 1), file); }

void write_level_sets(std::span<const LevelSet> level_sets, const std::filesystem::path& file) {
  write_whole(file, [&](const std::filesystem::path& temporary) { volume_module().write_level_sets(level_sets, temporary, file); });
}

}  // namespace limn
