#include "raymarch/surface/object_mesh.h"

#include <chrono>

#include "sdf/error.h"
#include "subdiv/orientation.h"
#include "subdiv/tessellate.h"

namespace limn {
namespace {

/// Triangles or polygons: what they have in common.
template <class AnyMesh>
void move_points(const Affine& render_from_mesh, AnyMesh& mesh) {
  for (glm::dvec3& position : mesh.positions) position = render_from_mesh.point(position);
  if (render_from_mesh.linear == glm::dmat3(1.0)) return;
  const glm::dmat3 normal_matrix = glm::transpose(glm::inverse(render_from_mesh.linear));
  for (glm::vec3& normal : mesh.corner_normals) {
    const glm::dvec3 moved = normal_matrix * glm::dvec3(normal);
    const double length = glm::length(moved);
    if (length > 0.0) normal = glm::vec3(moved / length);
  }
}

/// A reflection turns the winding so that faces go on showing outwards.
void move_polygons(const Affine& render_from_mesh, Mesh& mesh) {
  move_points(render_from_mesh, mesh);
  if (glm::determinant(render_from_mesh.linear) < 0.0) turn_faces(mesh);
}

void move_mesh(const Affine& render_from_mesh, TriangleMesh& mesh) {
  move_points(render_from_mesh, mesh);
  if (glm::determinant(render_from_mesh.linear) > 0.0) return;
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    std::swap(mesh.triangles[i].y, mesh.triangles[i].z);
    if (!mesh.corner_normals.empty()) std::swap(mesh.corner_normals[3 * i + 1], mesh.corner_normals[3 * i + 2]);
  }
}

int level_of(const SceneObject& object, const SurfaceSettings& settings) { return object.level.value_or(settings.level); }

ObjectMesh triangles_with(Mesh mesh, NormalKind kind) {
  ObjectMesh result;
  result.normals = kind == NormalKind::flat ? NormalKind::flat : NormalKind::vertex;
  if (kind != NormalKind::limit) mesh.corner_normals.clear();
  result.triangles = triangulate(mesh, result.normals, !mesh.corner_normals.empty());
  result.polygons = std::move(mesh);
  return result;
}

ObjectMesh from_field(const SceneObject& object, const SurfaceSettings& settings, const glm::dvec3& render_origin) {
  TessellateSettings how;
  how.level = level_of(object, settings);
  how.normals = settings.normals.value_or(NormalKind::limit);
  how.max_bytes = settings.max_bytes;
  const Field field = translate(std::get<Field>(object.source), -render_origin);
  ObjectMesh result = triangles_with(tessellate(field, how), how.normals);
  result.smooth = field;
  return result;
}

ObjectMesh from_cage(const SceneObject& object, const MeshSource& source, const SurfaceSettings& settings, Scheme scheme) {
  RefineSettings how;
  how.scheme = scheme;
  how.level = level_of(object, settings);
  how.normals = settings.normals.value_or(NormalKind::limit);
  how.max_bytes = settings.max_bytes;
  ObjectMesh result = triangles_with(refine(source.mesh, how, source.file), how.normals);
  result.smooth = CageSource{source.mesh, scheme, how.level, {}, false, source.file};
  return result;
}

/// A mesh as it is: the file's own normals unless others are asked for.
ObjectMesh from_facets(const SceneObject& object, const MeshSource& source, const SurfaceSettings& settings) {
  std::vector<std::string> warnings;
  NormalKind kind = settings.normals.value_or(source.mesh.corner_normals.empty() ? NormalKind::vertex : NormalKind::limit);
  if (settings.normals == NormalKind::limit && source.mesh.corner_normals.empty()) {
    warnings.push_back("'" + object.name + "' has no limit surface (no scheme): vertex normals instead of limit normals");
    kind = NormalKind::vertex;
  }
  ObjectMesh result = triangles_with(source.mesh, kind);
  result.warnings = std::move(warnings);
  return result;
}

ObjectMesh from_level_set(const LevelSetSource& source, const SurfaceSettings& settings) {
  PolygonSoup soup = mesh_from_level_set(source.level_set);
  Mesh mesh;
  mesh.positions = std::move(soup.positions);
  mesh.face_sizes = std::move(soup.face_sizes);
  mesh.corner_vertices = std::move(soup.corner_vertices);
  validate(mesh, source.file);
  return triangles_with(std::move(mesh), settings.normals.value_or(NormalKind::vertex));
}

/// Refinement and triangulation happen about the mesh's own middle, so that no float in them meets large coordinates.
MeshSource recentred(const MeshSource& source, const glm::dvec3& center) {
  MeshSource moved = source;
  for (glm::dvec3& position : moved.mesh.positions) position -= center;
  return moved;
}

ObjectMesh make_object_mesh(const SceneObject& object, const SurfaceSettings& settings, const glm::dvec3& render_origin) {
  if (std::holds_alternative<Field>(object.source)) return from_field(object, settings, render_origin);
  ObjectMesh result;
  Affine render_from_mesh = object.world_from_object;
  if (const MeshSource* source = std::get_if<MeshSource>(&object.source)) {
    const glm::dvec3 center = bounds(source->mesh).center();
    const MeshSource local = recentred(*source, center);
    const std::optional<Scheme> scheme = settings.scheme ? settings.scheme : source->scheme;
    result = scheme ? from_cage(object, local, settings, *scheme) : from_facets(object, local, settings);
    render_from_mesh.translation += render_from_mesh.linear * center;
  } else {
    result = from_level_set(std::get<LevelSetSource>(object.source), settings);
  }
  render_from_mesh.translation -= render_origin;
  move_mesh(render_from_mesh, result.triangles);
  move_polygons(render_from_mesh, result.polygons);
  if (CageSource* cage = std::get_if<CageSource>(&result.smooth)) {
    cage->render_from_cage = render_from_mesh;
    cage->mirrored = glm::determinant(render_from_mesh.linear) < 0.0;
  }
  return result;
}

}  // namespace

ObjectMesh object_mesh(const SceneObject& object, const SurfaceSettings& settings, const glm::dvec3& render_origin) {
  std::shared_ptr<const KeptMesh>* const kept = settings.kept_mesh;
  if (!kept) return make_object_mesh(object, settings, render_origin);
  const int level = level_of(object, settings);
  const KeptMesh* const old = kept->get();
  if (old && old->level == level && old->scheme == settings.scheme && old->normals == settings.normals &&
      old->render_origin == render_origin)
    return old->mesh;
  kept->reset();
  const auto start = std::chrono::steady_clock::now();
  KeptMesh made{level, settings.scheme, settings.normals, render_origin, make_object_mesh(object, settings, render_origin)};
  ObjectMesh result = made.mesh;
  made.mesh.spared_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  *kept = std::make_shared<const KeptMesh>(std::move(made));
  return result;
}

std::string cannot_mesh(const SceneObject& object) {
  const Field* field = std::get_if<Field>(&object.source);
  if (field && !field->traits().bounds.finite()) return "its surface is unbounded or empty, so that no mesh holds it";
  return {};
}

}  // namespace limn
