#include "samples/study/reference.h"

#include <chrono>

#include "sdf/error.h"

namespace limn {
namespace {

using Clock = std::chrono::steady_clock;
double ms_since(Clock::time_point start) { return std::chrono::duration<double, std::milli>(Clock::now() - start).count(); }

constexpr double kGBufferBytes = 64.0;

Border border_of(const Study& study, const SceneModel& model, size_t view, const MethodCall& call, const GBuffer& gbuffer) {
  return call.method->draw({gbuffer, study.cameras[view], model, study.scene}, call.parameters);
}

}  // namespace

// The first sample is the pixel's centre, which is the picture itself.
glm::dvec2 move_offset(int move) { return sample_offset(move + 1); }

std::string reason_of(const InputError& error) {
  const std::string& expected = error.fault().expected;
  return error.fault().problem + (expected.empty() ? "" : "; " + expected);
}

Seen look(const SceneModel& model, const Camera& camera, bool flicker, const ExecutionSettings& how) {
  Seen seen;
  const auto start = Clock::now();
  seen.gbuffer = render_gbuffer(model, camera, how);
  seen.trace_ms = ms_since(start);
  for (int move = 0; flicker && move < kMoves; ++move) seen.moved.push_back(render_gbuffer(model, camera, how, move_offset(move)));
  return seen;
}

Ink draw(const Study& study, const SceneModel& model, size_t view, size_t method, const Seen& seen) {
  const MethodCall& call = study.methods[method].call;
  Ink ink;
  ink.refused = call.method->unsupported(model, study.scene);
  if (!ink.refused.empty()) return ink;
  try {
    const auto start = Clock::now();
    ink.ink = border_of(study, model, view, call, seen.gbuffer).coverage;
    ink.border_ms = ms_since(start);
    for (const GBuffer& moved : seen.moved) ink.moved.push_back(border_of(study, model, view, call, moved).coverage);
  } catch (const InputError& error) {
    ink.refused = reason_of(error);
  }
  return ink;
}

double StudyReference::bytes_of_view(const Study& study) {
  const double pictures = 1.0 + (study.flicker ? double{kMoves} : 0.0);
  return study.pixels() * pictures * (kGBufferBytes + 8.0 * static_cast<double>(study.methods.size()));
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
  one.seen = look(*model_, study_.cameras[index], study_.flicker, how_);
  ledger_.done("reference trace", study_.looks() * cost.trace_ms, ms_since(start));
  one.picture.gbuffer = one.seen.gbuffer;
  return views_.emplace(index, std::move(one)).first->second;
}

Picture& StudyReference::picture(size_t index) { return view(index).picture; }

Ink& StudyReference::ink(size_t index, size_t method) {
  View& one = view(index);
  const auto found = one.inks.find(method);
  if (found != one.inks.end()) return found->second;
  return one.inks.emplace(method, draw(study_, *model_, index, method, one.seen)).first->second;
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
