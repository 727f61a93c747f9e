#include "raymarch/picture/pixel_wise.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <iterator>
#include <utility>

#include "raymarch/border/surface_notes.h"
#include "raymarch/border/surface_tally.h"
#include "raymarch/gbuffer/file_colors.h"
#include "raymarch/gbuffer/gbuffer_window.h"
#include "raymarch/gbuffer/stream_fill.h"
#include "raymarch/picture/frame_history.h"
#include "raymarch/picture/picture_parts.h"
#include "raymarch/picture/pixel_lanes.h"
#include "raymarch/scene/threads.h"

namespace limn {
namespace {

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point start) { return std::chrono::duration<double, std::milli>(Clock::now() - start).count(); }

constexpr size_t kMostMethods = kMostTalliedMethods;
constexpr size_t kMostPixels = size_t{kTilesInARow} * 16;  // of a task's line

/// What the tasks of a sample share.
struct Sample {
  PixelStage stage{};
  std::span<const PixelInk> inks{};
  SurfaceTally* tally = nullptr;  ///< Of the first sample.
  Picture* picture = nullptr;     ///< Images without pixels are not made.
  bool to_bytes = false;          ///< The last sample of a picture in bytes.
  bool sums_in_tasks = false;     ///< Else in Picture::composite, or nowhere.
  std::atomic<std::int64_t>* work_ns = nullptr;
};

/// Sums of a task, row by row: red, green, blue and alpha of the row after each other.
constexpr int kPlanes = 4;
float* sums_at(const TracedPixels& traced, int x, int y, int plane) {
  return &traced.sums.at(x - traced.task.x, kPlanes * (y - traced.task.y) + plane);
}

/// Pixels side by side, from this one of the picture on.
PixelRun run_of(const Sample& sample, const TracedPixels& traced, int x, int y) {
  Picture& picture = *sample.picture;
  const size_t at = static_cast<size_t>(y) * static_cast<size_t>(picture.gbuffer.width) + static_cast<size_t>(x);
  PixelRun run;
  run.count = static_cast<size_t>(traced.pixels.width);
  if (!picture.border.pixels.empty()) run.border = &picture.border.pixels[at];
  if (sample.sums_in_tasks) {
    run.planes = sums_at(traced, x, y, 0);
    run.plane = static_cast<size_t>(traced.task.width);
  } else if (!picture.composite.pixels.empty()) {
    run.composite = &picture.composite.pixels[at];
  }
  if (sample.to_bytes) run.bytes = &picture.bytes.pixels[at];
  return run;
}

void draw_seen(const Sample& sample, const TracedPixels& traced) {
  const PixelTile& pixels = traced.pixels;
  const auto count = static_cast<size_t>(pixels.width);
  alignas(64) float coverage[kMostMethods][kMostPixels];
  const float* inks[kMostMethods];
  for (size_t m = 0; m < sample.inks.size(); ++m) inks[m] = coverage[m];
  for (int y = pixels.y; y < pixels.y + pixels.height; ++y) {
    const size_t from = traced.layers.id.index(pixels.x - traced.first.x, y - traced.first.y);
    const float* const n_dot_v = &traced.layers.n_dot_v.pixels[from];
    const std::int32_t* const id = &traced.layers.id.pixels[from];
    const size_t at = static_cast<size_t>(y) * static_cast<size_t>(sample.picture->gbuffer.width) + static_cast<size_t>(pixels.x);
    for (size_t m = 0; m < sample.inks.size(); ++m) {
      sample.inks[m]({n_dot_v, count}, {id, count}, {coverage[m], count});
      if (sample.tally != nullptr) add_ink({coverage[m], count}, m, at, *sample.tally);
    }
    PixelRun run = run_of(sample, traced, pixels.x, y);
    run.n_dot_v = n_dot_v;
    run.id = id;
    run.coverage = {inks, sample.inks.size()};
    compose_pixels(sample.stage, run);
  }
}

/// Where nothing is seen: no ink and no colour.
void draw_nothing(const Sample& sample, const TracedPixels& traced) {
  static constexpr float kNone[kMostPixels] = {};
  static constexpr std::int32_t kNoId[kMostPixels] = {};
  const float* const inks[kMostMethods] = {kNone, kNone, kNone, kNone, kNone};
  const PixelTile& pixels = traced.pixels;
  Picture& picture = *sample.picture;
  const auto fill_run = [&](PixelRun run) {
    run.n_dot_v = kNone;
    run.id = kNoId;
    run.coverage = {inks, sample.inks.size()};
    compose_pixels(sample.stage, run);
  };
  if (sample.stage.first) {
    float ink = 0.0f;
    glm::vec4 color(0.0f);
    glm::u8vec4 bytes(0);
    PixelRun one{.count = 1, .border = &ink, .composite = &color};
    if (sample.to_bytes) one.bytes = &bytes;
    fill_run(one);
    fill_rows(picture.border, pixels, ink);
    fill_rows(picture.composite, pixels, color);
    if (sample.to_bytes) fill_rows(picture.bytes, pixels, bytes);
    for (int y = pixels.y; sample.sums_in_tasks && y < pixels.y + pixels.height; ++y)
      for (int k = 0; k < kPlanes; ++k) std::fill_n(sums_at(traced, pixels.x, y, k), pixels.width, color[k]);
    return;
  }
  if (sample.stage.finish == nullptr) return;  // nothing is added
  for (int y = pixels.y; y < pixels.y + pixels.height; ++y) fill_run(run_of(sample, traced, pixels.x, y));
}

void draw_pixels(const Sample& sample, const TracedPixels& traced) {
  const auto start = Clock::now();
  if (sample.sums_in_tasks && traced.sums.pixels.empty())
    traced.sums = Image<float>::unset(traced.task.width, kPlanes * traced.task.height);
  if (traced.seen) {
    if (sample.tally != nullptr) add_pixels(traced.layers, traced.first, traced.pixels, *sample.tally);
    draw_seen(sample, traced);
  } else {
    if (sample.tally != nullptr) add_nothing(traced.pixels, *sample.tally);
    draw_nothing(sample, traced);
  }
  const std::int64_t took_ns = std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now() - start).count();
  sample.work_ns->fetch_add(took_ns, std::memory_order_relaxed);
}

