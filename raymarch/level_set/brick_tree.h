#pragma once
// Internal: a tree of boxes around bricks, for rays that no picture's tiles list.

#include "raymarch/level_set/bricks.h"

namespace limn {

struct BrickTree {
  struct Node {
    std::int32_t lower[3] = {}, upper[3] = {};  ///< Around crossed cells, index coordinates.
    std::int32_t brick = -1;                    ///< Of a leaf.
    std::uint32_t first = 0;                    ///< Of two children, one behind the other.
  };
  static constexpr size_t kMostDepth = 64;
  std::vector<Node> nodes{};  ///< The first is the root; none where there are no bricks.

  std::int64_t bytes() const { return static_cast<std::int64_t>(nodes.size() * sizeof(Node)); }
};

/// Each box is divided at the middle one of its bricks, along its longest side.
BrickTree tree_of(const RayBricks& bricks);

}  // namespace limn
