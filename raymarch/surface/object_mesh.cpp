#include "raymarch/surface/object_mesh.h"

#include <chrono>

#include "raymarch/surface/resampled_volume.h"
#include "sdf/error.h"
#include "sdf/local_grid.h"
#include "subdiv/face_orientation.h"
#include "subdiv/polygon.h"
#include "subdiv/tessellate.h"
#include "subdiv/used_vertices.h"

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

/// A mesh of a volume has the voxels asked for; a level set made of that mesh has them itself.
bool is_resampled(const SurfaceSettings& settings) { return settings.resample_volumes && settings.kind == "mesh"; }

int level_of(const SceneObject& object, const SurfaceSettings& settings) { return object.level.value_or(settings.level); }

NormalKind traced_kind(NormalKind asked) { return asked == NormalKind::flat ? NormalKind::flat : NormalKind::vertex; }

/// Triangles of `mesh`, which become those of the object where it is placed, as do its polygons.
ObjectMesh triangles_with(Mesh mesh, NormalKind kind, const Affine& render_from_mesh) {
  ObjectMesh result;
  result.normals = traced_kind(kind);
  if (kind != NormalKind::limit) mesh.corner_normals.clear();
  TriangleMesh triangles = triangulate(mesh, result.normals, !mesh.corner_normals.empty());
  move_mesh(render_from_mesh, triangles);
  result.triangles = std::make_shared<const TriangleMesh>(std::move(triangles));
  move_polygons(render_from_mesh, mesh);
  result.polygons = std::make_shared<const Polygons>(std::move(mesh), result.normals);
  return result;
}

/// A field is tessellated in render space: there is nothing to move, to the last bit.
ObjectMesh from_field(const SceneObject& object, const SurfaceSettings& settings, const glm::dvec3& render_origin) {
  TessellateSettings how;
  how.level = level_of(object, settings);
  how.normals = settings.normals.value_or(NormalKind::limit);
  how.max_bytes = settings.max_bytes;
  const Field field = translate(std::get<Field>(object.source), -render_origin);
  ObjectMesh result;
  KeptStart* const kept = settings.kept_start.get();
  how.cage = kept_cage(field, render_origin, kept, result.spared_ms);
  if (kept) {
    how.refinements = &kept->refinements;
    for (size_t i = 0; i < kept->refinements.size() && static_cast<int>(i) < how.level; ++i)
      result.spared_ms += time_to_find_ms(*kept->refinements[i]);
  }
  Mesh mesh = tessellate(field, how);
  result.normals = traced_kind(how.normals);
  if (how.normals != NormalKind::limit) mesh.corner_normals.clear();
  result.triangles = std::make_shared<const TriangleMesh>(triangulate(mesh, result.normals, !mesh.corner_normals.empty()));
  result.polygons = std::make_shared<const Polygons>(std::move(mesh), result.normals);
  result.smooth = field;
  return result;
}

Mesh recentred(Mesh mesh, const glm::dvec3& center) {
  for (glm::dvec3& position : mesh.positions) position -= center;
  return mesh;
}

/// Where a mesh goes that was moved about its own middle.
struct MeshPlace {
  glm::dvec3 center{0.0};
  Affine render_from_mesh{};
};

ObjectMesh from_cage(const SceneObject& object, const MeshSource& source, const SurfaceSettings& settings, Scheme scheme,
                     const MeshPlace& place) {
  RefineSettings how;
  how.scheme = scheme;
  how.level = level_of(object, settings);
  how.normals = settings.normals.value_or(NormalKind::limit);
  how.max_bytes = settings.max_bytes;
  Mesh cage = recentred(source.mesh, place.center);
  ObjectMesh result = triangles_with(refine(cage, how, source.file), how.normals, place.render_from_mesh);
  result.smooth = CageSource{
      std::move(cage), scheme, how.level, place.render_from_mesh, glm::determinant(place.render_from_mesh.linear) < 0.0, source.file, {}};
  return result;
}

/// The normals at corners are most of a mesh's bytes.
Mesh without_normals(Mesh mesh) {
  std::vector<glm::vec3>().swap(mesh.corner_normals);
  return mesh;
}

