#include "samples/experiment/observe.h"

#include <algorithm>
#include <chrono>

#include "sdf/quantile.h"

namespace limn {
namespace {

using Clock = std::chrono::steady_clock;
double ms_since(Clock::time_point start) { return std::chrono::duration<double, std::milli>(Clock::now() - start).count(); }

/// The ink of all frames, the first given.
std::vector<Image<float>> draw_frames(const MethodCall& call, const SceneModel& model, const Scene& scene, const Seen& seen, Frames frames,
                                      const Image<float>& first) {
  std::vector<Image<float>> inks;
  if (seen.moved.empty()) return inks;
  inks.push_back(first);
  for (size_t k = 0; k < seen.moved.size(); ++k) {
    const BorderBefore before{inks.back(), seen.before[k]};
    const BorderInput input{seen.moved[k], seen.cameras[k], model, scene, frames == Frames::in_sequence ? &before : nullptr};
    Image<float> ink = call.method->draw(input, call.parameters).coverage;
    inks.push_back(std::move(ink));
  }
  return inks;
}

std::string why_unsupported(std::span<const MethodCall> calls, const SceneModel& model, const Scene& scene) {
  for (const MethodCall& call : calls) {
    std::string reason = call.method->unsupported(model, scene);
    if (!reason.empty()) return reason;
  }
  return {};
}

}  // namespace

Timing timing_of(std::vector<double> times_ms) {
  std::sort(times_ms.begin(), times_ms.end());
  return {interpolated_quantile(times_ms, 0.5), times_ms.front(), times_ms.back()};
}

std::string reason_of(const InputError& error) {
  const std::string& expected = error.fault().expected;
  return error.fault().problem + (expected.empty() ? "" : " (expected " + expected + ")");
}

Seen look(const SceneModel& model, const Scene& scene, const Camera& camera, const std::optional<FramePath>& path,
          const ExecutionSettings& how, GBuffer out) {
  Seen seen;
  seen.picture.gbuffer = std::move(out);
  const auto start = Clock::now();
  render_gbuffer(model, camera, how, glm::dvec2(0.5), {}, seen.picture.gbuffer);
  seen.trace = timing_of({ms_since(start)});
  seen.all_ms = seen.trace.median_ms;
  if (!path) return seen;
  const std::vector<Camera> cameras = path_cameras(camera, bounds(scene), *path);
  seen.cameras.assign(cameras.begin() + 1, cameras.end());
  for (size_t k = 0; k < seen.cameras.size(); ++k) {
    seen.moved.push_back(render_gbuffer(model, seen.cameras[k], how));
    const GBuffer& last = k == 0 ? seen.picture.gbuffer : seen.moved[k - 1];
    seen.before.push_back(pixels_before(seen.moved[k], seen.cameras[k], last, k == 0 ? camera : seen.cameras[k - 1]));
  }
  seen.all_ms = ms_since(start);
  return seen;
}

void time_again(const SceneModel& model, const Camera& camera, int repeats, double most_ms, const ExecutionSettings& how, Seen& seen) {
  std::vector<double> times = {seen.trace.median_ms};
  const auto start = Clock::now();
  GBuffer& out = seen.picture.gbuffer;  // where the same is written again: memory that is there already
  while (static_cast<int>(times.size()) < repeats && ms_since(start) + times.front() < most_ms) {
    const auto again = Clock::now();
    render_gbuffer(model, camera, how, out.sample, {}, out);
    times.push_back(ms_since(again));
  }
  seen.trace = timing_of(std::move(times));
}

Drawing draw(const MethodCall& call, const SceneModel& model, const Scene& scene, const Camera& camera, const Seen& seen, Frames frames) {
  Drawing drawing;
  drawing.refused = why_unsupported({&call, 1}, model, scene);
  if (!drawing.refused.empty()) return drawing;
  try {
    const auto start = Clock::now();
    Border border = call.method->draw({seen.picture.gbuffer, camera, model, scene}, call.parameters);
    drawing.picture.border_ms = ms_since(start);
    drawing.picture.border = std::move(border.coverage);
    drawing.picture.notes = std::move(border.notes);
    drawing.moved = draw_frames(call, model, scene, seen, frames, drawing.picture.border);
  } catch (const InputError& error) {
    drawing.refused = reason_of(error);
  }
  return drawing;
}

DrawnView draw_all(std::span<const std::vector<MethodCall>> methods, const SceneModel& model, const Scene& scene, const Camera& camera,
                   const PictureSettings& settings, const ExecutionSettings& how, LinesOfView& lines, const BeforeMethod& before_method) {
  DrawnView view;
  for (const std::vector<MethodCall>& calls : methods) view.drawings.push_back({.refused = why_unsupported(calls, model, scene)});
  Picture& shaded = view.seen.picture;
  SharedFindings shared;
  shared.lines = lines;
  for (int sample = 0; sample < settings.samples; ++sample) {
    const auto start = Clock::now();
    GBuffer gbuffer = render_gbuffer(model, camera, how, sample_offset(sample, settings.samples));
    view.seen.all_ms += ms_since(start);
    view.seen.trace = timing_of({view.seen.all_ms});
    for (size_t method = 0; method < methods.size(); ++method) {
      Drawing& drawing = view.drawings[method];
      if (!drawing.refused.empty()) continue;
      if (before_method) before_method(method);
      try {
        add_sample({gbuffer, camera, model, scene, nullptr, &shared}, methods[method], drawing.picture);
      } catch (const InputError& error) {
        drawing.refused = reason_of(error);
      }
    }
    add_sample({gbuffer, camera, model, scene}, {}, shaded);
    if (how.cancelled && how.cancelled()) throw Cancelled{};
    if (sample == 0) shaded.gbuffer = std::move(gbuffer);
  }
  lines = std::move(shared.lines);
  finish_samples(settings, shaded);
  for (Drawing& drawing : view.drawings) finish_samples(settings, drawing.picture);
  return view;
}

}  // namespace limn
