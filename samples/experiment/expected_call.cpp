// What a call is expected to take, and what would take less.

#include <fmt/format.h>

#include <algorithm>

#include "raymarch/picture/frame_history.h"
#include "raymarch/picture/pixel_wise.h"
#include "samples/experiment/cost.h"
#include "samples/experiment/limits.h"
#include "samples/output/output.h"
#include "sdf/error.h"

namespace limn {
namespace {

// Peaks at 1 to 16 million pixels. A composite, the ink and a method's own.
constexpr double kCompositeBytes = 36.0, kSumBytes = 20.0;
// Of a picture that is drawn tile by tile into bytes: these, a byte of facts for its notes, and what is compressed.
constexpr double kPngBytes = 12.0, kColorSumBytes = 16.0;
// Of a sequence: what both pictures, that of the model and that of the reference, leave to the next frame, memory for that frame, and where
// pixels were; of pictures that are not drawn tile by tile some of this again for each sample.
constexpr double kWatchedBytes = 120.0, kWatchedBeforeBytes = 15.0, kKeptSampleBytes = 57.0;
constexpr double kMatteBytes = 90.0;  // indices and counts of the samples, colours, and a level of ids and coverages of each kind
constexpr double kPixelMethodMs = 1e-6, kMethodMs = 3e-5, kExrMs = 1e-4, kImageMs = 5e-6;  // a pixel
constexpr double kStartMs = 8.0;
/// A machine is rarely more than twice as fast as that of the constants.
constexpr double kTimeTrust = 2.0;

/// What takes so little that no machine's memory needs looking at, so that small calls need no estimate.
bool is_small(const SurfaceSettings& settings, const PictureLoad& load) {
  constexpr double kSmallBytes = 1e9, kEnoughMachine = 8e9;
  return settings.voxels <= 512 && settings.voxel_size == 0.0 && settings.half_width_voxels <= 8.0 && settings.level <= 4 &&
         load.pixels * load.bytes_per_pixel < kSmallBytes && machine_memory() > kEnoughMachine;
}

struct Limit {
  double bytes = 0.0, time_ms = 0.0;
  bool holds(const CallCost& cost) const { return cost.bytes() <= bytes && cost.time_ms <= kTimeTrust * time_ms; }
};

CallCost largest(const Scene& scene, const SurfaceSettings& settings, const PictureLoad& load, const PlannedModels& models) {
  if (models.kinds.empty()) return expected_call(scene, settings, load, true, models.meshes);
  CallCost most;
  double time_ms = 0.0;
  for (const std::string& kind : models.kinds) {
    SurfaceSettings own = settings;
    own.kind = kind;
    const CallCost cost = expected_call(scene, own, load, true, models.meshes);
    time_ms += cost.time_ms;
    if (cost.bytes() > most.bytes()) most = cost;
  }
  most.time_ms = time_ms;
  return most;
}

/// The same call, a step smaller at a time: first what the model takes, then the picture.
struct Smaller {
  SurfaceSettings settings;
  PictureLoad load;
  double size_share = 1.0;  ///< Of the picture's sides.
  std::string words{};
};

bool has_volumes(const Scene& scene) {
  return std::any_of(scene.objects.begin(), scene.objects.end(),
                     [](const SceneObject& object) { return std::holds_alternative<LevelSetSource>(object.source); });
}

bool is_gridded(const std::string& kind, const Scene& scene, bool resampled) {
  if (resampled) return true;
  if (kind.empty()) return false;
  return kind == "level_set" || kind == "mesh_level_set"
             ? std::none_of(
                   scene.objects.begin(), scene.objects.end(),
                   [&](const SceneObject& object) { return kind == "level_set" && std::holds_alternative<LevelSetSource>(object.source); })
             : false;
}

bool shrink(const Scene& scene, bool model, const std::vector<std::string>& kinds, Smaller& smaller) {
  SurfaceSettings& settings = smaller.settings;
  const bool gridded =
      is_gridded(settings.kind, scene, settings.resample_volumes) ||
      std::any_of(kinds.begin(), kinds.end(), [&](const std::string& kind) { return is_gridded(kind, scene, settings.resample_volumes); });
  if (model && gridded && (settings.voxel_size > 0.0 || settings.voxels > 8)) {
    if (settings.voxel_size > 0.0) {
      settings.voxel_size *= 2.0;
      smaller.words = fmt::format("voxel_size = {:g}", settings.voxel_size);
    } else {
      settings.voxels /= 2;
      smaller.words = fmt::format("voxels = {}", settings.voxels);
    }
    return true;
  }
  if (model && settings.level > 0) {
    smaller.words = fmt::format("level = {}", --settings.level);
    return true;
  }
  if (smaller.size_share < 0.02) return false;
  smaller.size_share *= 0.5;
  smaller.load.pixels *= 0.25;
  smaller.load.other_ms *= 0.25;
  smaller.words = fmt::format("a picture {:g} times as wide and high", smaller.size_share);
  return true;
}

std::string cost_text(const CallCost& cost, bool time) { return time ? time_text(cost.time_ms) : bytes_text(cost.bytes()); }

std::string what_would_do(const Scene& scene, const SurfaceSettings& settings, const PictureLoad& load, const PlannedModels& models,
                          const Limit& limit, bool time) {
  Smaller smaller{settings, load};
  CallCost cost = largest(scene, settings, load, models);
  const bool model = time ? cost.time_ms > 2.0 * load.other_ms : cost.model_bytes > cost.picture_bytes;
  while (shrink(scene, model, models.kinds, smaller)) {
    cost = largest(scene, smaller.settings, smaller.load, models);
    if (limit.holds(cost)) return fmt::format("; {} needs about {}", smaller.words, cost_text(cost, time));
  }
  return "";
}

}  // namespace

PictureLoad picture_load(const Camera& camera, const PictureSettings& picture, const PlannedPictures& planned) {
  const int views = planned.views;
  const bool writes_layers = planned.writes_layers;
  const bool tile_by_tile = is_pixel_wise(picture) && !(planned.is_sequence && holds_ink(picture.methods));
  const bool in_bytes = picture.colors == PictureColors::bytes && tile_by_tile;
  const GBufferLayers layers = writes_layers ? GBufferLayers{} : layers_read(picture);
  const double layer_bytes = 4.0 * (layers.depth + layers.n_dot_v + layers.id + layers.material + layers.face) +
                             12.0 * (layers.position + layers.normal) + layers.status;
  PictureLoad load;
  load.pixels = static_cast<double>(camera.width_px) * camera.height_px;
  load.bytes_per_pixel = kCompositeBytes + layer_bytes;
  if (picture.samples > 1) load.bytes_per_pixel += kSumBytes + layer_bytes;
  if (views > 1) load.bytes_per_pixel += kCompositeBytes + layer_bytes;  // what is written while the next one is traced
  if (in_bytes) load.bytes_per_pixel = (views > 1 ? 2.0 : 1.0) * kPngBytes + (picture.samples > kSamplesTogether ? kColorSumBytes : 0.0);
  if (planned.is_sequence) load.bytes_per_pixel += tile_by_tile ? kWatchedBytes : kWatchedBeforeBytes + picture.samples * kKeptSampleBytes;
  if (picture.mattes) load.bytes_per_pixel += kMatteBytes;
  load.pictures = static_cast<double>(views) * picture.samples;
  load.other_ms =
      load.pixels * (load.pictures * (is_pixel_wise(picture) ? kPixelMethodMs : kMethodMs) * static_cast<double>(picture.methods.size()) +
                     views * (writes_layers ? kExrMs : kImageMs));
  return load;
}

CallCost expected_call(const Scene& scene, const SurfaceSettings& settings, const PictureLoad& load, bool with_cages,
                       ObjectMeshCache* cache) {
  // Cages are made only where there is a mesh of them to count.
  const bool meshes = settings.kind.starts_with("mesh");
  const ExpectedCost expected = expected_cost(size_of(scene, settings, with_cages && meshes, cache), settings, load.pixels);
  CallCost cost;
  cost.model_bytes = static_cast<double>(expected.bytes);
  cost.picture_bytes = load.pixels * load.bytes_per_pixel;
  cost.library_bytes = load.library_bytes + (has_volumes(scene) ? kVolumeLibraryBytes : 0.0);
  cost.time_ms = kStartMs + expected.build_ms + load.pictures * expected.trace_ms + load.other_ms;
  return cost;
}

std::optional<CallCost> check_limits(const LimitSpec& limits, const Scene& scene, const SurfaceSettings& settings, const PictureLoad& load,
                                     const PlannedModels& models) {
  const bool asked = limits.max_memory || limits.max_time_ms;
  if (!asked && !models.always && is_small(settings, load)) return std::nullopt;
  // Smaller calls are looked at, too, where this one does not do: they start from the same.
  ObjectMeshCache own;
  PlannedModels kept = models;
  if (!kept.meshes) kept.meshes = &own;
  const CallCost cost = largest(scene, settings, load, kept);
  const Limit limit{limits.max_memory ? static_cast<double>(*limits.max_memory) : machine_memory(),
                    limits.max_time_ms.value_or(std::numeric_limits<double>::infinity())};
  if (limit.holds(cost)) return cost;
  if (cost.bytes() > limit.bytes) {
    const std::string who = limits.max_memory ? "max_memory allows" : "the machine has";
    throw InputError({"", "", "",
                      fmt::format("the call needs about {}; {} {}{}", bytes_text(cost.bytes()), who, bytes_text(limit.bytes),
                                  what_would_do(scene, settings, load, kept, limit, false)),
                      ""});
  }
  throw InputError({"", "", "",
                    fmt::format("the call needs about {}; max_time allows {}{}", time_text(cost.time_ms), time_text(limit.time_ms),
                                what_would_do(scene, settings, load, kept, limit, true)),
                    ""});
}

}  // namespace limn
