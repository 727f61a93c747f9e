#include <cmath>

#include "sdf/level_set_grids.h"
#include "sdf/openvdb_grid.h"
#include "sdf/volume_module.h"

namespace limn {

LevelSet volumes::moved(const LevelSet& level_set, const Affine& world_from_grid) {
  const LevelSetInfo& info = level_set.info();
  const double scale = std::cbrt(std::abs(glm::determinant(world_from_grid.linear)));
  const openvdb::FloatGrid::Ptr grid = thaw(level_set);
  // A turn leaves no value as it is in the last digit but for this.
  const bool same = std::abs(scale - 1.0) < 1e-12;
  if (!same) {
    for (auto value = grid->tree().beginValueAll(); value; ++value) value.setValue(static_cast<float>(scale * static_cast<double>(*value)));
    grid->tree().root().setBackground(static_cast<float>(scale * static_cast<double>(grid->background())), false);
  }
  const auto data = freeze(*grid, compose(world_from_grid, info.world_from_index), info.name, info.half_width_voxels);
  take_over(level_set, *data);
  if (!same) data->file.doubles.clear();
  return LevelSet(data);
}

}  // namespace limn
