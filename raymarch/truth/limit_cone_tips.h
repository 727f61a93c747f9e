#pragma once
// Internal: the tips of cones on a limit surface, as a sharp corner of smooth edges has them: each way there has a normal of its own, and
// the normal that a patch yields at the tip itself is that of none of them.

#include <functional>
#include <span>
#include <vector>

#include "raymarch/truth/limit_grid.h"

namespace limn {

/// The corners of a patch, sampled with `steps` along its side, where the ways along its two sides have different normals.
std::vector<glm::dvec2> cone_tips(const PlacedLimitSurface& placed, size_t patch, int steps);

/// The side of a corner's node that has this normal.
using SideOfCorner = std::function<std::uint32_t(const LimitCorner& corner, const glm::dvec3& normal)>;

/// Of triangles of one patch: at its tips of cones each edge gets a side of its own, so that curves cross the edges where the surface does,
/// and end at the tip where they lead there.
void take_sides_of_tips(const PlacedLimitSurface& placed, std::span<const glm::dvec2> tips, std::span<LimitTriangle> triangles,
                        const SideOfCorner& side_of);

}  // namespace limn
