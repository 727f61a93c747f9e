#include <openvdb/tools/SignedFloodFill.h>

#include <algorithm>
#include <bit>
#include <chrono>

#include "sdf/error.h"
#include "sdf/openvdb_grid.h"

namespace limn {

openvdb::FloatGrid::Ptr empty_level_set(double background) {
  initialize_openvdb();
  auto grid = openvdb::FloatGrid::create(static_cast<float>(background));
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  return grid;
}

void add_leaf(openvdb::FloatTree& tree, const LevelSetBlock& block) {
  auto* leaf = new openvdb::FloatTree::LeafNodeType(openvdb::Coord(block.origin.x, block.origin.y, block.origin.z));
  std::copy(std::begin(block.values), std::end(block.values), leaf->buffer().data());
  openvdb::FloatTree::LeafNodeType::NodeMaskType mask;
  for (openvdb::Index word = 0; word < 8; ++word) mask.getWord<openvdb::Index64>(word) = block.active[word];
  leaf->setValueMask(mask);
  tree.addLeaf(leaf);
}

std::shared_ptr<LevelSetData> join_blocks(std::span<const LevelSetBlock> blocks, double voxel_size, double half_width_voxels,
                                          const std::string& name, const glm::dvec3& origin) {
  LIMN_CHECK(voxel_size > 0.0 && half_width_voxels > 0.0);
  const auto started = std::chrono::steady_clock::now();
  const auto grid = empty_level_set(voxel_size * half_width_voxels);
  for (const LevelSetBlock& block : blocks)
    if (std::any_of(std::begin(block.active), std::end(block.active), [](std::uint64_t word) { return word != 0; }))
      add_leaf(grid->tree(), block);
  if (grid->tree().leafCount() == 0)
    throw InputError({.file = {}, .field = name, .value = {}, .problem = "holds no surface", .expected = "a band with active voxels"});
  openvdb::tools::signedFloodFill(grid->tree());
  auto data = freeze(*grid, {glm::dmat3(voxel_size), origin}, name, half_width_voxels);
  if (const std::int64_t torn = cells_lacking(LevelSet(data), find_gradient("cell")); torn > 0)
    data->info.warnings.push_back(std::to_string(torn) + " cells on the surface reach beyond the band; the surface may have gaps there");
  data->info.build_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - started).count();
  return data;
}

LevelSet level_set_from_blocks(std::span<const LevelSetBlock> blocks, double voxel_size, double half_width_voxels, const std::string& name,
                               const glm::dvec3& origin) {
  return LevelSet(join_blocks(blocks, voxel_size, half_width_voxels, name, origin));
}

}  // namespace limn
