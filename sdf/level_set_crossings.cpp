#include "sdf/level_set_crossings.h"

#include <algorithm>
#include <numeric>

#include "sdf/level_set_band.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

/// The mean of where the surface meets the edges of the cell at (x, y, z) of a block, from that node.
glm::dvec3 crossing(const NodeWindow& nodes, int x, int y, int z) {
  const auto value = [&](int corner) {
    const auto at = [](int i, int bit) { return static_cast<size_t>(i) + static_cast<size_t>(bit) + 1; };
    return static_cast<double>(nodes[at(x, corner & 1)][at(y, corner >> 1 & 1)][at(z, corner >> 2)]);
  };
  glm::dvec3 sum(0.0);
  int count = 0;
  for (int corner = 0; corner < 8; ++corner)
    for (int axis = 0; axis < 3; ++axis) {
      if (corner >> axis & 1) continue;
      const double a = value(corner), b = value(corner | 1 << axis);
      if ((a < 0.0) == (b < 0.0)) continue;
      glm::dvec3 at(corner & 1, corner >> 1 & 1, corner >> 2);
      at[axis] += a / (a - b);
      sum += at;
      ++count;
    }
  return sum / static_cast<double>(std::max(count, 1));
}

size_t count_crossings(const NanoAccessor& accessor, const nanovdb::Coord& origin) {
  NodeWindow nodes;
  load_nodes(LeafWindow(accessor, origin), nodes);
  size_t count = 0;
  for_each_cell(cells_crossed(nodes), [&](int, int, int) { ++count; });
  return count;
}

}  // namespace

std::vector<glm::dvec3> crossings_in_block(const LevelSetData& data, const nanovdb::Coord& origin) {
  const LeafWindow window(data.accessor(), origin);
  NodeWindow nodes;
  load_nodes(window, nodes);
  std::vector<glm::dvec3> places;
  for_each_cell(cells_crossed(nodes), [&](int x, int y, int z) {
    places.push_back(glm::dvec3(origin[0] + x, origin[1] + y, origin[2] + z) + crossing(nodes, x, y, z));
  });
  return places;
}

std::vector<glm::dvec3> sample_crossings(const LevelSet& level_set, size_t most) {
  const LevelSetData& data = level_set.data();
  const std::vector<nanovdb::Coord> blocks = blocks_with_cells(*data.grid);
  std::vector<size_t> end(blocks.size());
  parallel_parts(blocks.size(), size_t{64}, [&](const IndexRange<size_t>& part) {
    const NanoAccessor accessor = data.accessor();
    for (size_t i = part.first; i < part.last; ++i) end[i] = count_crossings(accessor, blocks[i]);
  });
  std::partial_sum(end.begin(), end.end(), end.begin());
  const size_t all = end.empty() ? 0 : end.back(), count = std::min(most, all);
  std::vector<glm::dvec3> points;
  std::vector<glm::dvec3> of_block;
  size_t block = 0, first = 0, loaded = blocks.size();
  for (size_t k = 0; k < count; ++k) {
    const size_t wanted = k * all / count;
    while (end[block] <= wanted) first = end[block++];
    if (loaded != block) of_block = crossings_in_block(data, blocks[block]), loaded = block;
    points.push_back(data.info.world_from_index.point(of_block[wanted - first]));
  }
  return points;
}

}  // namespace limn
