#pragma once
// Internal: where an edge of a mesh goes from one side of a field's crease to the other.

#include <optional>

#include "subdiv/local_field.h"

namespace limn {

/// Nearer to an end of an edge than this share of it there is no crossing: what lies there is the end's.
inline constexpr double kCrossingAtEnd = 0.02;

/// The point of the crease that the edge from `a` to `b` goes across, one of several the nearest to its middle; empty where the surface
/// beside the edge only turns. Farther from the edge than three of its lengths none is looked for.
std::optional<glm::dvec3> crease_crossing(LocalField& field, const glm::dvec3& a, const glm::dvec3& b);

}  // namespace limn
