#pragma once
// Internal: what stands behind a LevelSet. Included by the .cpp files that read voxels (gradients, marcher), by no public header.

#include <nanovdb/NanoVDB.h>
#include <nanovdb/util/GridHandle.h>

#include <array>

#include "sdf/level_set.h"
#include "sdf/level_set_metadata.h"

namespace limn {

struct LevelSetData {
  nanovdb::GridHandle<nanovdb::HostBuffer> handle;
  const nanovdb::FloatGrid* grid = nullptr;  ///< Into `handle`; its own transform is not used, the two below are.
  LevelSetInfo info;
  Affine index_from_world;
  double per_voxel = 0.0;  ///< By how much values change over a voxel across the surface: its size, where they are distances.
  GridFile file{};         ///< What its file says beside; as good as nothing where it comes from none.
  bool completed = false;  ///< By complete_band: what its stencils miss even so is nowhere in the file.

  nanovdb::FloatGrid::AccessorType accessor() const { return grid->getAccessor(); }
  /// A gradient by index coordinates, as a gradient by world coordinates.
  glm::dvec3 world_gradient(const glm::dvec3& by_index) const { return glm::transpose(index_from_world.linear) * by_index; }
};

/// A point split into the node below it and the place in the cell, each in [0, 1]; index coordinates.
struct CellPoint {
  nanovdb::Coord node;
  glm::dvec3 local;
};
inline CellPoint cell_point(const glm::dvec3& index_point) {
  // Beyond this no grid has nodes, and the conversion to whole numbers would not be defined.
  constexpr double kFar = 1e9;
  const glm::dvec3 p = glm::clamp(index_point, glm::dvec3(-kFar), glm::dvec3(kFar));
  const glm::dvec3 base = glm::floor(p);
  return {nanovdb::Coord(static_cast<int>(base.x), static_cast<int>(base.y), static_cast<int>(base.z)), p - base};
}

/// The eight node values of a cell, numbered x + 2y + 4z.
template <class Accessor>
std::array<double, 8> cell_values(const Accessor& accessor, const nanovdb::Coord& node) {
  std::array<double, 8> values;
  for (int corner = 0; corner < 8; ++corner)
    values[static_cast<size_t>(corner)] =
        static_cast<double>(accessor.getValue(node.offsetBy(corner & 1, (corner >> 1) & 1, (corner >> 2) & 1)));
  return values;
}

/// Takes a finished NanoVDB grid: measures bounds, counts and the band. `nominal_half_width` in voxels, or 0 where only the grid knows.
std::shared_ptr<LevelSetData> make_level_set(nanovdb::GridHandle<nanovdb::HostBuffer> handle, const Affine& world_from_index,
                                             const std::string& name, double nominal_half_width);

/// level_set_from_blocks, still open to additions (sdf/openvdb_blocks.cpp).
std::shared_ptr<LevelSetData> join_blocks(std::span<const LevelSetBlock> blocks, double voxel_size, double half_width_voxels,
                                          const std::string& name, const glm::dvec3& origin);

}  // namespace limn
