#include "raymarch/picture.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <utility>

#include "raymarch/border/object_groups.h"
#include "raymarch/gbuffer/file_colors.h"
#include "raymarch/mattes.h"
#include "raymarch/picture/compose.h"
#include "raymarch/picture/frame_history.h"
#include "raymarch/picture/picture_parts.h"
#include "raymarch/picture/pixel_lanes.h"
#include "raymarch/picture/pixel_wise.h"
#include "raymarch/picture/shade.h"
#include "raymarch/scene/threads.h"
#include "sdf/error.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point start) { return std::chrono::duration<double, std::milli>(Clock::now() - start).count(); }

void check_methods(const Scene& scene, const SceneModel& model, const PictureSettings& settings) {
  if (settings.samples < 1 || settings.samples > 1024) {
    throw InputError({{}, "samples", std::to_string(settings.samples), "out of range", "1 to 1024"});
  }
  for (const MethodCall& call : settings.methods) {
    LIMN_CHECK(call.method != nullptr);
    const std::string reason = call.method->unsupported(model, scene);
    if (!reason.empty()) throw InputError({{}, "method", call.method->about.name, "cannot run here: " + reason, {}});
  }
}

void add_status(const Border& border, Image<std::uint8_t>& status) {
  if (border.status.pixels.empty()) return;
  if (status.pixels.empty()) status = Image<std::uint8_t>(border.status.width, border.status.height, 0);
  for (size_t i = 0; i < status.size(); ++i) status.pixels[i] = std::max(status.pixels[i], border.status.pixels[i]);
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

Border draw_after(const BorderInput& input, bool with_notes, const MethodCall& call, const SampleInks* inks, size_t method) {
  BorderInput after = input;
  after.with_notes = with_notes;
  if (inks == nullptr || inks->before.empty()) return call.method->draw(after, call.parameters);
  const BorderBefore before{inks->before[method], inks->pixels_before};
  after.before = &before;
  return call.method->draw(after, call.parameters);
}

/// `finish`: of the last sample, as compose() takes it.
void draw_sample(const BorderInput& input, std::span<const MethodCall> methods, const ShadingSettings& shading, const Finish* finish,
                 Picture& picture, SampleInks* inks) {
  const auto start = Clock::now();
  const bool first = picture.border.pixels.empty();
  if (first) add_turned_notes(input, picture.notes);
  std::vector<Border> borders;
  borders.reserve(methods.size());
  for (size_t m = 0; m < methods.size(); ++m) {
    const Border& border = borders.emplace_back(draw_after(input, first, methods[m], inks, m));
    if (!first) continue;
    add_status(border, picture.border_status);
    picture.notes.insert(picture.notes.end(), border.notes.begin(), border.notes.end());
  }
  compose(input, borders, first, shading, finish, picture);
  if (inks != nullptr)
    for (Border& border : borders) inks->now.push_back(std::move(border.coverage));
  picture.border_ms += ms_since(start);
}

}  // namespace

GBufferLayers joined(const GBufferLayers& a, const GBufferLayers& b) {
  return {a.depth || b.depth, a.position || b.position, a.normal || b.normal, a.n_dot_v || b.n_dot_v,
          a.id || b.id,       a.material || b.material, a.face || b.face,     a.status || b.status};
}

void add_turned_notes(const BorderInput& input, std::vector<std::string>& notes) {
  for (const std::int32_t id : input.gbuffer.turned) {
    const auto index = static_cast<size_t>(id - 1);
    const std::string name = index < input.scene.objects.size() ? input.scene.objects[index].name : fmt::format("object {}", id);
    notes.push_back(fmt::format("'{}' is open and shows mostly its back: its normals are turned towards the eye", name));
  }
}

ExecutionSettings of_samples(const ExecutionSettings& how, int from, int count, int samples) {
  ExecutionSettings part = how;
  if (how.progress) part.progress = [&how, from, count, samples](double done) { how.progress((from + count * done) / samples); };
  return part;
}

// The R2 sequence (Roberts 2018), whose generator is the plastic number; starts at the pixel's centre. Its first few points lie up to 0.2
// px to one side in the mean, and so would everything drawn; the points after the first are moved back together.
glm::dvec2 sample_offset(int sample, int samples) {
  LIMN_CHECK(sample >= 0 && sample < samples);
  constexpr double plastic = 1.32471795724474602596;
  const auto r2 = [](int i) {
    const double x = 0.5 + i / plastic, y = 0.5 + i / (plastic * plastic);
    return glm::dvec2(x - std::floor(x), y - std::floor(y));
  };
  // Two samples could only both be the centre.
  if (sample == 0 || samples < 3) return r2(sample);
  glm::dvec2 sum(0.0);
  for (int i = 1; i < samples; ++i) sum += r2(i);
  return r2(sample) + 0.5 - sum / static_cast<double>(samples - 1);
}

