#include "raymarch/picture/frame_history.h"

#include <algorithm>
#include <utility>

#include "raymarch/frames.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

template <class T>
void copy_pixels(const Image<T>& from, Image<T>& to) {
  to.width = from.width;
  to.height = from.height;
  to.pixels.resize(from.size());
  parallel_parts(from.size(), size_t{1} << 16, [&](const IndexRange<size_t>& part) {
    std::copy_n(from.pixels.data() + part.first, part.last - part.first, to.pixels.data() + part.first);
  });
}

/// Of a copy, what pixels_before() reads.
void keep_gbuffer(bool copied, GBuffer& gbuffer, GBuffer& kept) {
  if (!copied) return std::swap(gbuffer, kept);
  kept.width = gbuffer.width;
  kept.height = gbuffer.height;
  kept.sample = gbuffer.sample;
  copy_pixels(gbuffer.depth, kept.depth);
  copy_pixels(gbuffer.normal, kept.normal);
  copy_pixels(gbuffer.id, kept.id);
}

}  // namespace

bool holds_ink(std::span<const MethodCall> methods) {
  return std::any_of(methods.begin(), methods.end(), [](const MethodCall& call) {
    const std::vector<Parameter>& own = call.method->parameters;
    const bool may = std::any_of(own.begin(), own.end(), [](const Parameter& one) { return one.name == "hysteresis"; });
    return may && call.parameters.number("hysteresis") != 0.0;
  });
}

SampleInks inks_before(FrameHistory& history, size_t sample, const GBuffer& gbuffer, const Camera& camera) {
  SampleInks inks;
  if (sample >= history.samples.size()) return inks;
  FrameHistory::Sample& before = history.samples[sample];
  inks.pixels_before = pixels_before(gbuffer, camera, before.gbuffer, history.camera);
  inks.before = std::move(before.inks);
  return inks;
}

void keep(FrameHistory& history, size_t sample, bool copied, GBuffer& gbuffer, SampleInks& inks) {
  if (sample >= history.samples.size()) history.samples.resize(sample + 1);
  keep_gbuffer(copied, gbuffer, history.samples[sample].gbuffer);
  history.samples[sample].inks = std::move(inks.now);
  if (sample == 0) history.pixels_before = std::move(inks.pixels_before);
}

void follow(FrameHistory& history, bool copied, const Camera& camera, GBuffer& gbuffer) {
  const bool is_first = history.samples.empty();
  history.samples.resize(1);
  GBuffer& kept = history.samples.front().gbuffer;
  if (!is_first) history.pixels_before = pixels_before(gbuffer, camera, kept, history.camera, std::move(history.pixels_before));
  keep_gbuffer(copied, gbuffer, kept);
  history.camera = camera;
}

}  // namespace limn
