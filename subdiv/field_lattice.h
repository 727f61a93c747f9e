#pragma once
// Internal: a field at the nodes of a lattice.

#include <algorithm>
#include <array>
#include <optional>
#include <unordered_map>
#include <vector>

#include "sdf/field.h"
#include "sdf/parallel.h"

namespace limn {

/// A field's values at nodes about its bounds. Nodes in thin walls are off their places: no node of the lattice itself would be in such a
/// wall, and no sign would tell of it.
struct FieldLattice {
  /// Cells to a side of the blocks that share a shortened field.
  static constexpr int kBlock = 8;

  double step = 0.0;
  glm::dvec3 lower{0.0};
  glm::ivec3 count{0};           ///< Nodes.
  std::vector<double> values{};  ///< By node_index. Of nodes that bounds or a wall tell of, only the sign is the field's.
  /// Of each block: what of the field matters in it, also where nodes are moved; none where bounds leave no surface.
  std::vector<std::optional<Field>> parts{};
  std::unordered_map<size_t, glm::dvec3> moved{};  ///< By node_index: where those are that are off their places.

  size_t node_index(const glm::ivec3& at) const {
    return (static_cast<size_t>(at.z) * static_cast<size_t>(count.y) + static_cast<size_t>(at.y)) * static_cast<size_t>(count.x) +
           static_cast<size_t>(at.x);
  }
  /// Of the edge, or of the face across the axis, that begins at a node.
  size_t edge_index(const glm::ivec3& at, int axis) const { return 3 * node_index(at) + static_cast<size_t>(axis); }
  glm::dvec3 on_lattice(const glm::ivec3& at) const { return lower + step * glm::dvec3(at); }
  glm::dvec3 world(const glm::ivec3& at) const {
    if (moved.empty()) return on_lattice(at);
    const auto found = moved.find(node_index(at));
    return found == moved.end() ? on_lattice(at) : found->second;
  }
  bool is_moved(const glm::ivec3& at) const { return moved.contains(node_index(at)); }
  bool holds(const glm::ivec3& at) const { return glm::all(glm::lessThan(at, count)); }
  double value(const glm::ivec3& at) const { return values[node_index(at)]; }
  bool inside(const glm::ivec3& at) const { return value(at) < 0.0; }

  static glm::ivec3 along(const glm::ivec3& at, int axis) {
    glm::ivec3 end = at;
    ++end[axis];
    return end;
  }

  /// Calls `visit(number, first node, end)` for each block, in parallel.
  template <class Visit>
  void for_blocks(const Visit& visit) const {
    const glm::ivec3 blocks = (count + (kBlock - 1)) / kBlock;
    parallel_for(0, blocks.x * blocks.y * blocks.z, [&](int b) {
      const glm::ivec3 first = kBlock * glm::ivec3(b % blocks.x, b / blocks.x % blocks.y, b / (blocks.x * blocks.y));
      visit(static_cast<size_t>(b), first, glm::min(first + kBlock, count));
    });
  }

  /// Calls `visit(node, axis)` for the edges, or faces, that begin at the nodes of a block.
  template <class Visit>
  static void for_axes(const glm::ivec3& first, const glm::ivec3& end, const Visit& visit) {
    for (int z = first.z; z < end.z; ++z)
      for (int y = first.y; y < end.y; ++y)
        for (int x = first.x; x < end.x; ++x)
          for (int axis = 0; axis < 3; ++axis) visit(glm::ivec3(x, y, z), axis);
  }
};

/// `cells` cells along the longest side of the field's bounds, and some around them.
FieldLattice sample_lattice(const Field& field, int cells);

/// A wall or gap that is thinner than a cell may lie between the nodes. The node that is nearest to it is moved into it, so that the wall
/// has nodes of its own, and both its sides have their vertices in the cells beside it.
void move_nodes_into_walls(const Field& field, FieldLattice& lattice);

/// Moved nodes back where they were.
void put_back(FieldLattice& lattice, std::vector<size_t> nodes);

}  // namespace limn