/// Lists of what tiles see are made for each sample. Those of many triangles or objects take more than the sums that they spare: then one
/// sample comes after the other.
int samples_together(const SceneModel& model, const Camera& camera, int samples) {
  constexpr double kTriangleBytes = 24.0, kSumBytes = sizeof(glm::vec4);
  constexpr size_t kFewObjects = 64;
  double triangles = 0.0;
  for (const Surface& surface : model.surfaces) triangles += surface.polygons ? static_cast<double>(surface.info.triangles) : 0.0;
  const double lists = kTriangleBytes * triangles * std::min(samples, kSamplesTogether),
               sums = kSumBytes * camera.width_px * camera.height_px;
  return model.surfaces.size() <= kFewObjects && lists <= sums ? kSamplesTogether : 1;
}

void make_images(const PictureSettings& settings, bool is_frame, int together, const Camera& camera, Picture& picture) {
  const int width = camera.width_px, height = camera.height_px;
  const bool to_bytes = settings.colors == PictureColors::bytes;
  if (to_bytes) picture.bytes = Image<glm::u8vec4>::unset(width, height);
  if (!to_bytes || is_frame) picture.border = Image<float>::unset(width, height);
  if (settings.colors == PictureColors::linear || (to_bytes && settings.samples > together))
    picture.composite = Image<glm::vec4>::unset(width, height);
}

void add_notes(const BorderInput& input, const PictureSettings& settings, SurfaceTally& tally, Picture& picture) {
  add_turned_notes(input, picture.notes);
  join_cells(tally);
  const std::int64_t all = std::int64_t{input.gbuffer.width} * input.gbuffer.height;
  picture.counts = {tally.hits, all - tally.hits - tally.out_of_steps, tally.out_of_steps};
  for (size_t m = 0; m < settings.methods.size(); ++m) {
    std::vector<std::string> notes = surface_notes(settings.methods[m].method->about.name, tally, m);
    std::move(notes.begin(), notes.end(), std::back_inserter(picture.notes));
  }
}

