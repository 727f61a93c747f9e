#include "raymarch/level_set/brick_tree.h"

#include <numeric>

namespace limn {
namespace {

void divide(const std::vector<SurfaceBound>& bounds, std::span<std::int32_t> bricks, size_t at, BrickTree& tree) {
  BrickTree::Node node;
  for (int axis = 0; axis < 3; ++axis) {
    node.lower[axis] = std::numeric_limits<std::int32_t>::max();
    node.upper[axis] = std::numeric_limits<std::int32_t>::lowest();
    for (const std::int32_t brick : bricks) {
      const SurfaceBound& bound = bounds[static_cast<size_t>(brick)];
      node.lower[axis] = std::min(node.lower[axis], bound.origin[axis] + bound.lower[axis]);
      node.upper[axis] = std::max(node.upper[axis], bound.origin[axis] + bound.upper[axis]);
    }
  }
  if (bricks.size() == 1) {
    node.brick = bricks.front();
    tree.nodes[at] = node;
    return;
  }
  int longest = 0;
  for (int axis = 1; axis < 3; ++axis)
    if (node.upper[axis] - node.lower[axis] > node.upper[longest] - node.lower[longest]) longest = axis;
  const auto middle = bricks.begin() + static_cast<std::ptrdiff_t>(bricks.size() / 2);
  std::nth_element(bricks.begin(), middle, bricks.end(), [&](std::int32_t a, std::int32_t b) {
    const std::int32_t of_a = bounds[static_cast<size_t>(a)].origin[longest], of_b = bounds[static_cast<size_t>(b)].origin[longest];
    return of_a != of_b ? of_a < of_b : a < b;
  });
  node.first = static_cast<std::uint32_t>(tree.nodes.size());
  tree.nodes[at] = node;
  tree.nodes.resize(tree.nodes.size() + 2);
  divide(bounds, bricks.first(bricks.size() / 2), node.first, tree);
  divide(bounds, bricks.subspan(bricks.size() / 2), node.first + 1, tree);
}

}  // namespace

BrickTree tree_of(const RayBricks& bricks) {
  BrickTree tree;
  if (bricks.groups.empty()) return tree;
  const std::vector<SurfaceBound>& bounds = bricks.groups.front().bounds;
  std::vector<std::int32_t> order(bounds.size());
  std::iota(order.begin(), order.end(), 0);
  tree.nodes.reserve(2 * bounds.size());
  tree.nodes.resize(1);
  divide(bounds, order, 0, tree);
  return tree;
}

}  // namespace limn
