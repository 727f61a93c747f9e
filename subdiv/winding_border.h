#pragma once
// Internal: what the border of an open mesh does to its winding number, at several points at once.

#include <span>

#include "subdiv/mesh_distance.h"

namespace limn {

struct EightPoints {
  alignas(64) double at[3][8];  ///< By axis.
};

/// Winding::gradient at each point.
void border_gradients(std::span<const Winding::BorderEdge> border, const EightPoints& points, EightPoints& gradients);

/// Winding::gradient_bound about each point; `bounds`: eight, 64-byte aligned.
void border_bounds(std::span<const Winding::BorderEdge> border, const EightPoints& centers, double radius, double* bounds);

}  // namespace limn
