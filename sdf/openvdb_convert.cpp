#include <nanovdb/util/NanoToOpenVDB.h>
#include <nanovdb/util/OpenToNanoVDB.h>

#include <mutex>

#include "sdf/nano_memory.h"
#include "sdf/openvdb_grid.h"

namespace limn {

void initialize_openvdb() {
  static std::once_flag once;
  std::call_once(once, [] { openvdb::initialize(); });
}

std::shared_ptr<LevelSetData> freeze(const openvdb::FloatGrid& grid, const Affine& world_from_index, const std::string& name,
                                     double nominal_half_width) {
  auto handle = in_nano_memory([&] {
    return nanovdb::openToNanoVDB<nanovdb::HostBuffer, openvdb::FloatTree>(grid, nanovdb::StatsMode::BBox, nanovdb::ChecksumMode::Disable,
                                                                           0);
  });
  return make_level_set(std::move(handle), world_from_index, name, nominal_half_width);
}

openvdb::FloatGrid::Ptr thaw(const LevelSet& level_set) {
  initialize_openvdb();
  // The typed overload: the one on handles would instantiate every grid type there is.
  openvdb::FloatGrid::Ptr grid = nanovdb::nanoToOpenVDB(*level_set.data().handle.grid<float>(), 0);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  grid->setName(level_set.info().name);
  return grid;
}

}  // namespace limn
