#include "samples/input/scene_facts.h"

#include "sdf/level_set.h"

namespace limn {
namespace {

constexpr int kFinestLevel = 8;

}  // namespace

std::optional<Scheme> cage_scheme(const SceneObject& object, const SurfaceSettings& settings) {
  const auto* mesh = std::get_if<MeshSource>(&object.source);
  if (mesh == nullptr) return std::nullopt;
  return settings.scheme ? settings.scheme : mesh->scheme;
}

bool all_cages(const Scene& scene, const SurfaceSettings& settings) {
  return std::all_of(scene.objects.begin(), scene.objects.end(),
                     [&](const SceneObject& object) { return cage_scheme(object, settings).has_value(); });
}

bool any_cage(const Scene& scene, const SurfaceSettings& settings) {
  return std::any_of(scene.objects.begin(), scene.objects.end(),
                     [&](const SceneObject& object) { return cage_scheme(object, settings).has_value(); });
}

std::int64_t faces_at(const Scene& scene, const SurfaceSettings& settings, int level) {
  std::int64_t faces = 0;
  for (const SceneObject& object : scene.objects) {
    const std::optional<Scheme> scheme = cage_scheme(object, settings);
    if (scheme) faces += predict_refined_size(std::get<MeshSource>(object.source).mesh, *scheme, level).faces;
  }
  return faces;
}

int used_level(const Scene& scene, const SurfaceSettings& settings) {
  int level = settings.level;
  for (const SceneObject& object : scene.objects) level = std::max(level, object.level.value_or(0));
  return level;
}

int finest_level(const Scene& scene, const SurfaceSettings& settings) {
  int level = used_level(scene, settings);
  while (level < kFinestLevel && faces_at(scene, settings, level + 1) <= kAffordableFaces) ++level;
  return level;
}

bool bands_carry(const Scene& scene, const GradientDescriptor& gradient) {
  return std::all_of(scene.objects.begin(), scene.objects.end(), [&](const SceneObject& object) {
    const auto* source = std::get_if<LevelSetSource>(&object.source);
    return source == nullptr || cells_lacking(source->level_set, gradient) == 0;
  });
}

std::string best_gradient(const Scene& scene, const std::string& fallback) {
  const GradientDescriptor* best = nullptr;
  for (const GradientDescriptor& gradient : gradients()) {
    if (bands_carry(scene, gradient) && (best == nullptr || gradient.order > best->order)) best = &gradient;
  }
  return best == nullptr ? fallback : best->about.name;
}

std::string why_not(const SurfaceDescriptor& kind, const Scene& scene) {
  for (const SceneObject& object : scene.objects) {
    if (const std::string reason = kind.unsupported(object); !reason.empty()) {
      return scene.objects.size() == 1 ? reason : object.name + ": " + reason;
    }
  }
  return "";
}

}  // namespace limn
