#pragma once
// Internal: the points of a surface that lie farthest along directions.

#include <functional>
#include <span>
#include <vector>

#include "raymarch/scene.h"

namespace limn {

/// One answer for each direction; none at all where the surface has no points.
using FarthestPoints = std::function<std::vector<glm::dvec3>(std::span<const glm::dvec3> directions)>;

FarthestPoints farthest_of_mesh(const MeshSource& mesh, const Affine& world_from_object);
FarthestPoints farthest_of_level_set(const LevelSet& level_set, const Affine& world_from_object);
/// Bounded fields only.
FarthestPoints farthest_of_field(const Field& field);

}  // namespace limn
