#pragma once
// What limn asks of OpenVDB, as a table of functions. They are in a module of their own (helpers/volumes_module.cpp), loaded when the first
// volume is read, written or edited: OpenVDB's library takes 40 ms to load, twice what all else takes at the start of a call.

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sdf/level_set_data.h"
#include "sdf/level_set_fill.h"
#include "sdf/read_vdb.h"

namespace limn {

/// What these do is said where the function of that name is declared.
struct VolumeModule {
  const char* version = nullptr;  ///< Of limn: another one's module may have other functions.

  decltype(&limn::rebuild) rebuild = nullptr;
  /// The grid alone, without what the other says of itself.
  decltype(&limn::with_filled_nodes) with_filled_nodes = nullptr;
  decltype(&limn::moved) moved = nullptr;
  decltype(&limn::mesh_from_level_set) mesh_from_level_set = nullptr;
  /// To `temporary`, which will be `file`; throws InputError for what a .vdb cannot hold, MachineError where the disk fails.
  void (*write_level_sets)(std::span<const LevelSet> level_sets, const std::filesystem::path& temporary,
                           const std::filesystem::path& file) = nullptr;
};

/// What the module exports: void limn_volume_module(VolumeModule&), which fills in its functions.
inline constexpr const char* kVolumeModuleFile = "limn-volumes.so";
inline constexpr const char* kVolumeModuleFunction = "limn_volume_module";

/// Loaded once. Throws MachineError where it is not there or is another version's.
const VolumeModule& volume_module();

namespace volumes {

// The functions of the table, in sdf/openvdb_*.cpp.
std::shared_ptr<LevelSetData> rebuild(std::span<const LevelSetBlock> blocks, std::span<const VdbTile> tiles, float background,
                                      const Affine& world_from_index, const std::string& name);
std::shared_ptr<LevelSetData> with_filled_nodes(const LevelSet& level_set, const std::vector<FilledBlock>& blocks);
LevelSet moved(const LevelSet& level_set, const Affine& world_from_grid);
PolygonSoup mesh_from_level_set(const LevelSet& level_set);
void write_level_sets(std::span<const LevelSet> level_sets, const std::filesystem::path& temporary, const std::filesystem::path& file);

}  // namespace volumes

}  // namespace limn
