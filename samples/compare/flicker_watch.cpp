#include "samples/compare/flicker_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "raymarch/scene/threads.h"
#include "samples/compare/comparison.h"
#include "samples/experiment/job.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

struct Sum {
  FrameFlips counts{};
  size_t worst = 0;
  double flicker = std::numeric_limits<double>::quiet_NaN();  ///< Flips beyond the reference's for each pixel of its border and frame.
};

Sum sum_of(const FlickerWatch& watch) {
  Sum sum;
  for (size_t k = 0; k < watch.frames.size(); ++k) {
    const FrameFlips& frame = watch.frames[k].counts;
    sum.counts.flips += frame.flips;
    sum.counts.reference_flips += frame.reference_flips;
    sum.counts.beyond += frame.beyond;
    sum.counts.border += frame.border;
    if (frame.beyond > watch.frames[sum.worst].counts.beyond) sum.worst = k;
  }
  if (sum.counts.border > 0) sum.flicker = static_cast<double>(sum.counts.beyond) / static_cast<double>(sum.counts.border);
  return sum;
}

/// The methods as asked for, none of which holds on to what it drew before.
std::vector<MethodCall> without_hysteresis(BorderSpec spec, const SceneInput& input) {
  for (const MethodCall& call : method_calls(spec, input)) {
    const std::vector<Parameter>& parameters = call.method->parameters;
    const auto is_hysteresis = [](const Parameter& one) { return one.name == "hysteresis"; };
    if (std::any_of(parameters.begin(), parameters.end(), is_hysteresis)) {
      spec.parameters.push_back({call.method->about.name + ".hysteresis", {{0.0}}});
    }
  }
  return method_calls(spec, input);
}

/// `before` and `now`: ink, and where its pixels were.
FlipPlaces flip_places(const Image<float>& n_dot_v_now, const Image<std::int32_t>& pixels_before, const Image<std::uint8_t>& before,
                       const Image<std::uint8_t>& now) {
  const auto of_pixels = [&](const IndexRange<size_t>& part, FlipPlaces places) {
    const auto settled = [&](size_t i, size_t was) { return same_run(&now.pixels[i], &before.pixels[was]); };
    for_each_unsettled(pixels_before, part, settled, [&](size_t i, std::int64_t was) {
      if (was < 0) {
        ++places.unseen;
      } else if (before.pixels[static_cast<size_t>(was)] != now.pixels[i]) {
        const double n_dot_v = double{n_dot_v_now.pixels[i]};
        places.lowest_n_dot_v = std::min(places.lowest_n_dot_v, n_dot_v);
        places.highest_n_dot_v = std::max(places.highest_n_dot_v, n_dot_v);
      }
    });
    return places;
  };
  const auto joined_places = [](const FlipPlaces& a, const FlipPlaces& b) {
    return FlipPlaces{a.unseen + b.unseen, std::min(a.lowest_n_dot_v, b.lowest_n_dot_v), std::max(a.highest_n_dot_v, b.highest_n_dot_v)};
  };
  return parallel_reduce(pixels_before.size(), size_t{1} << 14, FlipPlaces{}, of_pixels, joined_places);
}

}  // namespace

FlickerWatch watch_flicker(const ExperimentSpec& spec, const FramePath& path, const SceneInput& input, const SurfaceSettings& surface) {
  Comparison comparison = plan_comparison(input, surface, {"analytic"}, spec.surface.gradient.has_value());
  FlickerWatch watch;
  watch.path = path;
  watch.reference_words = comparison.reference_words;
  watch.scene = comparison.reference().scene;
  watch.reference = build_model(watch.scene, comparison.reference().surface);
  watch.picture = picture_settings(spec.border, input);
  watch.picture.methods = without_hysteresis(spec.border, input);
  watch.picture.layers = layers_read(watch.picture.methods);
  watch.picture.colors = PictureColors::none;
  watch.picture.hands_over_gbuffer = false;
  for (const MethodCall& call : watch.picture.methods) {
    const std::string reason = call.method->unsupported(watch.reference, watch.scene);
    if (!reason.empty()) watch.no_reference = call.method->about.name + " cannot draw " + watch.reference_words + ": " + reason;
  }
  return watch;
}

void watch_frame(const Picture& picture, const FrameHistory& history, const Camera& camera, const ExecutionSettings& how,
                 FlickerWatch& watch) {
  const InkFrame own{picture.border, history.pixels_before};
  FlickerWatch::Frame frame;
  std::optional<Picture> reference;
  if (watch.no_reference.empty()) reference = draw_picture(watch.scene, watch.reference, camera, watch.picture, how, &watch.history);
  ThreadArena(how.threads).execute([&] {
    const InkFrame given = reference ? InkFrame{reference->border, watch.history.pixels_before} : own;
    frame.counts = count_flips(own, given, watch.flips);
    const bool handed_over = !picture.gbuffer.n_dot_v.pixels.empty();
    const GBuffer& seen = handed_over ? picture.gbuffer : history.samples.front().gbuffer;
    frame.places = flip_places(seen.n_dot_v, history.pixels_before, watch.flips.before.ink, watch.flips.last.ink);
  });
  watch.frames.push_back(frame);
}

Json flicker_json(const FlickerWatch& watch) {
  const Sum sum = sum_of(watch);
  const bool is_compared = watch.no_reference.empty();
  const auto compared = [&](std::int64_t count) { return is_compared ? Json(count) : Json(); };
  Json frames = Json::array();
  for (size_t k = 0; k < watch.frames.size(); ++k) {
    const FlickerWatch::Frame& frame = watch.frames[k];
    const bool any = frame.places.lowest_n_dot_v <= frame.places.highest_n_dot_v;
    frames.push_back({{"frame", k},
                      {"flips", frame.counts.flips},
                      {"reference_flips", compared(frame.counts.reference_flips)},
                      {"beyond", compared(frame.counts.beyond)},
                      {"border_pixels", frame.counts.border},
                      {"unseen_pixels", frame.places.unseen},
                      {"n_dot_v", any ? Json{frame.places.lowest_n_dot_v, frame.places.highest_n_dot_v} : Json()}});
  }
  return {{"frames", watch.frames.size()},
          {"step_px", watch.path.step_px},
          {"seed", watch.path.seed},
          {"reference", is_compared ? watch.reference_words : watch.no_reference},
          {"flips", sum.counts.flips},
          {"reference_flips", compared(sum.counts.reference_flips)},
          {"beyond", compared(sum.counts.beyond)},
          {"flicker", is_compared ? number_or_null(sum.flicker) : Json()},
          {"worst_frame", sum.worst},
          {"per_frame", frames}};
}

std::string flicker_sentence(const FlickerWatch& watch) {
  const Sum sum = sum_of(watch);
  if (!watch.no_reference.empty()) {
    return fmt::format("flicker: ink flipped {} times over {} frames {:g} px apart; nothing to hold that against: {}", sum.counts.flips,
                       watch.frames.size(), watch.path.step_px, watch.no_reference);
  }
  std::string text =
      fmt::format("flicker: ink flipped {} times over {} frames {:g} px apart, that of {} {} times; {} flips beyond its", sum.counts.flips,
                  watch.frames.size(), watch.path.step_px, watch.reference_words, sum.counts.reference_flips, sum.counts.beyond);
  if (sum.counts.beyond > 0) {
    text += fmt::format(
        ", most in frame {} ({}); {:.3f} for each pixel of its border and frame; a parameter hysteresis above 0 holds them back", sum.worst,
        watch.frames[sum.worst].counts.beyond, sum.flicker);
  }
  return text;
}

}  // namespace limn
