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

/// What the tiles of passes share whose rays are traced together.
struct Shared {
  const SceneModel& model;
  ModelView view;
  const PictureRays& rays;
  std::span<const Pass> passes;
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
  std::vector<GBuffer> layers{};  ///< Of each pass, that are not kept.
  Image<float> sums{};
  std::vector<RayBatch> rays{};    ///< Of each pass.
  std::vector<SceneHits> found{};  ///< Of each pass.
};

/// Where the layers of a pass go in a task.
struct PassLayers {
  TileWriter writer;
  glm::ivec2 first{0};  ///< Pixel of the picture that they begin with.
};

std::vector<PassLayers> layers_in(const Shared& shared, const PixelTile& row, TaskMemory& own) {
  const size_t passes = shared.passes.size();
  if (own.layers.size() < passes) own.layers.resize(passes), own.rays.resize(passes), own.found.resize(passes);
  std::vector<PassLayers> layers;
  for (size_t k = 0; k < passes; ++k) {
    const Pass& pass = shared.passes[k];
    PassLayers& one = layers.emplace_back(PassLayers{tile_writer(shared.model, shared.rays, *pass.out)});
    if (pass.use.layers == nullptr) continue;
    size_layers(*pass.use.layers, row.width, row.height, own.layers[k]);
    one.writer.out = &own.layers[k];
    one.first = {row.x, row.y};
  }
  return layers;
}

void render_tile(const Shared& shared, const PixelTile& tile, std::span<const PassLayers> layers, TaskMemory& own) {
  const size_t passes = layers.size();
  for (size_t k = 0; k < passes; ++k) fill_rays(shared.rays, tile, shared.passes[k].sample, own.rays[k]);
  trace_scene(shared.model, shared.view, tile, std::span(own.rays).first(passes), std::span(own.found).first(passes));
  for (size_t k = 0; k < passes; ++k) write_tile(layers[k].writer, moved(tile, layers[k].first), own.rays[k], own.found[k]);
}

void render_tiles(const Shared& shared, const PixelTile& row, int tile_px, TaskMemory& own) {
  const std::vector<PassLayers> layers = layers_in(shared, row, own);
  PixelTile run{row.x, row.y, 0, row.height};
  bool run_is_seen = false;
  const auto finish = [&] {
    for (size_t k = 0; k < layers.size(); ++k)
      finish_run(shared.passes[k].use, layers[k].writer, {*layers[k].writer.out, layers[k].first, row, own.sums, run, run_is_seen});
  };
  for (int x = row.x; x < row.x + row.width; x += tile_px) {
    const PixelTile tile{x, row.y, std::min(tile_px, row.x + row.width - x), row.height};
    const bool seen = touches(shared.view, tile);
    if (seen != run_is_seen) {
      finish();
      run = {x, row.y, 0, row.height};
      run_is_seen = seen;
    }
    run.width += tile.width;
    if (seen) render_tile(shared, tile, layers, own);
  }
  finish();
}

void check(const ExecutionSettings& how) { LIMN_CHECK(how.tile_px >= 1 && how.tile_px <= 16 && how.threads >= kSurroundingThreads); }

std::vector<std::int32_t> turned_ids(const ModelView& view) {
  std::vector<std::int32_t> ids;
  for (size_t i = 0; i < view.turned.size(); ++i) {
    if (view.turned[i]) ids.push_back(static_cast<std::int32_t>(i) + 1);
  }
  return ids;
}

/// Of each task all passes, group by group.
void render_tasks(const std::vector<Shared>& groups, const PixelTile& window, const ExecutionSettings& how) {
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
    for (const Shared& passes : groups) render_tiles(passes, row, how.tile_px, own);
    if (!how.progress) return;
    const std::lock_guard lock(progress_mutex);
    how.progress(static_cast<double>(++done) / static_cast<double>(tasks));
  });
}

/// A request for all of the passes at once.
ViewRequest request_of(const Camera& camera, std::span<const Pass> passes) {
  glm::dvec2 least = passes[0].sample, most = least;
  for (const Pass& pass : passes) least = glm::min(least, pass.sample), most = glm::max(most, pass.sample);
  return {camera, 0.5 * (least + most), 0.5 * (most - least)};
}

std::vector<Shared> group(const SceneModel& model, const Camera& camera, const PictureRays& rays, std::span<const Pass> passes) {
  const bool together = std::all_of(model.surfaces.begin(), model.surfaces.end(), [](const Surface& s) { return s.traces_samples; });
  std::vector<Shared> groups;
  for (size_t k = 0, most = together ? kMostSamples : 1; k < passes.size(); k += most) {
    const std::span<const Pass> of = passes.subspan(k, std::min(most, passes.size() - k));
    groups.push_back({model, view_model(model, request_of(camera, of)), rays, of});
    for (const Pass& pass : of) {
      pass.out->sample = pass.sample;
      pass.out->turned = turned_ids(groups.back().view);
    }
  }
  return groups;
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
    render_tasks(group(model, render_camera, rays, passes), window, how);
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