/// Hard edges stay hard: by the angle that is asked for, else the file's smoothing groups, else the usual angle.
Smoothing smoothing_of(const MeshSource& source) {
  return {source.smooth_angle_deg.value_or(kSmoothAngle_deg), !source.smooth_angle_deg && !source.mesh->face_smoothing.empty()};
}

/// A mesh as it is: the file's own normals unless others are asked for.
ObjectMesh from_facets(const SceneObject& object, const MeshSource& source, const SurfaceSettings& settings, const MeshPlace& place) {
  ObjectMesh result;
  const SharedMesh shared = source.mesh->holes.empty() ? source.mesh : SharedMesh(without_holes(source.mesh));
  const bool has_own = !shared->corner_normals.empty();
  NormalKind kind = settings.normals.value_or(has_own && !source.smooth_angle_deg ? NormalKind::limit : NormalKind::vertex);
  if (settings.normals == NormalKind::limit && !has_own) {
    result.warnings.emplace_back("'" + object.name + "' has no limit surface (no scheme): vertex normals instead of limit normals");
    kind = NormalKind::vertex;
  }
  result.normals = traced_kind(kind);
  const bool own_normals = kind == NormalKind::limit;
  const Smoothing smoothing = smoothing_of(source);
  {
    const Mesh local = recentred(without_normals(shared), place.center);
    TriangleMesh triangles =
        triangulate(local, result.normals, own_normals ? std::span(shared->corner_normals) : std::span<const glm::vec3>{}, smoothing);
    move_mesh(place.render_from_mesh, triangles);
    result.triangles = std::make_shared<const TriangleMesh>(std::move(triangles));
  }
  const auto make_polygons = [shared, own_normals, place] {
    Mesh mesh = recentred(own_normals ? *shared : without_normals(shared), place.center);
    move_polygons(place.render_from_mesh, mesh);
    return mesh;
  };
  result.polygons = std::make_shared<const Polygons>(make_polygons, result.normals, smoothing, has_colors(*source.mesh));
  return result;
}

ObjectMesh from_level_set(const LevelSet& level_set, const LevelSetSource& source, const SurfaceSettings& settings,
                          const Affine& render_from_mesh) {
  PolygonSoup soup = mesh_from_level_set(level_set);
  Mesh mesh;
  mesh.positions = std::move(soup.positions);
  mesh.face_sizes = std::move(soup.face_sizes);
  mesh.corner_vertices = std::move(soup.corner_vertices);
  validate(mesh, source.file);
  return triangles_with(std::move(mesh), settings.normals.value_or(NormalKind::vertex), render_from_mesh);
}

/// Of the file's voxels, or of others.
ObjectMesh from_volume(const SceneObject& object, const SurfaceSettings& settings, const Affine& render_from_mesh) {
  const auto& source = std::get<LevelSetSource>(object.source);
  if (local_volume(source.level_set))
    throw InputError({source.file, "surface", "mesh", std::string("cannot be meshed: ") + kLocalVolume, "surface = level_set"});
  if (!is_resampled(settings)) return from_level_set(source.level_set, source, settings, render_from_mesh);
  const ResampledLevelSet made = resample_volume(object, source, settings, render_from_mesh);
  ObjectMesh result = from_level_set(made.level_set, source, settings, {});
  result.notes.push_back(object.name + ": " + resampling_words(made));
  return result;
}

// Refinement and triangulation happen about the mesh's own middle, so that no float in them meets large coordinates.
MeshPlace place_of(const SceneObject& object, const MeshSource& source, const glm::dvec3& render_origin) {
  MeshPlace place{bounds(*source.mesh).center(), object.world_from_object};
  place.render_from_mesh.translation += object.world_from_object.linear * place.center;
  place.render_from_mesh.translation -= render_origin;
  return place;
}

ObjectMesh make_object_mesh(const SceneObject& object, const SurfaceSettings& settings, const glm::dvec3& render_origin) {
  if (std::holds_alternative<Field>(object.source)) return from_field(object, settings, render_origin);
  const MeshSource* source = std::get_if<MeshSource>(&object.source);
  if (source == nullptr) {
    Affine render_from_mesh = object.world_from_object;
    render_from_mesh.translation -= render_origin;
    return from_volume(object, settings, render_from_mesh);
  }
  const MeshPlace place = place_of(object, *source, render_origin);
  const std::optional<Scheme> scheme = settings.scheme ? settings.scheme : source->scheme;
  return scheme ? from_cage(object, *source, settings, *scheme, place) : from_facets(object, *source, settings, place);
}

}  // namespace

