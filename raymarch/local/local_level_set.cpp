#include "raymarch/local/local_level_set.h"

#include <chrono>

#include "raymarch/level_set/level_set_marcher.h"
#include "raymarch/local/local_marcher.h"
#include "raymarch/local/mesh_beside.h"
#include "raymarch/scene/scene_extent.h"
#include "raymarch/surface/model_parts.h"
#include "raymarch/surface/object_mesh.h"
#include "raymarch/surface/offset.h"
#include "sdf/error.h"
#include "sdf/shape.h"

namespace limn {
namespace {

/// The surface of an object, and what its bricks are to be.
struct Request {
  explicit Request(SurfacePart of) : whole(std::move(of)) {}
  SurfacePart whole;
  glm::dvec3 part_origin{0.0};  ///< Render space.
  LocalBrickSettings bricks{};
  ObjectMesh mesh{};  ///< Of a mesh.
  std::vector<std::string> warnings{};
};

/// `bounds`: of the object, along whose longest side voxels are counted.
void set_bricks(const SurfaceSettings& settings, const LocalSettings& local, const Box& bounds, Request& request) {
  LocalBrickSettings& bricks = request.bricks;
  const GradientDescriptor& gradient = find_gradient(settings.gradient, {}, "gradient");
  bricks.local = local;
  for (Camera& camera : bricks.local.cameras) camera = moved(camera, request.part_origin);
  bricks.voxel_size = voxel_size_for(settings, bounds);
  bricks.half_width_voxels = half_width_for(settings, gradient);
  bricks.gradient = &gradient;
  bricks.max_bytes = settings.max_bytes;
}

Request request_of_field(const SceneObject& object, const SurfaceSettings& settings, const glm::dvec3& render_origin,
                         const LocalSettings& local) {
  const Field field = translate(std::get<Field>(object.source), -render_origin);
  Request request(field);
  set_bricks(settings, local, field.traits().bounds, request);
  return request;
}

/// Of whatever has a mesh.
Request request_of_mesh(const SceneObject& object, const SurfaceSettings& settings, const glm::dvec3& render_origin,
                        const LocalSettings& local) {
  ObjectMesh mesh = object_mesh(object, settings, render_origin);
  auto body = std::make_shared<const MeshBody>(*mesh.triangles);
  Request request(MeshPart{body});
  request.part_origin = body->origin();
  request.mesh = std::move(mesh);
  request.warnings = request.mesh.warnings;
  if (request.mesh.polygons->has_colors())
    request.warnings.emplace_back("'" + object.name + "' is drawn in the object's own color: a level set holds no colours");
  set_bricks(settings, local, bounds_of_triangles(*request.mesh.triangles), request);
  request.warnings.insert(request.warnings.end(), body->warnings().begin(), body->warnings().end());
  warn_of_thin_sheets(*body, request.bricks.voxel_size, request.warnings);
  return request;
}

/// A sheet is drawn as a shell of two of its voxels: larger ones would draw a thicker one.
bool has_inside(const Request& request) {
  const MeshPart* const mesh = std::get_if<MeshPart>(&request.whole);
  return !mesh || share_with_inside(*mesh->body, 0.5 * request.bricks.voxel_size) >= 0.5;
}

Surface build_field(const SceneObject& object, const SurfaceSettings& settings, const glm::dvec3& render_origin,
                    const LocalSettings& local) {
  const SurfaceDescriptor& descriptor = find_surface("level_set");
  if (const std::string reason = descriptor.unsupported(object); !reason.empty())
    throw InputError({{}, "surface", "level_set", "cannot model '" + object.name + "': " + reason, "mesh, for a local model of it"});
  if (!why_no_local_level_set(object, "level_set").empty()) return descriptor.build(object, settings, render_origin);
  const Request request = request_of_field(object, settings, render_origin, local);
  Surface surface = local_level_set(request.whole, request.bricks, request.part_origin);
  surface.offset = field_offset(std::get<Field>(request.whole), settings.max_steps);
  return surface;
}

Surface build_mesh(const SceneObject& object, const SurfaceSettings& settings, const glm::dvec3& render_origin,
                   const LocalSettings& local) {
  const auto start = std::chrono::steady_clock::now();
  const SurfaceDescriptor& descriptor = find_surface("mesh_level_set");
  if (const std::string reason = descriptor.unsupported(object); !reason.empty())
    throw InputError({{}, "surface", "mesh_level_set", "cannot model '" + object.name + "': " + reason, ""});
  Request request = request_of_mesh(object, settings, render_origin, local);
  if (!has_inside(request)) {
    Surface surface = descriptor.build(object, settings, render_origin);
    surface.info.warnings.push_back("'" + object.name + "' is as fine everywhere: it has no inside");
    return surface;
  }
  Surface surface = local_level_set(request.whole, request.bricks, request.part_origin);
  const std::shared_ptr<const TriangleMesh> triangles = request.mesh.triangles;
  surface.info.triangles = static_cast<std::int64_t>(triangles->triangles.size());
  surface.info.warnings = std::move(request.warnings);
  surface.offset = offset_of_mesh(
      triangles,
      {.voxel_size = request.bricks.voxel_size, .half_width_voxels = request.bricks.half_width_voxels, .max_bytes = settings.max_bytes},
      settings.max_steps);
  const double spared_ms = request.mesh.spared_ms;
  surface.curvature = curvature_of_mesh(std::move(request.mesh));
  surface.info.build_ms = spared_ms + std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return surface;
}

bool is_mesh_kind(const SurfaceSettings& settings) { return settings.kind == "mesh_level_set"; }

}  // namespace

std::string why_no_local_level_set(const SceneObject& object, const std::string& kind) {
  if (std::string reason = find_surface(kind).unsupported(object); !reason.empty()) return reason;
  if (kind == "mesh_level_set") return {};
  return std::holds_alternative<Field>(object.source) ? "" : "a volume has the voxels that its file has";
}

SceneModel build_local_level_sets(const Scene& scene, const SurfaceSettings& settings, const glm::dvec3& render_origin,
                                  const LocalSettings& local) {
  check_extent(scene);
  SceneModel model;
  model.bounds = bounds(scene);
  model.render_origin = render_origin;
  for (const SceneObject& object : scene.objects) {
    Surface surface =
        is_mesh_kind(settings) ? build_mesh(object, settings, render_origin, local) : build_field(object, settings, render_origin, local);
    surface.info.kind = settings.kind;
    append_surface(object, std::move(surface), model);
  }
  return model;
}

std::vector<LevelSet> local_level_sets(const Scene& scene, const SurfaceSettings& settings, const glm::dvec3& render_origin,
                                       const LocalSettings& local, std::vector<std::string>* warnings) {
  std::vector<LevelSet> grids;
  for (const SceneObject& object : scene.objects) {
    const std::string kind = is_mesh_kind(settings) ? settings.kind : "level_set";
    if (const std::string reason = why_no_local_level_set(object, kind); !reason.empty())
      throw InputError({{}, "local", object.name, "has no local level set: " + reason, "a scene of shapes, or surface = mesh_level_set"});
    const Request request = is_mesh_kind(settings) ? request_of_mesh(object, settings, render_origin, local)
                                                   : request_of_field(object, settings, render_origin, local);
    if (!has_inside(request))
      throw InputError({{}, "local", object.name, "has no local level set: it has no inside", "export without local"});
    if (warnings) warnings->insert(warnings->end(), request.warnings.begin(), request.warnings.end());
    for (const LevelSet& grid : local_level_set_grids(request.whole, request.bricks, object.name, request.part_origin + render_origin))
      grids.push_back(grid);
  }
  return grids;
}

}  // namespace limn
