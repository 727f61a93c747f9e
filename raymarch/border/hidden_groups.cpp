// Which objects others hide, and what they show without those.

#include <algorithm>
#include <map>

#include "raymarch/border/object_groups.h"
#include "raymarch/gbuffer/gbuffer_window.h"
#include "raymarch/scene/covered_pixels.h"
#include "raymarch/scene/threads.h"

namespace limn {

std::vector<HiddenGroup> hidden_groups(const BorderInput& input, GroupBy by) {
  const size_t objects = input.model.surfaces.size();
  std::vector<HiddenGroup> all;
  std::map<int, size_t> of_material;
  for (size_t k = 0; k < objects; ++k) {
    size_t group = all.size();
    if (by == GroupBy::material) group = of_material.emplace(input.model.materials[k], group).first->second;
    if (group == all.size()) all.emplace_back();
    all[group].objects.push_back(k);
  }
  const GBuffer& seen = input.gbuffer;
  const ViewRequest request{moved(input.camera, input.model.render_origin), seen.sample};
  std::erase_if(all, [&](const HiddenGroup& group) {
    for (const size_t k : group.objects) {
      const PixelTile covered = covered_pixels(input.model.surfaces[k].bounds, request);
      for (int y = covered.y; y < covered.y + covered.height; ++y) {
        for (int x = covered.x; x < covered.x + covered.width; ++x) {
          if (group.hides(seen, seen.id.index(x, y))) return false;
        }
      }
    }
    return true;
  });
  return all;
}

namespace {

PixelWindow window_of(const PixelTile& tile) { return {tile.x, tile.y, tile.x + tile.width, tile.y + tile.height}; }

PixelWindow united(const PixelWindow& a, const PixelWindow& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  return {std::min(a.x0, b.x0), std::min(a.y0, b.y0), std::max(a.x1, b.x1), std::max(a.y1, b.y1)};
}

/// Gives ids the numbers they have in the whole scene, and finds the pixels that have one.
PixelWindow rename_and_find(const HiddenGroup& group, const PixelWindow& drawn, GBuffer& seen) {
  PixelWindow found{seen.width, seen.height, 0, 0};
  for (int y = drawn.y0; y < drawn.y1; ++y) {
    for (int x = drawn.x0; x < drawn.x1; ++x) {
      std::int32_t& id = seen.id.at(x, y);
      if (id == 0) continue;
      id = static_cast<std::int32_t>(group.objects[static_cast<size_t>(id - 1)]) + 1;
      found = {std::min(found.x0, x), std::min(found.y0, y), std::max(found.x1, x + 1), std::max(found.y1, y + 1)};
    }
  }
  return found.empty() ? PixelWindow{} : found;
}

}  // namespace

void render_alone(const BorderInput& input, const HiddenGroup& group, GroupAlone& alone) {
  SceneModel model;
  model.render_origin = input.model.render_origin;
  model.bounds = input.model.bounds;
  for (const size_t k : group.objects) {
    model.surfaces.push_back(input.model.surfaces[k]);
    model.colors.push_back(input.model.colors[k]);
    model.materials.push_back(input.model.materials[k]);
  }
  Camera camera = input.camera;
  camera.width_px = input.gbuffer.width;
  camera.height_px = input.gbuffer.height;
  const ViewRequest request{moved(camera, model.render_origin), input.gbuffer.sample};
  PixelWindow covered;
  for (const Surface& surface : model.surfaces) covered = united(covered, window_of(covered_pixels(surface.bounds, request)));
  const ExecutionSettings how{.threads = kSurroundingThreads};
  if (alone.seen.id.pixels.empty()) {
    render_gbuffer(model, camera, how, request.sample, {}, alone.seen);
  } else {
    const PixelWindow drawn = united(covered, alone.window);
    render_window(model, camera, how, request.sample, {drawn.x0, drawn.y0, drawn.width(), drawn.height()}, alone.seen);
  }
  alone.window = rename_and_find(group, covered, alone.seen);
}

void lay_hidden_ink(const Image<float>& hidden, const glm::vec3& color, Border& border) {
  if (border.colors.pixels.empty()) border.colors = {border.coverage.width, border.coverage.height, border.color};
  for (size_t i = 0; i < hidden.size(); ++i) {
    const float own = border.coverage.pixels[i], more = (1.0f - own) * hidden.pixels[i];
    if (!(more > 0.0f)) continue;
    border.colors.pixels[i] = (own * border.colors.pixels[i] + more * color) / (own + more);
    border.coverage.pixels[i] = own + more;
  }
}

}  // namespace limn
