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

void size_layers(const GBufferLayers& layers, int width, int height, GBuffer& out) {
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

/// What is done with pixels as soon as they are traced. Null `layers`: these are the picture's own, and kept.
struct Use {
  const PixelWork* work = nullptr;
  const GBufferLayers* layers = nullptr;
};

/// A ray of each pixel.
struct Pass {
  glm::dvec2 sample{0.5, 0.5};
  Use use{};
  GBuffer* out = nullptr;
};

/// What the tiles of a pass share.
struct Shared {
  const SceneModel& model;
  ModelView view;
  const PictureRays& rays;
  TileWriter writer;
  Use use;
  glm::dvec2 sample;
};

PixelTile moved(PixelTile pixels, const glm::ivec2& first) {
  pixels.x -= first.x;
  pixels.y -= first.y;
  return pixels;
}

/// Tiles that lie side by side and show nothing are written together, and so are those that show something used.
void finish_run(const Use& use, const TileWriter& writer, const TracedPixels& run) {
  if (run.pixels.width == 0) return;
  if (!run.seen && use.layers == nullptr) write_nothing(writer, run.pixels);
  if (use.work != nullptr) (*use.work)(run);
}

/// What one task holds.
struct TaskMemory {
  GBuffer layers{};  ///< That are not kept.
  Image<float> sums{};
};

void render_tiles(const Shared& shared, const PixelTile& row, int tile_px, TaskMemory& own) {
  TileWriter writer = shared.writer;
  glm::ivec2 first(0);
  if (shared.use.layers != nullptr) {
    size_layers(*shared.use.layers, row.width, row.height, own.layers);
    writer.out = &own.layers;
    first = {row.x, row.y};
  }
  TracedPixels run{*writer.out, first, row, own.sums, {row.x, row.y, 0, row.height}, false};
  for (int x = row.x; x < row.x + row.width; x += tile_px) {
    const PixelTile tile{x, row.y, std::min(tile_px, row.x + row.width - x), row.height};
    const bool seen = touches(shared.view, tile);
    if (seen != run.seen) {
      finish_run(shared.use, writer, run);
      run.pixels = {x, row.y, 0, row.height};
      run.seen = seen;
    }
    run.pixels.width += tile.width;
    if (!seen) continue;
    RayBatch rays;
    SceneHits found;
    fill_rays(shared.rays, tile, shared.sample, rays);
    trace_scene(shared.model, shared.view, tile, rays, found);
    write_tile(writer, moved(tile, first), rays, found);
  }
  finish_run(shared.use, writer, run);
}

void check(const ExecutionSettings& how) { LIMN_CHECK(how.tile_px >= 1 && how.tile_px <= 16 && how.threads >= kSurroundingThreads); }

std::vector<std::int32_t> turned_ids(const ModelView& view) {
  std::vector<std::int32_t> ids;
  for (size_t i = 0; i < view.turned.size(); ++i) {
    if (view.turned[i]) ids.push_back(static_cast<std::int32_t>(i) + 1);
  }
  return ids;
}

/// Of each task all passes, one after the other.
void render_tasks(const std::vector<Shared>& passes, const PixelTile& window, const ExecutionSettings& how) {
  const int task_px = kTilesInARow * how.tile_px;
  const int columns = (window.width + task_px - 1) / task_px, rows = (window.height + how.tile_px - 1) / how.tile_px;
  const std::int64_t tasks = std::int64_t{columns} * rows;
  std::mutex progress_mutex;
  std::int64_t done = 0;
  parallel_for(std::int64_t{0}, tasks, [&](std::int64_t k) {
    if (how.cancelled && how.cancelled()) throw Cancelled{};
    const int x = static_cast<int>(k % columns) * task_px, y = static_cast<int>(k / columns) * how.tile_px;
    const PixelTile row{window.x + x, window.y + y, std::min(task_px, window.width - x), std::min(how.tile_px, window.height - y)};
    TaskMemory own;
    for (const Shared& pass : passes) render_tiles(pass, row, how.tile_px, own);
    if (!how.progress) return;
    const std::lock_guard lock(progress_mutex);
    how.progress(static_cast<double>(++done) / static_cast<double>(tasks));
  });
}

void render(const SceneModel& model, const Camera& camera, const ExecutionSettings& how, const PixelTile& window,
            std::span<const Pass> passes) {
  check(how);
  LIMN_CHECK(window.x >= 0 && window.y >= 0 && window.x + window.width <= camera.width_px && window.y + window.height <= camera.height_px);
  for (const Pass& pass : passes) LIMN_CHECK(pass.out->width == camera.width_px && pass.out->height == camera.height_px);
  const Camera render_camera = moved(camera, model.render_origin);
  const SceneExtent extent = scene_extent(model);
  const auto trace = [&] {
    const PictureRays rays = picture_rays(render_camera, extent.radius, extent.bounded);
    std::vector<Shared> shared;
    for (const Pass& pass : passes) {
      shared.push_back(
          {model, view_model(model, {render_camera, pass.sample}), rays, tile_writer(model, rays, *pass.out), pass.use, pass.sample});
      pass.out->sample = pass.sample;
      pass.out->turned = turned_ids(shared.back().view);
    }
    render_tasks(shared, window, how);
  };
  if (how.threads == kSurroundingThreads) {
    trace();
  } else {
    ThreadArena(how.threads).execute(trace);
  }
}

}  // namespace

void render_window(const SceneModel& model, const Camera& camera, const ExecutionSettings& how, glm::dvec2 offset, const PixelTile& window,
                   GBuffer& out) {
  const Pass pass{offset, {}, &out};
  render(model, camera, how, window, std::span(&pass, 1));
}

void render_pixels(const SceneModel& model, const Camera& camera, const ExecutionSettings& how, std::span<const PixelRays> rays) {
  constexpr GBufferLayers none{false, false, false, false, false, false, false, false};
  std::vector<Pass> passes;
  for (const PixelRays& one : rays) {
    size_layers(one.kept ? one.layers : none, camera.width_px, camera.height_px, *one.out);
    passes.push_back({one.offset, {&one.work, one.kept ? nullptr : &one.layers}, one.out});
  }
  render(model, camera, how, {0, 0, camera.width_px, camera.height_px}, passes);
}

void render_gbuffer(const SceneModel& model, const Camera& camera, const ExecutionSettings& how, glm::dvec2 offset,
                    const GBufferLayers& layers, GBuffer& out) {
  size_layers(layers, camera.width_px, camera.height_px, out);
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
