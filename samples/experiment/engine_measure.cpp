// Metrics of the engine's cells: those of several views side by side, each with what only it has.

#include <algorithm>
#include <chrono>
#include <functional>

#include "raymarch/measured_border.h"
#include "raymarch/scene/threads.h"
#include "samples/experiment/engine_views.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

using Clock = std::chrono::steady_clock;
double ms_since(Clock::time_point start) { return std::chrono::duration<double, std::milli>(Clock::now() - start).count(); }

bool of_ink(const Metric& metric) { return metric.subject == MetricSubject::ink || metric.subject == MetricSubject::motion; }

/// Of a metric of ink. `inked`: the reference is.
bool has_subject(const Metric& metric, const MetricInput& input, bool inked) {
  return inked && (metric.subject == MetricSubject::ink || (!input.moved.empty() && !input.reference_moved.empty()));
}

void add(const Metric& metric, const MetricInput& input, std::vector<Measurement>& to) {
  for (MetricValue& value : metric.measure(input)) to.push_back({&metric, std::move(value)});
}

/// Cells of a view that have a truth in common: they share what is found of its curves.
struct CellsOfTruth {
  size_t work = 0;
  std::vector<size_t> cells{};
};

std::vector<CellsOfTruth> by_truth(std::span<ViewWork* const> views) {
  std::vector<CellsOfTruth> groups;
  for (size_t w = 0; w < views.size(); ++w) {
    std::map<const ExperimentTruth*, size_t> group_of;
    for (size_t i = 0; i < views[w]->truths.size(); ++i) {
      const ExperimentTruth* const truth = views[w]->truths[i];
      const auto [found, is_new] = group_of.try_emplace(truth, groups.size());
      if (is_new || truth == nullptr) {
        found->second = groups.size();
        groups.push_back({w, {}});
      }
      groups[found->second].cells.push_back(i);
    }
  }
  return groups;
}

}  // namespace

double bytes_of(const ViewWork& work) {
  const auto of_picture = [](const Picture& picture) {
    const GBuffer& g = picture.gbuffer;
    const auto bytes = [](const auto& layer) { return static_cast<double>(layer.size() * sizeof(layer.pixels[0])); };
    return bytes(g.depth) + bytes(g.position) + bytes(g.normal) + bytes(g.n_dot_v) + bytes(g.id) + bytes(g.material) + bytes(g.face) +
           bytes(g.status) + bytes(picture.border) + bytes(picture.composite);
  };
  double sum = of_picture(work.drawn.seen.picture) * (1.0 + static_cast<double>(work.drawn.seen.moved.size()));
  for (const Drawing& drawing : work.drawn.drawings) sum += of_picture(drawing.picture) * (1.0 + static_cast<double>(drawing.moved.size()));
  return sum;
}

bool ExperimentRun::measures_floor_of(const ExperimentCell& cell, const ExperimentTruth* truth) const {
  if (!experiment_.measures_floor || truth == nullptr || !truth->truth) return false;
  // Where the reference was let go, its own cells came before and left their floor.
  const auto view = views_.find(cell.view);
  const bool known = view != views_.end() && view->second.floors.contains({truth->threshold, has_threshold(cell.method)});
  return known || reference_.has_value() || !experiment_.picture;
}

void ExperimentRun::add_curve_metrics(const MetricInput& input, bool has_threshold, std::vector<Measurement>& to) const {
  for (const Metric* metric : experiment_.metrics) {
    if (metric->subject != MetricSubject::curves || (!has_threshold && !metric->any_threshold)) continue;
    add(*metric, input, to);
  }
}

std::vector<Measurement> ExperimentRun::measure_floor(size_t view, const ExperimentTruth& truth, bool has_threshold) const {
  const Picture& picture = views_.at(view).seen->picture;
  const Camera& camera = experiment_.cameras[view];
  const BorderCurves curves = measure_border(*reference_, camera, picture.gbuffer, {.threshold = truth.threshold}, how_);
  CurveFindings findings;
  MetricInput input{picture, picture, camera};
  input.curves = &curves;
  input.truth = &*truth.truth;
  input.model = &*reference_;
  input.findings = &findings;
  std::vector<Measurement> floor;
  add_curve_metrics(input, has_threshold, floor);
  return floor;
}

