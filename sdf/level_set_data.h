#pragma once
// Internal: what stands behind a LevelSet. Included by the .cpp files that read voxels (gradients, marcher), by no public header.

#include <nanovdb/NanoVDB.h>
#include <nanovdb/util/GridHandle.h>

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "sdf/crossed_cells.h"
#include "sdf/level_set.h"
#include "sdf/level_set_metadata.h"

namespace limn {

struct LocalVolume;  // sdf/local_grid.h

struct LevelSetData {
  nanovdb::GridHandle<nanovdb::HostBuffer> handle;
  const nanovdb::FloatGrid* grid = nullptr;  ///< Into `handle`; its own transform is not used, the two below are.
  LevelSetInfo info;
  Affine index_from_world;
  double per_voxel = 0.0;  ///< By how much values change over a voxel across the surface: its size, where they are distances.
  GridFile file{};         ///< What its file says beside; as good as nothing where it comes from none.
  std::shared_ptr<const LocalVolume> local{};  ///< Where this is the grid of the smallest voxels of several; else null.
  /// In the order of blocks_with_cells. Nothing where nobody has looked yet.
  std::optional<std::vector<CrossedBlock>> crossed{};
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

/// `count` node values along z from `first` on, leaf by leaf: what has none is one tile's, the same throughout.
template <class Accessor>
void row_values(const Accessor& accessor, const nanovdb::Coord& first, int count, double* values) {
  using Leaf = nanovdb::FloatGrid::TreeType::LeafNodeType;
  constexpr int kSide = static_cast<int>(Leaf::DIM);
  for (int k = 0; k < count;) {
    const nanovdb::Coord at(first[0], first[1], first[2] + k);
    const int end = std::min(count, k + kSide - (at[2] & (kSide - 1)));
    if (const Leaf* leaf = accessor.probeLeaf(at)) {
      const float* from = leaf->data()->mValues + Leaf::CoordToOffset(at);
      while (k < end) values[k++] = static_cast<double>(*from++);
    } else {
      const auto tile = static_cast<double>(accessor.getValue(at));
      while (k < end) values[k++] = tile;
    }
  }
}

/// The eight node values of a cell, numbered x + 2y + 4z.
template <class Accessor>
std::array<double, 8> cell_values(const Accessor& accessor, const nanovdb::Coord& node) {
  std::array<double, 8> values;
  for (int row = 0; row < 4; ++row) {
    double of_row[2];
    row_values(accessor, node.offsetBy(row & 1, row >> 1, 0), 2, of_row);
    values[static_cast<size_t>(row)] = of_row[0];
    values[static_cast<size_t>(row) + 4] = of_row[1];
  }
  return values;
}

/// Takes a finished NanoVDB grid: measures bounds, counts and the band. `nominal_half_width` in voxels, or 0 where only the grid knows.
std::shared_ptr<LevelSetData> make_level_set(nanovdb::GridHandle<nanovdb::HostBuffer> handle, const Affine& world_from_index,
                                             const std::string& name, double nominal_half_width);

/// What was found when a level set was read, for one that is made of it: its warnings, what its file says, and how much of its surface has
/// no inside.
void take_over(const LevelSet& from, LevelSetData& to);

/// level_set_from_blocks, still open to additions (sdf/openvdb_blocks.cpp).
std::shared_ptr<LevelSetData> join_blocks(std::span<const LevelSetBlock> blocks, double voxel_size, double half_width_voxels,
                                          const std::string& name, const glm::dvec3& origin);

}  // namespace limn
