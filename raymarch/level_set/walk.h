#pragma once
// Internal: one ray at a time through the tree of a grid, in double precision: what points asked for singly take, what offset surfaces
// take, and what packets are tested against.

#include "raymarch/surface.h"
#include "sdf/crossed_cells.h"
#include "sdf/level_set_data.h"

namespace limn {

struct SurfaceBound;  // raymarch/level_set/bricks.h

/// Cells of a leaf by where another level than the grid's own lies. Bit z of [x][y].
struct LevelCells {
  CrossedCells crossed{};
  std::uint8_t inside[8][8] = {};  ///< Of a cell's first node.
};

/// Which leaves the surface crosses, and where: what lies beside it is walked over without a look at its values.
struct CrossedLeaves {
  const nanovdb::FloatGrid::TreeType::LeafNodeType* first_leaf = nullptr;
  std::vector<std::int32_t> brick_of_leaf{};  ///< In the tree's order; -1: the surface does not cross it.
  std::span<const SurfaceBound> bounds{};     ///< Of bricks.
  std::vector<LevelCells> cells{};            ///< Of another level, in place of bricks; in the tree's order.
};
/// `bounds`: of all crossed bricks of the grid. What they lie in must stay.
CrossedLeaves crossed_leaves(const nanovdb::FloatGrid& grid, std::span<const SurfaceBound> bounds);

/// Where a grid lies, and which level of it is looked for.
struct WalkedGrid {
  Affine index_from_render, render_from_index;
  glm::ivec3 lower{0}, upper{0};  ///< Cells that may hold the surface: lower <= cell < upper, index coordinates.
  int max_steps = 0;
  OffsetWidth level{};  ///< Taken from every value.
  double largest_level = 0.0;
  double grid_from_render_length = 1.0;
};

/// Of a grid's other level.
CrossedLeaves leaves_of_level(const LevelSetData& data, const WalkedGrid& grid);

struct GridRoot {
  double t = 0.0;
  bool from_inside = false;  ///< The value is below zero before the root.
};

/// The first change of sign along origin + t * direction (render space), t_min <= t < t_max. `crossed` spares work and changes nothing; of
/// the level that is looked for. May be null.
HitStatus walk_grid(const WalkedGrid& grid, const nanovdb::FloatGrid::AccessorType& accessor, const CrossedLeaves* crossed,
                    const glm::dvec3& origin, const glm::dvec3& direction, double t_min, double t_max, GridRoot& root);

/// Whether the trilinear interpolant is below zero at a place, index coordinates.
bool is_inside(const nanovdb::FloatGrid::AccessorType& accessor, const glm::dvec3& place);

/// The trilinear interpolant at a place, index coordinates.
double interpolated(const nanovdb::FloatGrid::AccessorType& accessor, const glm::dvec3& place);

}  // namespace limn