void ExperimentRun::measure_gbuffer(ViewWork& work) {
  const Picture& reference = needs_reference() ? views_.at(work.view()).seen->picture : work.seen->picture;
  const MetricInput input{work.seen->picture, reference, experiment_.cameras[work.view()]};
  for (const Metric* metric : experiment_.metrics)
    if (metric->subject == MetricSubject::gbuffer) add(*metric, input, work.of_gbuffer);
}

void ExperimentRun::measure_curves(ViewWork& work, std::span<const size_t> cells) {
  if (how_.cancelled && how_.cancelled()) throw Cancelled{};
  const Camera& camera = experiment_.cameras[work.view()];
  const ExperimentTruth* const truth = work.truths[cells.front()];
  const bool drawn = std::any_of(cells.begin(), cells.end(), [&](size_t i) { return work.drawings[i]->refused.empty(); });
  if (!drawn || truth == nullptr || !truth->truth) return;
  auto start = Clock::now();
  const BorderCurves curves = measure_border(*work.built, camera, work.seen->picture.gbuffer, {.threshold = truth->threshold}, how_);
  CurveFindings findings;
  for (const size_t i : cells) {
    const Drawing &drawing = *work.drawings[i], &against = *work.against[i];
    if (!drawing.refused.empty()) continue;
    MetricInput input{drawing.picture, against.picture, camera};
    input.curves = &curves;
    input.truth = &*truth->truth;
    input.model = work.built;
    input.findings = &findings;
    add_curve_metrics(input, has_threshold(work.cells[i].method), work.of_curves[i]);
    work.curves_ms[i] = ms_since(start);
    start = Clock::now();
  }
}

void ExperimentRun::measure_ink(ViewWork& work, size_t cell) {
  if (how_.cancelled && how_.cancelled()) throw Cancelled{};
  const auto start = Clock::now();
  const Drawing &drawing = *work.drawings[cell], &against = *work.against[cell];
  if (!drawing.refused.empty()) return;
  MetricInput input{drawing.picture, against.picture, experiment_.cameras[work.view()]};
  input.moved = drawing.moved;
  input.reference_moved = against.moved;
  input.moved_before = work.seen->before;
  if (needs_reference()) input.reference_moved_before = views_.at(work.view()).seen->before;
  for (const Metric* metric : experiment_.metrics)
    if (of_ink(*metric) && has_subject(*metric, input, against.refused.empty())) add(*metric, input, work.of_ink[cell]);
  work.ink_ms[cell] = ms_since(start);
  if (observer_.drawn) observer_.drawn(work.cells[cell], drawing, against);
}

