#include "raymarch/scene.h"

#include "subdiv/face_orientation.h"
#include "subdiv/used_vertices.h"

#include "sdf/local_grid.h"
namespace limn {
namespace {

// Of the moved vertices, not of the moved box: a turned mesh would be framed too small.
Box bounds_of(const MeshSource& source, const Affine& world_from_object) {
  return box_of_used(drawn_vertices(source.mesh), [&](size_t v) { return world_from_object.point(source.mesh->positions[v]); });
}

bool has_subdivision_tags(const Mesh& mesh) {
  return !mesh.creases.empty() || !mesh.corners.empty() || !mesh.holes.empty() || mesh.boundary != BoundaryRule::edge_and_corner ||
         mesh.crease_method != CreaseMethod::uniform || mesh.triangle_rule != TriangleRule::catmark;
}

}  // namespace

MeshSource mesh_source(Mesh mesh, std::optional<Scheme> scheme, const std::string& file) {
  if (!scheme && has_subdivision_tags(mesh)) scheme = default_scheme(mesh);
  const std::int64_t turned_parts = turn_outwards(mesh);
  return {std::move(mesh), scheme, file, turned_parts};
}

Box bounds(const SceneObject& object) {
  if (const Field* field = std::get_if<Field>(&object.source)) return field->traits().bounds;
  if (const MeshSource* mesh = std::get_if<MeshSource>(&object.source)) return bounds_of(*mesh, object.world_from_object);
  const auto& volume = std::get<LevelSetSource>(object.source);
  const LocalVolume* const local = local_volume(volume.level_set);
  return transform(object.world_from_object, local ? local->said.front().bounds : volume.level_set.info().bounds);
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
