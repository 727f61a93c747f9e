#pragma once
// Internal: one vertex brought onto the surface, as snap_to_surface does with each.

#include <cmath>
#include <numbers>

#include "subdiv/local_field.h"

namespace limn {

/// Neighbouring normals that differ by more than this (25 degrees) at a hundredth of an edge belong to two sides of a crease.
inline const double kCreaseCosine = std::cos(25.0 * std::numbers::pi / 180.0);
/// How far from a vertex it is looked at the field, in edge lengths.
inline constexpr double kSnapReach = 1.6;

/// Around a vertex: the middles of its faces, the mean length of its edges, and which way its faces look on the whole (unit, or zero).
struct Surroundings {
  std::vector<glm::dvec3> middles{};
  double edge_length = 0.0;
  glm::dvec3 outward{0.0};
};

struct Snapped {
  glm::dvec3 position{0.0};
  bool feature = false;
  double off = 0.0;  ///< About how far the surface is from there.
};

/// A vertex to be brought onto the surface.
struct SnapTask {
  glm::dvec3 start{0.0};
  const Surroundings* around = nullptr;
};

/// From far to near: sides are sampled ever closer to the vertex while it walks onto their meeting line. On a smooth surface the normals
/// soon agree and the vertex is projected; on a crease they never do.
Snapped snap(LocalField& field, const glm::dvec3& start, const Surroundings& around);
/// Several at once take less time each, and come to the same.
std::vector<Snapped> snap(LocalField& field, std::span<const SnapTask> tasks);

}  // namespace limn
