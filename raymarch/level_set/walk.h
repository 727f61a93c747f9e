#pragma once
// Internal: one ray at a time through the tree of a grid, in double precision: what points asked for singly take, what offset surfaces
// take, and what packets are tested against.

#include "raymarch/surface.h"
#include "sdf/level_set_data.h"

namespace limn {

/// Where a grid lies, and which level of it is looked for.
struct WalkedGrid {
  Affine index_from_render, render_from_index;
  glm::ivec3 lower{0}, upper{0};  ///< Cells that may hold the surface: lower <= cell < upper, index coordinates.
  int max_steps = 0;
  OffsetWidth level{};  ///< Taken from every value.
  double largest_level = 0.0;
  double grid_from_render_length = 1.0;
};

struct GridRoot {
  double t = 0.0;
  bool from_inside = false;  ///< The value is below zero before the root.
};

/// The first change of sign along origin + t * direction (render space), t_min <= t < t_max.
HitStatus walk_grid(const WalkedGrid& grid, const nanovdb::FloatGrid::AccessorType& accessor, const glm::dvec3& origin,
                    const glm::dvec3& direction, double t_min, double t_max, GridRoot& root);

/// The trilinear interpolant at a place, index coordinates.
double interpolated(const nanovdb::FloatGrid::AccessorType& accessor, const glm::dvec3& place);

}  // namespace limn
