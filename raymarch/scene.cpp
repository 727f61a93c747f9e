#include "raymarch/scene.h"

#include "subdiv/orientation.h"

namespace limn {
namespace {

// Of the moved vertices, not of the moved box: a turned mesh would be framed too small.
Box bounds_of(const MeshSource& source, const Affine& world_from_object) {
  Box box;
  for (const glm::dvec3& position : source.mesh->positions) box = include(box, world_from_object.point(position));
  return box;
}

}  // namespace

MeshSource mesh_source(Mesh mesh, std::optional<Scheme> scheme, const std::string& file) {
  const bool tagged = !mesh.creases.empty() || !mesh.corners.empty();
  if (tagged && !scheme) scheme = Scheme::catmark;
  const std::int64_t turned_parts = turn_outwards(mesh);
  return {std::move(mesh), scheme, file, turned_parts};
}

Box bounds(const SceneObject& object) {
  if (const Field* field = std::get_if<Field>(&object.source)) return field->traits().bounds;
  if (const MeshSource* mesh = std::get_if<MeshSource>(&object.source)) return bounds_of(*mesh, object.world_from_object);
  return transform(object.world_from_object, std::get<LevelSetSource>(object.source).level_set.info().bounds);
}

Box bounds(const Scene& scene) {
  Box box;
  for (const SceneObject& object : scene.objects) {
    const Box own = bounds(object);
    if (own.finite()) box = merge(box, own);
  }
  return box;
}

}  // namespace limn
