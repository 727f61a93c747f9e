#pragma once
// Internal: what the border of an open mesh does to its winding number, at several points at once.

#include <span>

#include "subdiv/mesh_distance.h"

namespace limn {

struct EightPoints {
  alignas(64) double at[3][8];  ///< By axis.
};

struct EightPotentials {
  EightPoints gradients;
  /// Complex numbers, of any length, whose angles are 2 pi times the winding numbers.
  alignas(64) double along[8], across[8];
};

/// Winding::potential at each point.
void border_potentials(std::span<const Winding::BorderEdge> border, const EightPoints& points, EightPotentials& potentials);

/// The gradients alone.
void border_gradients(std::span<const Winding::BorderEdge> border, const EightPoints& points, EightPoints& gradients);

/// Of a point from each edge; `distances`: eight a group, 64-byte aligned.
void border_distances(std::span<const EdgeGroup> border, const glm::dvec3& point, double* distances);

/// An edge of the border as a center sees it.
struct SeenEdge {
  Winding::BorderEdge edge{};
  glm::dvec3 to_b{0.0};    ///< Unit.
  glm::dvec3 ways{0.0};    ///< To a and to b.
  glm::dvec3 normal{0.0};  ///< to_b x to_a.
  double together = 0.0;   ///< 1 + to_a . to_b.
};
SeenEdge seen_from(const glm::dvec3& center, const Winding::BorderEdge& edge);

/// By how much the winding number at each point differs from that at the center as far as these edges make it, and their part of the
/// gradient: its integral along the straight way from the center. Of all edges these parts add up to the whole.
void border_changes(std::span<const SeenEdge> edges, const EightPoints& points, EightPotentials& changes);

}  // namespace limn
