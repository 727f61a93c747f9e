#pragma once
// Internal: where a mesh crosses the columns of a block's nodes along one axis, and how its winding number changes there.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "subdiv/mesh_distance.h"

namespace limn {

/// Nodes at voxel_size * (origin + (i, j, k)), 0 to 7 each; columns along `axis`, by 8 times the first of the other two coordinates, in the
/// order x, y, z, and the second.
struct BlockColumns {
  glm::ivec3 origin{0};
  double voxel_size = 0.0;
  int axis = 2;
};

class ColumnCrossings {
 public:
  /// In the columns whose bit is set in `wanted`. `triangles`: all of the mesh that come near the block.
  ColumnCrossings(const Winding& winding, std::span<const std::uint32_t> triangles, const BlockColumns& columns, std::uint64_t wanted);

  /// By how much the triangles between two nodes of a column change the winding number, from the one to the other: each by one, as often as
  /// it is there. Nothing where rounding leaves open whether or where the column meets a triangle.
  std::optional<int> change(int column, int from, int to) const;

 private:
  struct Crossing {
    int column = 0;
    double at = 0.0;      ///< Nodes from the block's first.
    double unsure = 0.0;  ///< It may be off by so much.
    int change = 0;       ///< Of the number, going along the axis.
  };
  void add(const std::array<glm::dvec3, 3>& corners, int times, std::uint64_t wanted);
  void meet(const std::array<glm::dvec3, 3>& corners, int times, int column);

  std::vector<Crossing> crossings_{};
  std::uint64_t unclear_ = 0;  ///< Columns that pass so near to an edge that they may meet either side of it.
  double rounding_ = 0.0;      ///< Places are off by less, in nodes.
};

}  // namespace limn
