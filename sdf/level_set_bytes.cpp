#include "sdf/level_set_bytes.h"

#include "sdf/level_set_data.h"

namespace limn {

LevelSetBytes bytes_of(const LevelSet& level_set) {
  const LevelSetData& data = level_set.data();
  LevelSetBytes bytes;
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row) bytes.numbers.push_back(data.index_from_world.linear[column][row]);
  for (int row = 0; row < 3; ++row) bytes.numbers.push_back(data.index_from_world.translation[row]);
  bytes.numbers.push_back(static_cast<double>(data.grid->tree().background()));
  bytes.numbers.push_back(data.per_voxel);
  const auto& tree = data.grid->tree();
  const std::uint32_t leaves = tree.nodeCount(0);
  const auto* const first = tree.getFirstNode<0>();
  for (std::uint32_t i = 0; i < leaves; ++i) {
    const auto& leaf = first[i];
    const nanovdb::Coord origin = leaf.origin();
    for (nanovdb::Coord::IndexType axis = 0; axis < 3; ++axis) bytes.origins.push_back(origin[axis]);
    bytes.values.push_back(std::as_bytes(std::span(&leaf.valueMask(), 1)));
    bytes.values.push_back(std::as_bytes(std::span(leaf.data()->mValues)));
  }
  return bytes;
}

}  // namespace limn
