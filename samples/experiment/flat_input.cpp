#include "samples/experiment/flat_input.h"

#include "raymarch/audit.h"

namespace limn {
namespace {

constexpr std::size_t kMostFaces = 100'000;  // beyond it the check would take longer than the picture

double share_of(const SceneObject& object, const SurfaceSettings& settings) {
  const auto* mesh = std::get_if<MeshSource>(&object.source);
  if (mesh != nullptr && mesh->mesh->face_count() > kMostFaces) return 0.0;
  const std::vector<std::string> surfaces = {settings.kind.empty() ? natural_surface(object) : settings.kind}, methods = {kDefaultMethod};
  for (const Finding& finding : audit(object, {.surface = settings, .thorough = true, .surfaces = surfaces, .methods = methods}))
    if (finding.check == "flat regions") return finding.value;
  return 0.0;
}

}  // namespace

double flat_share(const Scene& scene, const SurfaceSettings& settings) {
  double flat = 0.0, whole = 0.0;
  for (const SceneObject& object : scene.objects) {
    const Box box = bounds(object);
    if (!box.finite()) continue;
    const glm::dvec3 size = box.size();
    const double area = size.x * size.y + size.y * size.z + size.z * size.x;
    flat += area * share_of(object, settings);
    whole += area;
  }
  return whole > 0.0 ? flat / whole : 0.0;
}

}  // namespace limn