bool any(const GBufferLayers& layers) {
  return layers.depth || layers.position || layers.normal || layers.n_dot_v || layers.id || layers.material || layers.face || layers.status;
}

}  // namespace

bool is_pixel_wise(const PictureSettings& settings) {
  return !settings.mattes && settings.methods.size() <= kMostMethods && settings.shading.shading == Shading::headlight &&
         !settings.shading.color && std::all_of(settings.methods.begin(), settings.methods.end(), [](const MethodCall& call) {
           return call.method->pixel_ink != nullptr;
         });
}

bool is_pixel_wise(const SceneModel& model, const PictureSettings& settings) { return is_pixel_wise(settings) && !file_colors(model).any; }

Picture draw_pixel_wise(const Scene& scene, const SceneModel& model, const Camera& camera, const PictureSettings& settings,
                        const ExecutionSettings& how, FrameHistory* history) {
  Picture picture;
  ThreadArena arena(how.threads);
  GBufferLayers first = joined(settings.layers, layers_read(settings));
  if (history != nullptr) {
    first.depth = first.normal = true;
    picture.gbuffer = std::exchange(history->spare, {});
  }
  constexpr GBufferLayers later{
      .depth = false, .position = false, .normal = false, .n_dot_v = true, .id = true, .material = false, .face = false, .status = false};
  const ColorsById colors = colors_by_id(model.colors);
  const Finish finish = finish_of(settings);
  std::vector<PixelInk> inks;
  std::vector<glm::vec3> ink_colors;
  for (const MethodCall& call : settings.methods) {
    inks.push_back(call.method->pixel_ink(call.parameters));
    ink_colors.emplace_back(call.parameters.vector3("color"));
  }
  const int most_together = samples_together(model, camera, settings.samples);
  make_images(settings, history != nullptr, most_together, camera, picture);
  SurfaceTally tally(model.colors.size(), {camera.width_px, camera.height_px}, {kTilesInARow * how.tile_px, how.tile_px});
  std::atomic<std::int64_t> work_ns{0};
  GBuffer later_pixels;
  const auto start = Clock::now();
  const auto shared_by = [&](int sample) {
    const bool is_first = sample == 0, is_last = sample + 1 == settings.samples;
    const PixelStage stage{&colors, ink_colors, is_first, is_last ? &finish : nullptr};
    const bool to_bytes = settings.colors == PictureColors::bytes,
               in_tasks = to_bytes && settings.samples > 1 && picture.composite.pixels.empty();
    return Sample{stage, inks, is_first ? &tally : nullptr, &picture, to_bytes && is_last, in_tasks, &work_ns};
  };
  for (int from = 0; from < settings.samples; from += most_together) {
    std::vector<PixelRays> rays;
    const int together = std::min(most_together, settings.samples - from);
    for (int sample = from; sample < from + together; ++sample) {
      const bool is_first = sample == 0, kept = is_first && (history != nullptr || any(settings.layers));
      rays.push_back({sample_offset(sample, settings.samples), is_first ? first : later, kept,
                      [shared = shared_by(sample)](const TracedPixels& traced) { draw_pixels(shared, traced); },
                      is_first ? &picture.gbuffer : &later_pixels});
    }
    render_pixels(model, camera, of_samples(how, from, together, settings.samples), rays);
  }
  const auto notes_start = Clock::now();
  arena.execute([&] { add_notes({picture.gbuffer, camera, model, scene}, settings, tally, picture); });
  const double notes_ms = ms_since(notes_start);
  // What the threads did in tiles, as if they had done it one after the other.
  picture.border_ms = notes_ms + 1e-6 * static_cast<double>(work_ns) / arena.threads();
  picture.trace_ms = std::max(0.0, ms_since(start) - picture.border_ms);
  if (settings.colors == PictureColors::bytes) picture.composite = {};
  if (history != nullptr) {
    arena.execute([&] { follow(*history, settings.hands_over_gbuffer, camera, picture.gbuffer); });
    if (!settings.hands_over_gbuffer) history->spare = std::exchange(picture.gbuffer, {});
  }
  return picture;
}

}  // namespace limn
