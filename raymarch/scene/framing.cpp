#include "raymarch/framing.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "raymarch/scene/farthest_points.h"
#include "sdf/local_grid.h"

namespace limn {
namespace {

/// Of `found` and what is there already, for each direction what lies farther.
void keep_farther(std::span<const glm::dvec3> directions, const std::vector<glm::dvec3>& found, std::vector<glm::dvec3>& farthest) {
  if (farthest.empty()) farthest = found;
  for (size_t d = 0; d < found.size(); ++d)
    if (glm::dot(found[d], directions[d]) > glm::dot(farthest[d], directions[d])) farthest[d] = found[d];
}

/// Of a local one that of all its grids.
FarthestPoints farthest_of_volume(const LevelSetSource& volume, const Affine& world_from_object) {
  if (!local_volume(volume.level_set)) return farthest_of_level_set(volume.level_set, world_from_object);
  std::vector<FarthestPoints> grids;
  for (const LevelSet& grid : grids_of(volume.level_set)) grids.push_back(farthest_of_level_set(grid, world_from_object));
  return [grids](std::span<const glm::dvec3> directions) {
    std::vector<glm::dvec3> farthest;
    for (const FarthestPoints& of_grid : grids)
      if (const std::vector<glm::dvec3> found = of_grid(directions); !found.empty()) keep_farther(directions, found, farthest);
    return farthest;
  };
}

FarthestPoints farthest_of(const SceneObject& object) {
  if (const Field* field = std::get_if<Field>(&object.source)) return farthest_of_field(*field);
  if (const MeshSource* mesh = std::get_if<MeshSource>(&object.source)) return farthest_of_mesh(*mesh, object.world_from_object);
  return farthest_of_volume(std::get<LevelSetSource>(object.source), object.world_from_object);
}

/// Rodrigues 1840.
glm::dvec3 turned(const glm::dvec3& v, const glm::dvec3& axis, double angle) {
  return std::cos(angle) * v + std::sin(angle) * glm::cross(axis, v) + (1.0 - std::cos(angle)) * glm::dot(axis, v) * axis;
}

}  // namespace

FramedSurface framed_surface(const Scene& scene) {
  FramedSurface surface;
  std::vector<FarthestPoints> objects;
  for (const SceneObject& object : scene.objects) {
    const Box own = bounds(object);
    if (!own.finite()) continue;
    surface.bounds = merge(surface.bounds, own);
    objects.push_back(farthest_of(object));
  }
  if (objects.empty()) return surface;
  surface.farthest = [objects = std::move(objects), box = surface.bounds](std::span<const glm::dvec3> directions) {
    std::vector<glm::dvec3> farthest;
    for (const FarthestPoints& object : objects) keep_farther(directions, object(directions), farthest);
    // Nothing to be seen: any place will do.
    if (farthest.empty()) farthest.assign(directions.size(), box.center());
    return farthest;
  };
  return surface;
}

FramedSurface turned_surface(FramedSurface surface, const glm::dvec3& center, const glm::dvec3& axis, int turns) {
  if (!surface.farthest) return surface;
  FramedSurface all{surface.bounds, {}};
  all.farthest = [whole = std::move(surface), center, a = glm::normalize(axis), turns](std::span<const glm::dvec3> directions) {
    std::vector<glm::dvec3> farthest;
    for (int turn = 0; turn < turns; ++turn) {
      const double angle = 2.0 * std::numbers::pi * turn / turns;
      std::vector<glm::dvec3> back;
      for (const glm::dvec3& direction : directions) back.push_back(turned(direction, a, -angle));
      std::vector<glm::dvec3> found = whole.farthest(back);
      for (glm::dvec3& point : found) point = center + turned(point - center, a, angle);
      keep_farther(directions, found, farthest);
    }
    return farthest;
  };
  return all;
}

}  // namespace limn
