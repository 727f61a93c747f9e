#pragma once
// Internal: the tips of cones on a limit surface, as a sharp corner of smooth edges has them: each way there has a normal of its own, and
// the normal that a patch yields at the tip itself is that of none of them.

#include <functional>

#include "raymarch/truth/limit_grid.h"

namespace limn {

/// The side of a node that has this normal.
using SideOfNode = std::function<std::uint32_t(std::uint32_t node, const glm::dvec3& normal)>;

/// Of the triangles from `first_triangle` on, all of one patch with `steps` samples along its side: at tips of cones each edge gets a side
/// of its own, so that curves cross the edges where the surface does, and end at the tip where they lead there.
void take_sides_of_tips(const PlacedLimitSurface& placed, int steps, size_t first_triangle, LimitGrid& grid, const SideOfNode& side_of);

}  // namespace limn
