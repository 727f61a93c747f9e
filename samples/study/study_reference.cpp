#include "samples/study/study_reference.h"

#include <chrono>

#include "sdf/error.h"

namespace limn {
namespace {

using Clock = std::chrono::steady_clock;
double ms_since(Clock::time_point start) { return std::chrono::duration<double, std::milli>(Clock::now() - start).count(); }

constexpr double kGBufferBytes = 64.0;

/// The ink of all frames, the first given.
std::vector<Image<float>> draw_frames(const Study& study, const SceneModel& model, const MethodCall& call, const Seen& seen, Frames frames,
                                      const Image<float>& first) {
  std::vector<Image<float>> inks;
  if (seen.moved.empty()) return inks;
  inks.push_back(first);
  for (size_t k = 0; k < seen.moved.size(); ++k) {
    const BorderBefore before{inks.back(), seen.before[k]};
    const BorderInput input{seen.moved[k], seen.cameras[k], model, study.scene, frames == Frames::in_sequence ? &before : nullptr};
    Image<float> ink = call.method->draw(input, call.parameters).coverage;
    inks.push_back(std::move(ink));
  }
  return inks;
}

}  // namespace

std::string reason_of(const InputError& error) {
  const std::string& expected = error.fault().expected;
  return error.fault().problem + (expected.empty() ? "" : " (expected " + expected + ")");
}

Seen look(const SceneModel& model, const Study& study, size_t view, const ExecutionSettings& how) {
  Seen seen;
  const Camera& camera = study.cameras[view];
  const auto start = Clock::now();
  seen.gbuffer = render_gbuffer(model, camera, how);
  seen.trace_ms = ms_since(start);
  if (!study.flicker) return seen;
  const std::vector<Camera> path = path_cameras(camera, bounds(study.scene), kFlickerPath);
  seen.cameras.assign(path.begin() + 1, path.end());
  for (size_t k = 0; k < seen.cameras.size(); ++k) {
    seen.moved.push_back(render_gbuffer(model, seen.cameras[k], how));
    seen.before.push_back(
        pixels_before(seen.moved[k], seen.cameras[k], k == 0 ? seen.gbuffer : seen.moved[k - 1], k == 0 ? camera : seen.cameras[k - 1]));
  }
  return seen;
}

Ink draw(const Study& study, const SceneModel& model, size_t view, size_t method, const Seen& seen, Frames frames) {
  const MethodCall& call = study.methods[method].call;
  Ink ink;
  ink.refused = call.method->unsupported(model, study.scene);
  if (!ink.refused.empty()) return ink;
  try {
    const auto start = Clock::now();
    ink.ink = call.method->draw({seen.gbuffer, study.cameras[view], model, study.scene}, call.parameters).coverage;
    ink.border_ms = ms_since(start);
    ink.moved = draw_frames(study, model, call, seen, frames, ink.ink);
  } catch (const InputError& error) {
    ink.refused = reason_of(error);
  }
  return ink;
}

double StudyReference::bytes_of_view(const Study& study) {
  return study.pixels() * study.looks() * (kGBufferBytes + 8.0 * static_cast<double>(study.methods.size()));
}

StudyReference::View& StudyReference::view(size_t index) {
  if (const auto found = views_.find(index); found != views_.end()) return found->second;
  const ExpectedCost cost = study_.reference_cost;
  if (!model_) {
    const auto start = Clock::now();
    model_ = build_model(study_.scene, study_.reference);
    ledger_.done("reference build", cost.build_ms, ms_since(start));
  }
  const auto start = Clock::now();
  View one;
  one.seen = look(*model_, study_, index, how_);
  ledger_.done("reference trace", study_.looks() * cost.trace_ms, ms_since(start));
  one.picture.gbuffer = one.seen.gbuffer;
  return views_.emplace(index, std::move(one)).first->second;
}

Picture& StudyReference::picture(size_t index) { return view(index).picture; }

Ink& StudyReference::ink(size_t index, size_t method) {
  View& one = view(index);
  const auto found = one.inks.find(method);
  if (found != one.inks.end()) return found->second;
  return one.inks.emplace(method, draw(study_, *model_, index, method, one.seen, Frames::each_alone)).first->second;
}

const TruthOf& StudyReference::truth(size_t index, double threshold) {
  View& one = view(index);
  if (const auto found = one.truths.find(threshold); found != one.truths.end()) return found->second;
  const auto start = Clock::now();
  TruthOf of;
  of.record.view = static_cast<int>(index);
  of.record.threshold = threshold;
  try {
    TruthSettings settings;
    settings.threshold = threshold;
    settings.max_bytes = std::min(settings.max_bytes, study_.reference.max_bytes);
    of.truth = solve_truth(study_.scene, study_.cameras[index], settings, how_);
    of.record.from = of.truth->from;
    of.record.exact = of.truth->exact;
    of.record.bound_px = of.truth->bound_px;
    of.record.notes = of.truth->notes;
  } catch (const InputError& error) {
    of.record.failed = reason_of(error);
  }
  ledger_.done("truth", study_.truth_ms(), ms_since(start));
  return one.truths.emplace(threshold, std::move(of)).first->second;
}

}  // namespace limn
