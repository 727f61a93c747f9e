#include <bit>

#include "sdf/level_set_fill.h"
#include "sdf/openvdb_grid.h"
#include "sdf/volume_module.h"

namespace limn {

std::shared_ptr<LevelSetData> volumes::with_filled_nodes(const LevelSet& level_set, const std::vector<FilledBlock>& blocks) {
  const openvdb::FloatGrid::Ptr grid = thaw(level_set);
  for (const FilledBlock& block : blocks) {
    auto* leaf = grid->tree().touchLeaf(openvdb::Coord(block.origin.x, block.origin.y, block.origin.z));
    for (openvdb::Index word = 0; word < 8; ++word) {
      const auto write = [&](std::uint64_t nodes, bool active) {
        for (; nodes != 0; nodes &= nodes - 1) {
          const auto n = static_cast<openvdb::Index>(word * 64 + static_cast<openvdb::Index>(std::countr_zero(nodes)));
          if (active)
            leaf->setValueOn(n, block.values[n]);
          else
            leaf->setValueOff(n, block.values[n]);
        }
      };
      write(block.filled[word], true);
      write(block.kept_out[word], false);
    }
  }
  const LevelSetInfo& info = level_set.info();
  return freeze(*grid, info.world_from_index, info.name, info.half_width_voxels);
}

}  // namespace limn