void ExperimentRun::measure_all(std::span<ViewWork* const> works) {
  struct Floor {
    size_t view = 0;
    FloorKey key{};
    const ExperimentTruth* truth = nullptr;
    std::vector<Measurement> values{};
  };
  std::vector<Floor> floors;
  for (ViewWork* const of : works) {
    ViewWork& work = *of;
    const size_t count = work.cells.size();
    work.of_curves.resize(count), work.of_ink.resize(count);
    work.curves_ms.resize(count), work.ink_ms.resize(count);
    for (size_t i = 0; i < work.cells.size(); ++i) {
      const ExperimentTruth* const truth = work.truths[i];
      if (!measures_floor_of(work.cells[i], truth)) continue;
      const FloorKey key{truth->threshold, has_threshold(work.cells[i].method)};
      if (views_[work.view()].floors.contains(key)) continue;
      const auto same = [&](const Floor& one) { return one.view == work.view() && one.key == key; };
      if (std::none_of(floors.begin(), floors.end(), same)) floors.push_back({work.view(), key, truth});
    }
  }
  // What the reference scores is measured only once, so that of its own cells nothing else is.
  std::vector<CellsOfTruth> groups = by_truth(works);
  std::erase_if(groups, [&](const CellsOfTruth& group) { return works[group.work]->model() == 0; });
  size_t cells = 0;
  for (const ViewWork* const work : works) cells += work->cells.size();
  std::vector<std::function<void()>> parts;
  parts.reserve(floors.size() + groups.size() + works.size() + cells);
  for (Floor& floor : floors)
    parts.emplace_back([this, &floor] { floor.values = measure_floor(floor.view, *floor.truth, floor.key.second); });
  for (const CellsOfTruth& group : groups) parts.emplace_back([this, works, &group] { measure_curves(*works[group.work], group.cells); });
  for (ViewWork* const work : works) {
    if (work->model() == 0) continue;
    parts.emplace_back([this, work] { measure_gbuffer(*work); });
    for (size_t i = 0; i < work->cells.size(); ++i) parts.emplace_back([this, work, i] { measure_ink(*work, i); });
  }
  ThreadArena arena(how_.threads);
  arena.execute([&] {
    // Borders are measured side by side: what their rays need is made before.
    if (!floors.empty() && reference_) prepare_points(*reference_);
    const SceneModel* prepared = nullptr;
    for (const CellsOfTruth& group : groups) {
      const ViewWork& work = *works[group.work];
      if (work.truths[group.cells.front()] == nullptr || work.built == prepared) continue;
      prepared = work.built;
      prepare_points(*prepared);
    }
    parallel_each(parts.size(), [&](size_t k) { parts[k](); });
  });
  for (Floor& floor : floors) views_[floor.view].floors.emplace(floor.key, std::move(floor.values));
}

void ExperimentRun::tell(ViewWork& work) {
  if (work.under_way.valid()) work.under_way.get();
  for (size_t i = 0; i < work.cells.size(); ++i) {
    const ExperimentCell& cell = work.cells[i];
    const ExperimentTruth* const truth = work.truths[i];
    if (observer_.cell_begins) observer_.cell_begins();
    MeasuredCell done{cell, *work.built, *work.seen, *work.drawings[i], *work.against[i], truth};
    if (measures_floor_of(cell, truth)) done.floor = views_[work.view()].floors.at({truth->threshold, has_threshold(cell.method)});
    if (!work.drawings[i]->refused.empty()) {
      // Nothing was measured.
    } else if (cell.model == 0) {
      if (observer_.drawn) observer_.drawn(cell, done.drawing, done.reference);
      done.measurements.assign(done.floor.begin(), done.floor.end());
    } else {
      // In the order of the metrics, which is that of their kinds.
      for (const std::vector<Measurement>* of : {&work.of_gbuffer, &work.of_curves[i], &work.of_ink[i]})
        done.measurements.insert(done.measurements.end(), of->begin(), of->end());
      const auto place = [&](const Measurement& one) {
        return std::find(experiment_.metrics.begin(), experiment_.metrics.end(), one.metric) - experiment_.metrics.begin();
      };
      std::stable_sort(done.measurements.begin(), done.measurements.end(),
                       [&](const Measurement& a, const Measurement& b) { return place(a) < place(b); });
    }
    done.measure_ms = work.curves_ms[i] + work.ink_ms[i];
    if (observer_.measured) observer_.measured(done);
  }
}

void ExperimentRun::finish(std::span<ViewWork* const> works) {
  if (how_.cancelled && how_.cancelled()) throw Cancelled{};
  const auto start = Clock::now();
  measure_all(works);
  // Side by side cells take longer than one after the other would.
  double sum = 0.0;
  for (const ViewWork* const work : works)
    for (size_t i = 0; i < work->cells.size(); ++i) sum += work->curves_ms[i] + work->ink_ms[i];
  const double share = sum > 0.0 ? ms_since(start) / sum : 1.0;
  for (ViewWork* const work : works) {
    for (std::vector<double>* of : {&work->curves_ms, &work->ink_ms})
      for (double& ms : *of) ms *= share;
    tell(*work);
    if (work->model() != 0) spare_.push_back(std::move(work->drawn.seen.picture.gbuffer));
  }
}

GBuffer ExperimentRun::take_spare() {
  if (spare_.empty()) return {};
  GBuffer out = std::move(spare_.back());
  spare_.pop_back();
  return out;
}

}  // namespace limn