void add_sample(const BorderInput& input, std::span<const MethodCall> methods, Picture& picture, SampleInks* inks,
                const ShadingSettings& shading) {
  draw_sample(input, methods, shading, nullptr, picture, inks);
}

void finish_samples(const PictureSettings& settings, Picture& picture) {
  if (settings.samples == 1 && !settings.background) return;
  const Finish finish = finish_of(settings);
  parallel_parts(picture.border.size(), size_t{1} << 13, [&](const IndexRange<size_t>& part) {
    for (size_t i = part.first; i < part.last; ++i) finish_pixel(finish, picture.border.pixels[i], picture.composite.pixels[i]);
  });
}

GBufferLayers layers_read(std::span<const MethodCall> methods, bool with_notes) {
  GBufferLayers layers{
      .depth = false, .position = false, .normal = false, .n_dot_v = true, .id = true, .material = false, .face = false, .status = true};
  const std::array<std::pair<const char*, bool GBufferLayers::*>, 5> named{{{"Z", &GBufferLayers::depth},
                                                                            {"P", &GBufferLayers::position},
                                                                            {"N", &GBufferLayers::normal},
                                                                            {"material", &GBufferLayers::material},
                                                                            {"face", &GBufferLayers::face}}};
  for (const MethodCall& call : methods) {
    std::vector<std::string> inputs = call.method->inputs;
    if (!with_notes) std::erase_if(inputs, [&](const std::string& input) { return contains(call.method->only_for_notes, input); });
    for (std::string& more : group_inputs(*call.method, call.parameters)) inputs.push_back(std::move(more));
    for (const std::string& input : inputs) {
      for (const auto& [name, layer] : named) layers.*layer |= input == name;
    }
  }
  return layers;
}

GBufferLayers layers_read(const PictureSettings& settings, bool with_notes) {
  GBufferLayers layers = joined(layers_read(settings.methods, with_notes), layers_read(settings.shading));
  if (settings.mattes) layers.material = true;
  return layers;
}

Picture draw_picture(const Scene& scene, const SceneModel& model, const Camera& camera, const PictureSettings& settings,
                     const ExecutionSettings& how, FrameHistory* history) {
  check_methods(scene, model, settings);
  const bool holds = history != nullptr && holds_ink(settings.methods);
  if (!holds && is_pixel_wise(model, settings)) return draw_pixel_wise(scene, model, camera, settings, how, history);
  Picture picture;
  ThreadArena arena(how.threads);
  GBufferLayers first = joined(settings.layers, layers_read(settings)), later = layers_read(settings, false);
  std::optional<MatteCollector> mattes;
  if (settings.mattes) mattes.emplace(scene, camera.width_px, camera.height_px);
  for (GBufferLayers* const read : {&first, &later}) {
    if (history != nullptr) read->depth = read->normal = true;
    *read = joined(*read, layers_read(file_colors(model)));
  }
  const bool hands_over = history == nullptr || settings.hands_over_gbuffer;
  GBuffer gbuffer = hands_over ? GBuffer{} : std::exchange(history->spare, {});
  SharedFindings shared;
  const Finish finish = finish_of(settings);
  for (int sample = 0; sample < settings.samples; ++sample) {
    const auto start = Clock::now();
    // Only the first sample's G-buffer is handed on, and only it has notes.
    render_gbuffer(model, camera, of_samples(how, sample, 1, settings.samples), sample_offset(sample, settings.samples),
                   sample == 0 ? first : later, gbuffer);
    picture.trace_ms += ms_since(start);
    const auto number = static_cast<size_t>(sample);
    if (sample == 0) picture.counts = count_hits(gbuffer);
    if (mattes) arena.execute([&] { mattes->add(gbuffer, base_colors({gbuffer, camera, model, scene})); });
    arena.execute([&] {
      const BorderInput input{gbuffer, camera, model, scene, nullptr, &shared};
      const Finish* const finishing = sample + 1 == settings.samples ? &finish : nullptr;
      if (history == nullptr) return draw_sample(input, settings.methods, settings.shading, finishing, picture, nullptr);
      SampleInks inks = inks_before(*history, number, gbuffer, camera);
      draw_sample(input, settings.methods, settings.shading, finishing, picture, &inks);
      keep(*history, number, hands_over, gbuffer, inks);
    });
    if (sample == 0 && hands_over) picture.gbuffer = std::exchange(gbuffer, {});
  }
  if (mattes) picture.mattes = mattes->finish(settings.samples);
  if (history != nullptr) history->camera = camera;
  if (!hands_over) history->spare = std::move(gbuffer);
  if (settings.colors == PictureColors::bytes) {
    picture.bytes = arena.execute([&] { return encoded(picture.composite); });
    if (history == nullptr) picture.border = {};
  }
  if (settings.colors != PictureColors::linear) picture.composite = {};
  return picture;
}

}  // namespace limn
