#pragma once
// The list of outline methods. A new one is a file in this folder and a line in registry.cpp.

#include "raymarch/border.h"

namespace limn {

BorderMethod rim_method();
BorderMethod fresnel_method();
BorderMethod rim_width_method();
BorderMethod extrude_method();
BorderMethod edge_quads_method();
BorderMethod normal4_method();
BorderMethod roberts_method();
BorderMethod sobel_method();
BorderMethod blur_method();
BorderMethod jump_flood_method();
BorderMethod distance_method();

}  // namespace limn
