#pragma once
// Internal to the sdf/openvdb_*.cpp files: between OpenVDB grids, which are edited and filed, and the NanoVDB grids that are read.

#include <openvdb/openvdb.h>

#include "sdf/level_set_data.h"

namespace limn {

/// OpenVDB's own set-up (type registry), once.
void initialize_openvdb();

/// Freezes an OpenVDB level set. The grid's own transform is ignored, `world_from_index` is the one. For the rest see make_level_set.
std::shared_ptr<LevelSetData> freeze(const openvdb::FloatGrid& grid, const Affine& world_from_index, const std::string& name,
                                     double nominal_half_width);

/// An OpenVDB copy with its transform, class and name.
openvdb::FloatGrid::Ptr thaw(const LevelSet& level_set);

/// An empty level set; `background` in world units.
openvdb::FloatGrid::Ptr empty_level_set(double background);

/// Copies the block in as a leaf.
void add_leaf(openvdb::FloatTree& tree, const LevelSetBlock& block);

}  // namespace limn
