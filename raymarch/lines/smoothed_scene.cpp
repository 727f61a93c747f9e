#include "raymarch/lines/smoothed_scene.h"

#include <fmt/format.h>

#include <algorithm>

#include "raymarch/truth/proxy.h"
#include "sdf/memory_text.h"
#include "sdf/parallel.h"
#include "sdf/size_error.h"
#include "subdiv/interpolating_cage.h"

namespace limn {
namespace {

const MeshSource* mesh_to_smooth(const SceneObject& object) { return is_cage(object) ? nullptr : std::get_if<MeshSource>(&object.source); }

/// A polygon of n corners makes n - 2 triangles.
std::int64_t triangles_in(const Mesh& mesh) {
  return static_cast<std::int64_t>(mesh.corner_vertices.size()) - 2 * static_cast<std::int64_t>(mesh.face_count());
}

void check_size(const Scene& scene, std::int64_t max_bytes) {
  std::int64_t triangles = 0;
  std::string file;
  for (const SceneObject& object : scene.objects) {
    const MeshSource* const mesh = mesh_to_smooth(object);
    if (mesh == nullptr) continue;
    triangles += triangles_in(mesh->mesh);
    file = mesh->file;
  }
  if (triangles * kSmoothBytes <= max_bytes) return;
  const auto most = [](std::int64_t bytes) { return memory_text(static_cast<double>(bytes)); };
  throw SizeError({file, "smooth", "true",
                   fmt::format("the smooth surface through {} triangles needs {}", triangles, most(triangles * kSmoothBytes)),
                   fmt::format("at most {} triangles ({}); the facets of finer meshes are hardly seen without it", max_bytes / kSmoothBytes,
                               most(max_bytes))});
}

}  // namespace

SmoothedScene smoothed_scene(const Scene& scene, const LineSettings& settings) {
  check_size(scene, settings.max_bytes);
  SmoothedScene smoothed{scene};
  smoothed.through.resize(scene.objects.size());
  std::vector<double> moved(scene.objects.size(), 0.0);
  parallel_each(scene.objects.size(), [&](size_t i) {
    SceneObject& object = smoothed.scene.objects[i];
    if (mesh_to_smooth(object) == nullptr) return;
    auto& mesh = std::get<MeshSource>(object.source);
    InterpolatedMesh made =
        interpolating_cage(mesh.mesh, {.crease_angle_deg = settings.crease_angle_deg, .fairing_edges = settings.fairing_edges}, mesh.file);
    mesh.mesh = std::move(made.cage);
    smoothed.through[i] = std::move(made.through);
    mesh.scheme = Scheme::loop;
    const glm::dmat3& axes = object.world_from_object.linear;
    moved[i] = made.moved * std::max({glm::length(axes[0]), glm::length(axes[1]), glm::length(axes[2])});
  });
  for (const double one : moved) smoothed.moved = std::max(smoothed.moved, one);
  return smoothed;
}

}  // namespace limn
