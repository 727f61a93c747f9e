#include "sdf/level_set.h"

#include <array>

#include "sdf/error.h"
#include "sdf/level_set_band.h"
#include "sdf/level_set_data.h"

namespace limn {

std::shared_ptr<LevelSetData> make_level_set(nanovdb::GridHandle<nanovdb::HostBuffer> handle, const Affine& world_from_index,
                                             const std::string& name, double nominal_half_width) {
  auto data = std::make_shared<LevelSetData>();
  data->handle = std::move(handle);
  data->grid = data->handle.grid<float>();
  LIMN_CHECK(data->grid != nullptr);
  data->index_from_world = inverse(world_from_index);

  LevelSetInfo& info = data->info;
  info.name = name;
  info.world_from_index = world_from_index;
  const glm::dmat3& axes = world_from_index.linear;
  info.voxel_size = std::min({glm::length(axes[0]), glm::length(axes[1]), glm::length(axes[2])});
  BandSurvey found = survey_band(*data->grid, axes, info.voxel_size, !(nominal_half_width > 0.0));
  info.active_voxels = found.active;
  info.bytes = static_cast<std::int64_t>(data->handle.size());
  info.bounds = transform(world_from_index, found.crossings);
  info.half_width_voxels = nominal_half_width > 0.0 ? nominal_half_width : found.half_width_voxels;
  info.band = std::move(found.facts);
  data->per_voxel = found.per_voxel;
  data->crossed = std::move(found.crossed);
  return data;
}

void take_over(const LevelSet& from, LevelSetData& to) {
  const LevelSetInfo& info = from.info();
  to.info.warnings = info.warnings;
  to.info.band.near_nodes = info.band.near_nodes;
  to.info.band.unsigned_nodes = info.band.unsigned_nodes;
  to.file = from.data().file;
}

const LevelSetInfo& LevelSet::info() const { return data_->info; }

std::int64_t cells_lacking(const LevelSet& level_set, const GradientDescriptor& gradient) {
  size_t k = 0;
  for (const GradientDescriptor& other : gradients()) {
    if (other.about.name == gradient.about.name) return level_set.info().band.lacking.at(k);
    ++k;
  }
  LIMN_CHECK(false);
  return 0;
}

void level_set_values(const LevelSet& level_set, std::span<const glm::dvec3> points, std::span<double> values) {
  LIMN_CHECK(points.size() == values.size());
  const LevelSetData& data = level_set.data();
  const auto accessor = data.accessor();
  for (size_t i = 0; i < points.size(); ++i) {
    const CellPoint at = cell_point(data.index_from_world.point(points[i]));
    const std::array<double, 8> v = cell_values(accessor, at.node);
    const auto along_x = [&](size_t corner) { return v[corner] + at.local.x * (v[corner + 1] - v[corner]); };
    const double low = along_x(0) + at.local.y * (along_x(2) - along_x(0));
    const double high = along_x(4) + at.local.y * (along_x(6) - along_x(4));
    values[i] = low + at.local.z * (high - low);
  }
}

}  // namespace limn
