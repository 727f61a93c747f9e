#include <algorithm>
#include <cmath>
#include <numbers>

#include "raymarch/truth/limit_grid.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr std::uint32_t kBlockTriangles = 16;
constexpr double kBlockSlack = 1e-7;  // radians

LimitBlock block_of(const LimitGrid& grid, std::uint32_t first, std::uint32_t end) {
  LimitBlock block{first, end};
  Box box;
  const auto for_sides = [&](const auto& visit) {
    for (std::uint32_t t = first; t < end; ++t) {
      for (const LimitCorner& corner : grid.triangles[t].corners) {
        visit(corner.side);
        if (corner.side_back != corner.side) visit(corner.side_back);
      }
    }
  };
  for_sides([&](std::uint32_t side) {
    box = include(box, grid.positions[grid.node_of_side[side]]);
    block.axis += grid.normals[side];
  });
  block.center = box.center();
  block.radius = box.radius();
  const double length = glm::length(block.axis);
  block.axis = length > 0.0 ? block.axis / length : glm::dvec3(0.0);
  double least = 1.0;
  for_sides([&](std::uint32_t side) { least = std::min(least, glm::dot(block.axis, grid.normals[side])); });
  // Cosines say little of small angles.
  block.angle = length > 0.0 ? std::acos(std::max(least, -1.0)) + kBlockSlack : std::numbers::pi;
  block.sine = std::sin(block.angle);
  block.cosine = std::cos(block.angle);
  return block;
}

}  // namespace

std::vector<LimitBlock> blocks_of(const LimitGrid& grid) {
  // Stretches of the grid, each from where a patch begins.
  constexpr std::uint32_t kStretch = 1u << 16;
  const auto count = static_cast<std::uint32_t>(grid.triangles.size());
  const auto begin = [&](std::uint32_t i) {
    i = std::min(i, count);
    while (i > 0 && i < count && grid.triangles[i].patch == grid.triangles[i - 1].patch) ++i;
    return i;
  };
  std::vector<std::vector<LimitBlock>> stretches(count / kStretch + 1);
  parallel_each(stretches.size(), [&](size_t s) {
    const auto from = static_cast<std::uint32_t>(s) * kStretch;
    const std::uint32_t last = begin(from + kStretch);
    for (std::uint32_t first = begin(from); first < last;) {
      std::uint32_t end = first + 1;
      while (end < std::min(first + kBlockTriangles, last) && grid.triangles[end].patch == grid.triangles[first].patch) ++end;
      stretches[s].push_back({first, end});
      first = end;
    }
  });
  std::vector<LimitBlock> blocks;
  for (const std::vector<LimitBlock>& stretch : stretches) blocks.insert(blocks.end(), stretch.begin(), stretch.end());
  parallel_parts(blocks.size(), size_t{256}, [&](const IndexRange<size_t>& range) {
    for (size_t b = range.begin(); b < range.end(); ++b) blocks[b] = block_of(grid, blocks[b].first, blocks[b].end);
  });
  return blocks;
}

}  // namespace limn
