#include "raymarch/local/mesh_beside.h"

#include <mutex>
#include <optional>

#include "raymarch/surface/mesh_curvature.h"
#include "raymarch/surface/offset.h"
#include "subdiv/mesh_level_set.h"

namespace limn {
namespace {

struct CurvedMesh {
  explicit CurvedMesh(ObjectMesh of)
      : mesh(std::move(of)), curvature(*mesh.triangles, *mesh.polygons, mesh.normals, std::move(mesh.smooth)), nearest(*mesh.triangles) {}
  ObjectMesh mesh;
  MeshCurvature curvature;  ///< Refers to the mesh.
  ClosestPointQuery nearest;
};

void evaluate_nearest(const void* opaque, std::span<const SurfacePoint> points, std::span<SurfaceCurvature> curvatures) {
  const CurvedMesh& curved = *static_cast<const CurvedMesh*>(opaque);
  const std::vector<std::int32_t>& faces = curved.mesh.triangles->triangle_faces;
  std::vector<SurfacePoint> on_mesh(points.begin(), points.end());
  for (SurfacePoint& point : on_mesh) {
    const ClosestPoint closest = curved.nearest.closest(point.position);
    point.position = closest.point;
    point.face = faces.empty() ? static_cast<std::int32_t>(closest.triangle) : faces[closest.triangle];
  }
  curved.curvature.evaluate(on_mesh, curvatures);
}

/// What the offset is of, made once.
struct LateOffset {
  std::shared_ptr<const TriangleMesh> triangles;
  LevelSetSettings grid;
  int max_steps = 0;
  mutable std::mutex mutex{};
  mutable std::optional<SurfaceOffset> made{};
};

const SurfaceOffset& made_of(const LateOffset& late) {
  const std::lock_guard lock(late.mutex);
  if (late.made) return *late.made;
  const auto with_band = [triangles = late.triangles, grid = late.grid](double half_width_voxels) {
    LevelSetSettings wider = grid;
    wider.half_width_voxels = half_width_voxels;
    return level_set_from_mesh(*triangles, wider).level_set;
  };
  late.made = level_set_offset({with_band(late.grid.half_width_voxels), Affine{}, glm::dvec3(0.0), late.max_steps, {}, with_band});
  return *late.made;
}

Surface make_late(const void* opaque, const OffsetWidth& width) {
  const SurfaceOffset& offset = made_of(*static_cast<const LateOffset*>(opaque));
  return offset.make(offset.state.get(), width);
}

}  // namespace

CurvatureSource curvature_of_mesh(ObjectMesh mesh) {
  const auto curved = std::make_shared<const CurvedMesh>(std::move(mesh));
  if (!curved->curvature.available()) return {{}, nullptr, curved->curvature.from()};
  return {curved, evaluate_nearest, curved->curvature.from()};
}

SurfaceOffset offset_of_mesh(std::shared_ptr<const TriangleMesh> triangles, LevelSetSettings grid, int max_steps) {
  grid.progress = {};
  auto late = std::make_shared<LateOffset>();
  late->triangles = std::move(triangles), late->grid = std::move(grid), late->max_steps = max_steps;
  return {std::move(late), make_late};
}

}  // namespace limn