std::shared_ptr<const MeshBody> body_of(ObjectMesh& mesh) {
  SharedBody& shared = *mesh.shared_body;
  if (shared.body) {
    mesh.spared_ms += shared.made_ms;
    return shared.body;
  }
  const auto start = std::chrono::steady_clock::now();
  shared.body = std::make_shared<const MeshBody>(*mesh.triangles);
  shared.made_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return shared.body;
}

std::shared_ptr<const FieldCage> kept_cage(const Field& field, const glm::dvec3& render_origin, KeptStart* kept, double& spared_ms) {
  if (!kept) return find_field_cage(field);
  if (!kept->cage || kept->render_origin != render_origin) {
    *kept = {.render_origin = render_origin, .cage = find_field_cage(field)};
    return kept->cage;
  }
  spared_ms += time_to_find_ms(*kept->cage);
  return kept->cage;
}

void make_places(const Scene& scene, ObjectMeshCache& cache) {
  cache.kept.resize(scene.objects.size());
  cache.starts.resize(scene.objects.size());
  for (std::shared_ptr<KeptStart>& start : cache.starts)
    if (!start) start = std::make_shared<KeptStart>();
}

SurfaceSettings keeping_mesh(SurfaceSettings settings, const Scene& scene, ObjectMeshCache* cache) {
  if (!cache || scene.objects.size() != 1) return settings;
  cache->kept.resize(1);
  settings.kept_mesh = cache->kept.data();
  return settings;
}

ObjectMesh object_mesh(const SceneObject& object, const SurfaceSettings& settings, const glm::dvec3& render_origin) {
  std::shared_ptr<const KeptMesh>* const kept = settings.kept_mesh;
  // A volume with other voxels is not what the cache knows objects by.
  const bool resampled = std::holds_alternative<LevelSetSource>(object.source) && is_resampled(settings);
  if (!kept || resampled) return make_object_mesh(object, settings, render_origin);
  const int level = level_of(object, settings);
  const KeptMesh* const old = kept->get();
  if (old && old->level == level && old->scheme == settings.scheme && old->normals == settings.normals &&
      old->render_origin == render_origin)
    return old->mesh;
  kept->reset();
  const auto start = std::chrono::steady_clock::now();
  KeptMesh made{level, settings.scheme, settings.normals, render_origin, make_object_mesh(object, settings, render_origin)};
  ObjectMesh result = made.mesh;
  made.mesh.spared_ms += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  *kept = std::make_shared<const KeptMesh>(std::move(made));
  return result;
}

std::shared_ptr<const Polygons> refined_polygons(const SceneObject& object, int level, std::int64_t max_bytes,
                                                 const glm::dvec3& render_origin) {
  const auto& source = std::get<MeshSource>(object.source);
  const MeshPlace place = place_of(object, source, render_origin);
  RefineSettings how;
  how.scheme = *source.scheme;
  how.level = level;
  how.normals = NormalKind::flat;
  how.max_bytes = max_bytes;
  Mesh mesh = refine(recentred(source.mesh, place.center), how, source.file);
  move_polygons(place.render_from_mesh, mesh);
  return std::make_shared<const Polygons>(std::move(mesh), NormalKind::flat);
}

Box bounds_of_triangles(const TriangleMesh& mesh) {
  std::vector<char> used(mesh.positions.size(), 0);
  mark_used(
      3 * mesh.triangles.size(), [&](size_t i) { return mesh.triangles[i / 3][static_cast<int>(i % 3)]; }, used);
  return box_of_used(used, [&](size_t v) { return mesh.positions[v]; });
}

std::string cannot_mesh(const SceneObject& object) {
  const Field* field = std::get_if<Field>(&object.source);
  if (field && !field->traits().bounds.finite()) return "its surface is unbounded or empty, so that no mesh holds it";
  if (const auto* volume = std::get_if<LevelSetSource>(&object.source); volume && local_volume(volume->level_set)) return kLocalVolume;
  return {};
}

}  // namespace limn
