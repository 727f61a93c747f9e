#include "raymarch/truth/proxy_settings.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "raymarch/surface/model_parts.h"
#include "sdf/local_grid.h"

namespace limn {

const MeshSource* cage_in(const SceneObject& object) {
  const auto* mesh = std::get_if<MeshSource>(&object.source);
  return mesh != nullptr && mesh->scheme ? mesh : nullptr;
}

namespace {

/// The longest edge of a box's shadow, px: how large an object is in the picture.
double extent_px(const SceneObject& object, const Camera& camera) {
  const Box box = bounds(object);
  const double depth = std::max(project(camera, box.center()).z, 0.25 * box.radius());
  return box.longest_side() * pixels_per_unit_at(camera, depth);
}

std::string best_gradient(const LevelSetSource& source) {
  if (const LocalVolume* const local = local_volume(source.level_set)) return local->said.front().gradient;
  const GradientDescriptor* best = nullptr;
  for (const GradientDescriptor& gradient : gradients()) {
    if (cells_lacking(source.level_set, gradient) == 0 && (best == nullptr || gradient.order > best->order)) best = &gradient;
  }
  return best == nullptr ? "cell" : best->about.name;
}

void add_word(const std::string& word, TruthProxy& out) {
  if (std::find(out.words.begin(), out.words.end(), word) == out.words.end()) out.words.push_back(word);
}

}  // namespace

std::int64_t faces_at(const Scene& scene, int level) {
  std::int64_t faces = 0;
  for (const SceneObject& object : scene.objects) {
    if (const MeshSource* cage = cage_in(object)) faces += predict_refined_size(cage->mesh, *cage->scheme, level).faces;
  }
  return faces;
}

double edge_px_at(const Scene& scene, const Camera& camera, int level) {
  double longest = 0.0;
  for (const SceneObject& object : scene.objects) {
    const MeshSource* cage = cage_in(object);
    if (cage == nullptr) continue;
    const auto faces = static_cast<double>(std::max<std::int64_t>(1, predict_refined_size(cage->mesh, *cage->scheme, level).faces));
    longest = std::max(longest, extent_px(object, camera) * std::sqrt(2.0 / faces));
  }
  return longest;
}

SurfaceSettings finest_settings(const SceneObject& object, int level, TruthProxy& out) {
  SurfaceSettings settings;
  settings.kind = natural_surface(object);
  settings.level = level;
  if (const auto* volume = std::get_if<LevelSetSource>(&object.source)) {
    settings.gradient = best_gradient(*volume);
    add_word("the volume with the " + settings.gradient + " gradient", out);
  } else if (cage_in(object) != nullptr) {
    settings.normals = NormalKind::limit;
    add_word(fmt::format("the cage refined {} times onto its limit", level), out);
  } else if (std::holds_alternative<Field>(object.source)) {
    add_word("the field", out);
  } else {
    add_word("the mesh as it is, with smooth normals", out);
  }
  return settings;
}

SurfaceSettings second_settings(const SceneObject& object, int level) {
  SurfaceSettings settings;
  settings.kind = natural_surface(object);
  settings.level = std::max(level - 1, 0);
  if (const auto* volume = std::get_if<LevelSetSource>(&object.source))
    settings.gradient = best_gradient(*volume) == "cubic" ? "central" : "cell";
  else if (std::holds_alternative<MeshSource>(object.source) && cage_in(object) == nullptr)
    settings.normals = NormalKind::flat;
  return settings;
}

}  // namespace limn
