#pragma once
// Level sets whose inside leaked out, or that never had one.

#include <string>

#include "sdf/level_set.h"

namespace limn {

/// Share of the surface that changes no sign; 0 where so little of it does not that edges and tips explain it.
double leaked_share(const BandFacts& band);

/// Empty, or how much of the surface changes no sign, why that may be, and what helps.
std::string unsigned_surface_warning(const BandFacts& band);

/// Why a grid without any change of sign holds no surface.
std::string no_surface_problem(const std::string& grid, const BandFacts& band);

/// What makes a level set with an inside of a mesh, open or closed.
std::string with_inside_remedy();

}  // namespace limn
