#pragma once
// Parts of few solids that limn and its peers make each in their own way and draw in the suite of lines.

#include <vector>

#include "samples/scenes/solid_parts.h"

namespace limn::bench {

/// torus, hub (a disc and a boss with six bores), the built-in scene fused_spheres, honeycomb (161 cells).
std::vector<SolidPart> line_parts();

}  // namespace limn::bench
