#include <chrono>

#include "raymarch/local/local_level_set.h"
#include "raymarch/local/local_mesh.h"
#include "raymarch/local/local_sources.h"
#include "raymarch/local_model.h"
#include "raymarch/surface/model_parts.h"
#include "raymarch/surface/object_mesh.h"

namespace limn {
namespace {

/// Flips along a path beyond the surface's own grow with the error. With half of the tolerance they are fewer than those of a mesh as fine
/// everywhere that keeps to the tolerance, whose error is below it in most places.
constexpr double kSteadyShare = 0.5;

LocalSettings for_model(const LocalSettings& settings, const glm::dvec3& render_origin) {
  LocalSettings result = settings;
  if (settings.steady) result.tolerance_px *= kSteadyShare;
  for (Camera& camera : result.cameras) camera = moved(camera, render_origin);
  return result;
}

/// Each triangle is a polygon of its own.
ObjectMesh object_of(const LocalTriangles& refined, const Mesh& base, NormalKind kind) {
  ObjectMesh result;
  result.normals = kind == NormalKind::flat ? NormalKind::flat : NormalKind::vertex;
  Mesh mesh = as_mesh(refined, base);
  if (kind != NormalKind::limit) mesh.corner_normals.clear();
  result.triangles = std::make_shared<const TriangleMesh>(triangulate(mesh, result.normals, !mesh.corner_normals.empty()));
  result.polygons = std::make_shared<const Polygons>(std::move(mesh), result.normals);
  return result;
}

std::vector<LimitPiece> pieces_of(const LocalTriangles& refined, const std::vector<LimitPiece>& patches) {
  std::vector<LimitPiece> pieces;
  pieces.reserve(refined.triangles.size());
  for (const LocalTriangle& triangle : refined.triangles) {
    LimitPiece piece = patches[static_cast<size_t>(triangle.patch)];
    for (size_t k = 0; k < 3; ++k) piece.corners[k] = triangle.uv[k];
    pieces.push_back(piece);
  }
  return pieces;
}

/// About the mesh's own middle, so that no float meets large coordinates.
ObjectMesh from_cage(const SceneObject& object, const MeshSource& source, Scheme scheme, const SurfaceSettings& settings,
                     const glm::dvec3& render_origin, const LocalSettings& local) {
  Mesh cage = source.mesh;
  const glm::dvec3 center = bounds(cage).center();
  for (glm::dvec3& position : cage.positions) position -= center;
  Affine render_from_cage = object.world_from_object;
  render_from_cage.translation += render_from_cage.linear * center;
  render_from_cage.translation -= render_origin;
  LocalStart start = start_from_cage(cage, scheme, render_from_cage, settings.max_bytes, source.file);
  if (start.triangles.triangles.empty()) {
    ObjectMesh result = object_mesh(object, settings, render_origin);
    result.warnings.push_back("'" + object.name + "' is as fine everywhere: some of its faces have no limit surface of their own");
    return result;
  }
  const LocalTriangles refined = refine_locally(std::move(start.triangles), start.source, local, settings.max_bytes);
  ObjectMesh result = object_of(refined, start.mesh, settings.normals.value_or(NormalKind::limit));
  CageSource smooth{std::move(cage), scheme, 0, render_from_cage, glm::determinant(render_from_cage.linear) < 0.0, source.file, {}};
  smooth.pieces = pieces_of(refined, start.patches);
  result.smooth = std::move(smooth);
  return result;
}

/// Made, or as it was made for an earlier model: then `spared_ms` is told what that took.
std::shared_ptr<const LocalStart> field_start(const Field& field, const SurfaceSettings& settings, const glm::dvec3& render_origin,
                                              bool steady, double& spared_ms) {
  KeptStart* const kept = settings.kept_start.get();
  if (kept && kept->local && kept->render_origin == render_origin && kept->steady == steady) {
    spared_ms = kept->local_ms;
    return kept->local;
  }
  const auto begin = std::chrono::steady_clock::now();
  const std::shared_ptr<const FieldCage> cage = kept_cage(field, render_origin, kept, spared_ms);
  auto start = std::make_shared<const LocalStart>(start_from_field(field, cage, settings.max_bytes, steady));
  if (kept) {
    kept->local = start;
    kept->steady = steady;
    kept->local_ms = spared_ms + std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  }
  return start;
}

ObjectMesh from_field(const SceneObject& object, const SurfaceSettings& settings, const glm::dvec3& render_origin,
                      const LocalSettings& local) {
  const Field field = translate(std::get<Field>(object.source), -render_origin);
  double spared_ms = 0.0;
  const std::shared_ptr<const LocalStart> start = field_start(field, settings, render_origin, local.steady, spared_ms);
  if (!is_oriented(start->triangles)) {
    ObjectMesh result = object_mesh(object, settings, render_origin);
    result.warnings.push_back("'" + object.name + "' is as fine everywhere: more than two faces of its coarse mesh share an edge");
    return result;
  }
  const LocalTriangles refined = refine_locally(start->triangles, start->source, local, settings.max_bytes);
  ObjectMesh result = object_of(refined, start->mesh, settings.normals.value_or(NormalKind::limit));
  result.spared_ms = spared_ms;
  result.smooth = field;
  return result;
}

std::optional<Scheme> scheme_of(const SceneObject& object, const SurfaceSettings& settings) {
  const MeshSource* source = std::get_if<MeshSource>(&object.source);
  return !source ? std::nullopt : settings.scheme ? settings.scheme : source->scheme;
}

/// `settings` without what is kept of an earlier model.
std::optional<ObjectMesh> local_mesh_of(const SceneObject& object, const SurfaceSettings& settings, const glm::dvec3& render_origin,
                                        const LocalSettings& local) {
  if (!why_not_local(object, settings).empty()) return {};
  if (const auto scheme = scheme_of(object, settings))
    return from_cage(object, std::get<MeshSource>(object.source), *scheme, settings, render_origin, local);
  return from_field(object, settings, render_origin, local);
}

}  // namespace

std::string why_not_local(const SceneObject& object, const SurfaceSettings& settings) {
  if (has_local_bricks(settings.kind)) return why_no_local_level_set(object, settings.kind);
  if (std::string reason = cannot_mesh(object); !reason.empty()) return reason;
  if (std::holds_alternative<Field>(object.source) || scheme_of(object, settings)) return {};
  return "it has one resolution only: no field and no subdivision cage";
}

std::vector<LevelSet> local_level_sets(const Scene& scene, const SurfaceSettings& settings, const LocalSettings& local,
                                       std::vector<std::string>* warnings) {
  const glm::dvec3 render_origin = render_origin_of(scene);
  return local_level_sets(scene, settings, render_origin, for_model(local, render_origin), warnings);
}

SceneModel build_local_model(const Scene& scene, const SurfaceSettings& settings, const LocalSettings& local, ObjectMeshCache* cache) {
  const glm::dvec3 render_origin = render_origin_of(scene);
  const LocalSettings in_render = for_model(local, render_origin);
  if (has_local_bricks(settings.kind)) return build_local_level_sets(scene, settings, render_origin, in_render);
  SurfaceSettings own = settings;
  own.kind = "mesh";
  own.kept_mesh = nullptr;
  // build_model takes the meshes as it takes those of an earlier model.
  ObjectMeshCache made;
  if (cache) make_places(scene, *cache);
  for (size_t i = 0; i < scene.objects.size(); ++i) {
    const SceneObject& object = scene.objects[i];
    if (cache) own.kept_start = cache->starts[i];
    const auto start = std::chrono::steady_clock::now();
    std::optional<ObjectMesh> mesh = local_mesh_of(object, own, render_origin, in_render);
    made.kept.emplace_back();
    if (!mesh) continue;
    mesh->spared_ms += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    const int level = object.level.value_or(own.level);
    made.kept.back() = std::make_shared<const KeptMesh>(KeptMesh{level, own.scheme, own.normals, render_origin, std::move(*mesh)});
  }
  return build_model(scene, own, &made);
}

}  // namespace limn
