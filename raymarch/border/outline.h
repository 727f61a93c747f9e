#pragma once
// What `distance` and `jump_flood` have in common besides their transform: outlines of everything, of each object or of each material.

#include "raymarch/border/group_silhouette.h"

namespace limn {

/// The parameters of both methods.
std::vector<Parameter> outline_parameters();
/// `squares` is asked for each silhouette in turn.
Border draw_outline(const std::string& name, const BorderInput& input, const Parameters& parameters, const SilhouetteSquares& squares);

}  // namespace limn
