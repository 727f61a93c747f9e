#include "samples/experiment/flat_input.h"

#include "raymarch/audit.h"
#include "raymarch/surface/object_mesh.h"

namespace limn {
namespace {

double share_of(const SceneObject& object, const SurfaceSettings& settings) {
  const std::vector<Finding> found = audit(object, {.surface = settings, .checks = {"flat"}});
  return found.empty() ? 0.0 : found.front().value;
}

}  // namespace

double flat_share(const Scene& scene, const SurfaceSettings& settings, ObjectMeshCache* meshes) {
  const SurfaceSettings kept = keeping_mesh(settings, scene, meshes);
  double flat = 0.0, whole = 0.0;
  for (const SceneObject& object : scene.objects) {
    const Box box = bounds(object);
    if (!box.finite()) continue;
    const glm::dvec3 size = box.size();
    const double area = size.x * size.y + size.y * size.z + size.z * size.x;
    flat += area * share_of(object, kept);
    whole += area;
  }
  return whole > 0.0 ? flat / whole : 0.0;
}

}  // namespace limn
