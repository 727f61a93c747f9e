#include "raymarch/gbuffer.h"

#include <algorithm>
#include <mutex>

#include "raymarch/gbuffer/gbuffer_tile.h"
#include "raymarch/gbuffer/gbuffer_window.h"
#include "raymarch/gbuffer/picture_rays.h"
#include "raymarch/gbuffer/trace_scene.h"
#include "raymarch/scene/threads.h"
#include "sdf/error.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

template <class T>
void size_layer(bool wanted, int width, int height, Image<T>& image) {
  if (!wanted) {
    image = {};
  } else if (image.width != width || image.height != height) {
    image = {};  // its memory goes before the other comes
    image = Image<T>::unset(width, height);
  }
}

void size_layers(const GBufferLayers& layers, const Camera& camera, GBuffer& out) {
  const int width = camera.width_px, height = camera.height_px;
  out.width = width;
  out.height = height;
  size_layer(layers.depth, width, height, out.depth);
  size_layer(layers.position, width, height, out.position);
  size_layer(layers.normal, width, height, out.normal);
  size_layer(layers.n_dot_v, width, height, out.n_dot_v);
  size_layer(layers.id, width, height, out.id);
  size_layer(layers.material, width, height, out.material);
  size_layer(layers.face, width, height, out.face);
  size_layer(layers.status, width, height, out.status);
  out.custom = {};
}

/// What the tiles of a picture share.
struct Shared {
  const SceneModel& model;
  ModelView view;
  PictureRays rays;
  TileWriter writer;
};

// Tiles that lie side by side and show nothing are written together; so many make up a task.
constexpr int kTilesInARow = 8;

void render_tiles(const Shared& shared, const PixelTile& row, int tile_px, glm::dvec2 sample) {
  PixelTile nothing{row.x, row.y, 0, row.height};
  for (int x = row.x; x < row.x + row.width; x += tile_px) {
    const PixelTile tile{x, row.y, std::min(tile_px, row.x + row.width - x), row.height};
    if (!touches(shared.view, tile)) {
      nothing.width += tile.width;
      continue;
    }
    write_nothing(shared.writer, nothing);
    nothing = {x + tile.width, row.y, 0, row.height};
    RayBatch rays;
    SceneHits found;
    fill_rays(shared.rays, tile, sample, rays);
    trace_scene(shared.model, shared.view, tile, rays, found);
    write_tile(shared.writer, tile, rays, found);
  }
  write_nothing(shared.writer, nothing);
}

void check(const ExecutionSettings& how) { LIMN_CHECK(how.tile_px >= 1 && how.tile_px <= 16 && how.threads >= kSurroundingThreads); }

}  // namespace

void render_window(const SceneModel& model, const Camera& camera, const ExecutionSettings& how, glm::dvec2 offset, const PixelTile& window,
                   GBuffer& out) {
  check(how);
  LIMN_CHECK(out.width == camera.width_px && out.height == camera.height_px);
  LIMN_CHECK(window.x >= 0 && window.y >= 0 && window.x + window.width <= out.width && window.y + window.height <= out.height);
  out.sample = offset;
  const Camera render_camera = moved(camera, model.render_origin);
  const SceneExtent extent = scene_extent(model);
  const int task_px = kTilesInARow * how.tile_px;
  const int columns = (window.width + task_px - 1) / task_px, rows = (window.height + how.tile_px - 1) / how.tile_px;
  const std::int64_t tasks = std::int64_t{columns} * rows;
  std::mutex progress_mutex;
  std::int64_t done = 0;
  out.turned.clear();
  const auto render = [&] {
    const PictureRays rays = picture_rays(render_camera, extent.radius, extent.bounded);
    const Shared shared{model, view_model(model, {render_camera, offset}), rays, tile_writer(model, rays, out)};
    for (size_t i = 0; i < shared.view.turned.size(); ++i)
      if (shared.view.turned[i]) out.turned.push_back(static_cast<std::int32_t>(i) + 1);
    parallel_for(std::int64_t{0}, tasks, [&](std::int64_t k) {
      if (how.cancelled && how.cancelled()) throw Cancelled{};
      const int x = static_cast<int>(k % columns) * task_px, y = static_cast<int>(k / columns) * how.tile_px;
      const PixelTile row{window.x + x, window.y + y, std::min(task_px, window.width - x), std::min(how.tile_px, window.height - y)};
      render_tiles(shared, row, how.tile_px, offset);
      if (!how.progress) return;
      const std::lock_guard lock(progress_mutex);
      how.progress(static_cast<double>(++done) / static_cast<double>(tasks));
    });
  };
  if (how.threads == kSurroundingThreads) {
    render();
  } else {
    ThreadArena(how.threads).execute(render);
  }
}

void render_gbuffer(const SceneModel& model, const Camera& camera, const ExecutionSettings& how, glm::dvec2 offset,
                    const GBufferLayers& layers, GBuffer& out) {
  size_layers(layers, camera, out);
  render_window(model, camera, how, offset, {0, 0, out.width, out.height}, out);
}

GBuffer render_gbuffer(const SceneModel& model, const Camera& camera, const ExecutionSettings& how, glm::dvec2 offset) {
  GBuffer out;
  render_gbuffer(model, camera, how, offset, {}, out);
  return out;
}

HitCounts count_hits(const GBuffer& gbuffer) {
  HitCounts counts;
  for (const std::uint8_t status : gbuffer.status.pixels) {
    counts.hits += status == static_cast<std::uint8_t>(HitStatus::hit);
    counts.misses += status == static_cast<std::uint8_t>(HitStatus::miss);
    counts.out_of_steps += status == static_cast<std::uint8_t>(HitStatus::out_of_steps);
  }
  return counts;
}

}  // namespace limn
