#pragma once
// Internal: which blocks of 8^3 cells of a level set become bricks, and where each stands among them.

#include <array>
#include <cstdint>
#include <vector>

#include "raymarch/level_set/bricks.h"
#include "raymarch/level_set/crossed_cells.h"
#include "sdf/level_set_data.h"

namespace limn {

using NodeValues = std::array<float, kBrickNodes * kBrickNodes * kBrickNodes>;

/// The values at the 9^3 nodes of the cells from `origin` on, from up to eight leaves.
void load_nodes(const nanovdb::FloatGrid::AccessorType& accessor, const glm::ivec3& origin, NodeValues& values);

template <class Value>
CrossedCells crossed_cells_of(const Value* values) {
  return crossed_cells([values](int x, int y) { return values + brick_element(x, y, 0); });
}

/// From a block to its neighbour over a face (see BrickNeighbors).
glm::ivec3 face_step(int face);

/// A block of cells that may be crossed, and what looking at it told.
struct Candidate {
  glm::ivec3 origin{0};
  std::uint8_t faces = 0;
  bool crossed = false;
  float largest = 0.0f;  ///< |value| at the nodes of crossed cells.
};

/// Orders by x, then y, then z.
std::uint64_t key_of(const glm::ivec3& origin);

/// Every brick's place: the crossed ones in order, then those that only stencils reach.
struct BrickLayout {
  std::vector<Candidate> crossed;
  std::vector<std::uint64_t> crossed_keys;
  std::vector<glm::ivec3> reached;
  std::vector<std::uint64_t> reached_keys;

  size_t size() const { return crossed.size() + reached.size(); }
  /// A brick's number from its key_of; -1 where there is none.
  std::int32_t find(std::uint64_t key) const;
};

/// Looks at every leaf of the grid, in parallel.
BrickLayout lay_out_bricks(const LevelSetData& data);

}  // namespace limn
