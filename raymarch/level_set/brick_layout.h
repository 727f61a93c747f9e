#pragma once
// Internal: which blocks of 8^3 cells of a level set become bricks, and where each stands among them.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "raymarch/level_set/brick_rows.h"
#include "raymarch/level_set/bricks.h"
#include "sdf/crossed_cells.h"
#include "sdf/level_set_data.h"

namespace limn {

using NodeValues = std::array<float, kBrickNodes * kBrickNodes * kBrickNodes>;
using NodeSteps = std::array<std::int16_t, kBrickNodes * kBrickNodes * kBrickNodes>;

/// The values at the 9^3 nodes of the cells from `origin` on, from up to eight leaves.
void load_nodes(const nanovdb::FloatGrid::AccessorType& accessor, const glm::ivec3& origin, NodeValues& values);

template <class Value>
CrossedCells crossed_cells_of(const Value* values) {
  return crossed_cells([values](int x, int y) { return values + brick_element(x, y, 0); });
}

/// Of steps four at a time: their highest bits are gathered by one multiplication.
CrossedCells crossed_cells_of(const NodeSteps& steps);

/// Of a brick's cells those that a smaller one covers: the `part`-th along each axis, of 2^step.
inline std::uint64_t covered_by(const glm::ivec3& part, int step) {
  constexpr std::uint64_t kOctant = 0x33'0033;
  if (step == 1) return kOctant << covered_bit(4 * part.x, 4 * part.y, 4 * part.z);
  return std::uint64_t{1} << covered_bit(2 * part.x, 2 * part.y, 2 * part.z);
}

/// Without the cells that smaller bricks hold (see covered_bit).
CrossedCells without_covered(CrossedCells crossed, std::uint64_t covered);

/// A block of cells that may be crossed, and what looking at it told.
struct Candidate {
  glm::ivec3 origin{0};
  std::uint64_t covered = 0;  ///< What smaller bricks hold of it.
  std::uint32_t place = 0;    ///< Its number among the places that were asked for, where there are such.
  std::uint8_t faces = 0;
  float largest = 0.0f;  ///< |value| at the nodes of crossed cells, of a grid's.
  CrossedCells cells{};
};

/// Orders by x, then y, then z.
std::uint64_t key_of(const glm::ivec3& origin);

/// Nodes beyond a brick's face that stencils of its cells reach, where no brick has them: of one layer across x or y, of two across z,
/// whose values are read in pairs. They lie in rows as a brick's do, those across z four layers to a row.
struct BrickLayer {
  std::uint32_t brick = 0;
  int face = 0;                ///< See BrickNeighbors.
  int slot = 0;                ///< Of layers across z the first of the row's nodes that is theirs.
  std::int64_t first_row = 0;  ///< Where the row of the layer's nodes with x = y = 0 lies; those along the face's axis count from it.
  BrickRows rows{};            ///< That are read of it.

  /// Of the layer's nodes along the face's axis, from the brick's first one.
  int first_node() const { return face % 2 == 0 ? -1 : face == 5 ? kBrickNodes - 1 : kBrickNodes; }
};
inline constexpr int layer_depth(int axis) { return axis == 2 ? 2 : 1; }

/// Every brick's place in order, and where its values lie.
struct BrickLayout {
  std::vector<Candidate> crossed;
  /// The bricks over each brick's faces; -1 where there is none, or where no stencil reaches beyond the face.
  std::vector<std::array<std::int32_t, 6>> beside;
  std::vector<BrickRows> rows;             ///< That are read of each brick.
  std::vector<std::int64_t> first_row;     ///< Where each brick's row of x = y = 0 lies.
  std::vector<BrickLayer> layers;          ///< By brick, then by face.
  std::vector<std::uint32_t> first_layer;  ///< Of each brick, and the end.
  std::int64_t row_count = 0;              ///< Of all rows, and as many as a brick has before and behind them.

  BrickNeighbors neighbors_of(size_t brick) const;
};

/// Of the blocks that the surface crosses.
BrickLayout lay_out_bricks(const LevelSetData& data);

/// Nodes that are in no grid, as the steps that bricks hold (see quantised()). Copied for each thread that asks for single ones.
struct NodeReader {
  const void* state = nullptr;
  /// In the order of load_nodes. `place`: the brick's number among the places that bricks are made of.
  void (*load_brick)(const void* state, size_t place, const glm::ivec3& origin, NodeSteps& steps) = nullptr;
  /// `last` is the reader's to remember something by.
  std::int16_t (*node_steps)(const void* state, const glm::ivec3& node, const void*& last) = nullptr;
  mutable const void* last = nullptr;  ///< Of one thread.

  void load(const Candidate& brick, NodeSteps& steps) const { load_brick(state, brick.place, brick.origin, steps); }
  std::int16_t steps(const glm::ivec3& node) const { return node_steps(state, node, last); }
};

/// A block of cells, and what smaller bricks hold of it.
struct BrickPlace {
  glm::ivec3 origin{0};
  std::uint64_t covered = 0;
  const CrossedCells* crossed = nullptr;  ///< Of the other cells, where it is known already; else the nodes tell it.
};

/// Of the blocks of cells those that the surface crosses, in parallel.
BrickLayout lay_out_bricks(const NodeReader& nodes, std::span<const BrickPlace> places);
/// The bricks, without a spline and without what only their dump asks for. Null where there are more than 32-bit offsets reach.
std::shared_ptr<RayBricks> make_bricks(const NodeReader& nodes, std::span<const BrickPlace> places, float steps_per_unit);

}  // namespace limn
