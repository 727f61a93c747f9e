#include <algorithm>

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

}  // namespace limn
