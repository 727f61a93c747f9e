#include "raymarch/gbuffer.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <mutex>

#include "raymarch/gbuffer_tile.h"
#include "raymarch/picture_rays.h"
#include "raymarch/threads.h"
#include "raymarch/trace_scene.h"
#include "sdf/error.h"

namespace limn {
namespace {

template <class T>
void size_layer(bool wanted, int width, int height, Image<T>& image) {
  if (!wanted) {
    image = {};
  } else if (image.width != width || image.height != height) {
    image = Image<T>(width, height);
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

void render_tile(const Shared& shared, const PixelTile& tile, glm::dvec2 sample) {
  if (!touches(shared.view, tile)) return write_nothing(shared.writer, tile);
  RayBatch rays;
  SceneHits found;
  fill_rays(shared.rays, tile, sample, rays);
  trace_scene(shared.model, shared.view, tile, rays, found);
  write_tile(shared.writer, tile, rays, found);
}

void check(const ExecutionSettings& how) { LIMN_CHECK(how.tile_px >= 1 && how.tile_px <= 16 && how.threads >= 0); }

}  // namespace

void render_gbuffer(const SceneModel& model, const Camera& camera, const ExecutionSettings& how, glm::dvec2 offset,
                    const GBufferLayers& layers, GBuffer& out) {
  check(how);
  size_layers(layers, camera, out);
  out.sample = offset;
  const Camera render_camera = moved(camera, model.render_origin);
  const SceneExtent extent = scene_extent(model);
  const int columns = (out.width + how.tile_px - 1) / how.tile_px, rows = (out.height + how.tile_px - 1) / how.tile_px;
  const std::int64_t tiles = std::int64_t{columns} * rows;
  std::mutex progress_mutex;
  std::int64_t done = 0;
  const auto render = [&] {
    const PictureRays rays = picture_rays(render_camera, extent.radius, extent.bounded);
    const Shared shared{model, view_model(model, {render_camera, offset}), rays, tile_writer(model, rays, out)};
    tbb::parallel_for(std::int64_t{0}, tiles, [&](std::int64_t k) {
      if (how.cancelled && how.cancelled()) throw Cancelled{};
      const int x = static_cast<int>(k % columns) * how.tile_px, y = static_cast<int>(k / columns) * how.tile_px;
      render_tile(shared, {x, y, std::min(how.tile_px, out.width - x), std::min(how.tile_px, out.height - y)}, offset);
      if (!how.progress) return;
      const std::lock_guard lock(progress_mutex);
      how.progress(static_cast<double>(++done) / static_cast<double>(tiles));
    });
  };
  ThreadArena(how.threads).execute(render);
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
