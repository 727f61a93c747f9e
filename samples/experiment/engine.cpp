#include "samples/experiment/engine.h"

#include <algorithm>
#include <chrono>
#include <new>

#include "raymarch/measured_border.h"

namespace limn {
namespace {

using Clock = std::chrono::steady_clock;
double ms_since(Clock::time_point start) { return std::chrono::duration<double, std::milli>(Clock::now() - start).count(); }

/// Puts a drawing's ink into what was seen, for metrics that look at both, and takes it out again.
class InkIn {
 public:
  /// Null: there is nothing to put.
  InkIn(Picture* seen, Image<float>* ink) : seen_(seen), ink_(ink) { swap(); }
  ~InkIn() { swap(); }
  InkIn(const InkIn&) = delete;
  InkIn& operator=(const InkIn&) = delete;

 private:
  void swap() {
    if (seen_ != nullptr) std::swap(seen_->border, *ink_);
  }
  Picture* seen_;
  Image<float>* ink_;
};

bool has_subject(const Metric& metric, const MetricInput& input, bool inked) {
  switch (metric.subject) {
    case MetricSubject::gbuffer:
      return true;
    case MetricSubject::ink:
      return inked;
    case MetricSubject::curves:
      return input.curves != nullptr && input.truth != nullptr;
    case MetricSubject::motion:
      return inked && !input.moved.empty() && !input.reference_moved.empty();
  }
  return false;
}

template <class Same>
std::span<const ExperimentCell> leading(std::span<const ExperimentCell> cells, const Same& same) {
  const auto end = std::find_if_not(cells.begin(), cells.end(), [&](const ExperimentCell& cell) { return same(cell, cells.front()); });
  return cells.first(static_cast<size_t>(end - cells.begin()));
}

bool same_model(const ExperimentCell& a, const ExperimentCell& b) { return a.model == b.model; }
bool same_view(const ExperimentCell& a, const ExperimentCell& b) { return a.view == b.view; }

}  // namespace

struct ExperimentRun::Built {
  const SceneModel& model;
  size_t index = 0;
  std::map<double, BorderCurves> curves{};  ///< Of the view that is under way, by threshold.
  std::vector<Measurement> of_gbuffer{};    ///< The same for all of its methods.
  bool gbuffer_is_measured = false;
};

ExperimentRun::ExperimentRun(Experiment experiment, const ExecutionSettings& how, ExperimentObserver observer)
    : experiment_(std::move(experiment)), how_(how), observer_(std::move(observer)) {}
ExperimentRun::~ExperimentRun() = default;

std::function<void(double)> ExperimentRun::stage(const std::string& what) const {
  return observer_.stage ? observer_.stage(what) : std::function<void(double)>{};
}

ExecutionSettings ExperimentRun::with_progress(const std::string& what) const {
  ExecutionSettings how = how_;
  if (observer_.stage) how.progress = stage(what);
  return how;
}

bool ExperimentRun::needs_reference() const {
  return std::any_of(experiment_.metrics.begin(), experiment_.metrics.end(),
                     [](const Metric* metric) { return metric->subject != MetricSubject::curves; });
}

bool ExperimentRun::needs_ink() const {
  return experiment_.picture || std::any_of(experiment_.metrics.begin(), experiment_.metrics.end(), [](const Metric* metric) {
           return metric->subject == MetricSubject::ink || metric->subject == MetricSubject::motion;
         });
}

SceneModel ExperimentRun::build(size_t index) {
  const ExperimentModel& planned = experiment_.models[index];
  SurfaceSettings settings = planned.settings;
  if (observer_.stage) settings.progress = stage("building " + planned.title);
  const auto start = Clock::now();
  // The reference's mesh is finer than any other: no start for them.
  const auto build_one = [&](ObjectMeshCache* meshes) {
    return planned.local ? build_local_model(planned.scene, settings, *planned.local) : build_model(planned.scene, settings, meshes);
  };
  SceneModel model = build_one(experiment_.share_meshes && index > 0 ? &meshes_ : nullptr);
  const double first_ms = ms_since(start);
  std::vector<double> times = {total(model).build_ms};
  const bool repeats = index > 0 && !experiment_.share_meshes;
  while (repeats && static_cast<int>(times.size()) < experiment_.repeats && ms_since(start) < kMostRepeat_ms) {
    times.push_back(total(build_one(nullptr)).build_ms);
  }
  // Kept beyond the model only where a later one may want it.
  const auto is_meshed = [](const ExperimentModel& one) { return one.settings.kind.starts_with("mesh"); };
  const auto later = experiment_.models.begin() + static_cast<std::ptrdiff_t>(index) + 1;
  if (index == 0 || std::none_of(later, experiment_.models.end(), is_meshed)) meshes_.kept.clear();
  if (observer_.built) observer_.built(index, model, first_ms, timing_of(std::move(times)));
  return model;
}

size_t ExperimentRun::add_model(ExperimentModel model) {
  experiment_.models.push_back(std::move(model));
  return experiment_.models.size() - 1;
}

void ExperimentRun::give_truth(size_t view, ExperimentTruth truth) {
  const double threshold = truth.threshold;
  views_[view].truths.insert_or_assign(threshold, std::move(truth));
}

const ExperimentTruth& ExperimentRun::truth(size_t view, double threshold) {
  std::map<double, ExperimentTruth>& truths = views_[view].truths;
  if (const auto found = truths.find(threshold); found != truths.end()) return found->second;
  const auto start = Clock::now();
  ExperimentTruth of;
  of.threshold = threshold;
  try {
    TruthSettings settings;
    settings.threshold = threshold;
    settings.reference = experiment_.reference;
    settings.max_bytes = std::min(settings.max_bytes, experiment_.models.front().settings.max_bytes);
    of.truth = solve_truth(experiment_.scene, experiment_.cameras[view], settings, how_);
  } catch (const InputError& error) {
    of.failed = reason_of(error);
  }
  const ExperimentTruth& solved = truths.emplace(threshold, std::move(of)).first->second;
  if (observer_.solved) observer_.solved(view, solved, ms_since(start));
  return solved;
}

const ExperimentTruth* ExperimentRun::truth_for(size_t view, size_t method) {
  const std::optional<double> own = experiment_.methods[method].truth_threshold;
  if (own) return &truth(view, *own);
  if (!experiment_.silhouette_of_all) return nullptr;
  // Every truth has the silhouette: another method's is one the less to solve.
  for (const ExperimentMethod& other : experiment_.methods)
    if (other.truth_threshold) return &truth(view, *other.truth_threshold);
  return &truth(view, 0.0);
}

Seen& ExperimentRun::reference(size_t index) {
  std::optional<Seen>& seen = views_[index].seen;
  if (seen) return *seen;
  if (!reference_) reference_ = build(0);
  seen = look(*reference_, experiment_.scene, experiment_.cameras[index], experiment_.path, how_);
  if (observer_.seen) observer_.seen(0, index, *reference_, *seen, {});
  return *seen;
}

const Drawing& ExperimentRun::reference_drawing(size_t index, size_t method) {
  ReferenceView& view = views_[index];
  if (const auto found = view.drawings.find(method); found != view.drawings.end()) return found->second;
  const MethodCall& call = experiment_.methods[method].calls.front();
  Drawing drawing = draw(call, *reference_, experiment_.scene, experiment_.cameras[index], reference(index), Frames::each_alone);
  return view.drawings.emplace(method, std::move(drawing)).first->second;
}

DrawnView ExperimentRun::draw_view(size_t model, const SceneModel& built, const Camera& camera) {
  const ExperimentModel& planned = experiment_.models[model];
  std::vector<std::vector<MethodCall>> methods;
  for (const ExperimentMethod& method : experiment_.methods) methods.push_back(method.calls);
  const auto before_method = [&](size_t method) {
    if (const auto progress = stage("drawing " + experiment_.methods[method].title + ", " + planned.title))
      progress(static_cast<double>(method) / static_cast<double>(methods.size()));
  };
  return draw_all(methods, built, planned.scene, camera, *experiment_.picture, with_progress("tracing " + planned.title), before_method);
}

void ExperimentRun::add_curve_metrics(const MetricInput& input, size_t method, std::vector<Measurement>& to) const {
  const bool has_threshold = experiment_.methods[method].truth_threshold.has_value();
  for (const Metric* metric : experiment_.metrics) {
    if (metric->subject != MetricSubject::curves || (!has_threshold && !metric->any_threshold)) continue;
    for (MetricValue& value : metric->measure(input)) to.push_back({metric, std::move(value)});
  }
}

const std::vector<Measurement>& ExperimentRun::floor_of(size_t index, size_t method, const ExperimentTruth* truth) {
  ReferenceView& view = views_[index];
  if (const auto found = view.floors.find(method); found != view.floors.end()) return found->second;
  std::vector<Measurement>& floor = view.floors[method];
  if (truth == nullptr || !truth->truth) return floor;
  const Picture& picture = reference(index).picture;
  const Camera& camera = experiment_.cameras[index];
  BorderCurves& curves = view.curves.try_emplace(truth->threshold).first->second;
  if (curves.curves.empty()) curves = measure_border(*reference_, camera, picture.gbuffer, {.threshold = truth->threshold}, how_);
  MetricInput input{picture, picture, camera};
  input.curves = &curves;
  input.truth = &*truth->truth;
  input.model = &*reference_;
  add_curve_metrics(input, method, floor);
  return floor;
}

std::vector<Measurement> ExperimentRun::measure(Built& built, const ExperimentCell& cell, Seen& seen, Drawing& drawing,
                                                const Drawing& against, const ExperimentTruth* truth) {
  if (cell.model == 0) return floor_of(cell.view, cell.method, truth);
  ReferenceView& view = views_[cell.view];
  Drawing none;
  Drawing& reference_ink = needs_reference() ? view.drawings[cell.method] : none;
  Picture& reference_seen = needs_reference() ? view.seen->picture : seen.picture;
  // The reference's own picture holds its own ink.
  const InkIn own(&seen.picture, &drawing.picture.border);
  const InkIn other(needs_reference() ? &reference_seen : nullptr, &reference_ink.picture.border);
  MetricInput input{seen.picture, reference_seen, experiment_.cameras[cell.view]};
  if (truth != nullptr && truth->truth) {
    if (!built.curves.contains(truth->threshold)) {
      const MeasuredBorderSettings settings{.threshold = truth->threshold};
      built.curves[truth->threshold] = measure_border(built.model, input.camera, seen.picture.gbuffer, settings, how_);
    }
    input.curves = &built.curves[truth->threshold];
    input.truth = &*truth->truth;
    input.model = &built.model;
  }
  input.moved = drawing.moved;
  input.reference_moved = against.moved;
  input.moved_before = seen.before;
  if (needs_reference()) input.reference_moved_before = view.seen->before;
  const bool has_threshold = experiment_.methods[cell.method].truth_threshold.has_value();
  std::vector<Measurement> measured;
  const auto add = [&](const Metric& metric, std::vector<Measurement>& to) {
    for (MetricValue& value : metric.measure(input)) to.push_back({&metric, std::move(value)});
  };
  for (const Metric* metric : experiment_.metrics) {
    const bool of_curves = metric->subject == MetricSubject::curves;
    if (!has_subject(*metric, input, against.refused.empty())) continue;
    if (of_curves && !has_threshold && !metric->any_threshold) continue;
    if (metric->subject != MetricSubject::gbuffer) {
      add(*metric, measured);
      continue;
    }
    if (!built.gbuffer_is_measured) add(*metric, built.of_gbuffer);
    for (const Measurement& one : built.of_gbuffer)
      if (one.metric == metric) measured.push_back(one);
  }
  built.gbuffer_is_measured = true;
  return measured;
}

void ExperimentRun::finish(Built& built, size_t view, Seen& seen, Cells cells, const std::function<Drawing&(size_t)>& take) {
  built.curves.clear();
  built.of_gbuffer.clear();
  built.gbuffer_is_measured = false;
  const Drawing none;
  for (const ExperimentCell& cell : cells) {
    if (how_.cancelled && how_.cancelled()) throw Cancelled{};
    if (observer_.cell_begins) observer_.cell_begins();
    const ExperimentTruth* truth = truth_for(view, cell.method);
    const auto start = Clock::now();
    Drawing& drawing = take(cell.method);
    const bool draws = needs_ink();
    const Drawing& against = draws && drawing.refused.empty() && needs_reference() ? reference_drawing(view, cell.method) : none;
    MeasuredCell done{cell, built.model, seen, drawing, against, truth};
    if (drawing.refused.empty()) done.measurements = measure(built, cell, seen, drawing, against, truth);
    // Where the reference was let go, its own cells came before and left their floor.
    if (experiment_.measures_floor && (reference_ || !experiment_.picture || views_[view].floors.contains(cell.method)))
      done.floor = floor_of(view, cell.method, truth);
    done.measure_ms = ms_since(start);
    if (observer_.measured) observer_.measured(done);
  }
}

void ExperimentRun::run_view(Built& built, Cells cells) {
  const size_t view = cells.front().view;
  if (how_.cancelled && how_.cancelled()) throw Cancelled{};
  if (needs_reference()) reference(view);
  const ExperimentModel& planned = experiment_.models[built.index];
  const Camera& camera = experiment_.cameras[view];
  DrawnView drawn;
  if (experiment_.picture)
    drawn = draw_view(built.index, built.model, camera);
  else
    drawn.seen = look(built.model, planned.scene, camera, experiment_.path, how_);
  if (experiment_.repeats > 1) time_again(built.model, camera, experiment_.repeats, kMostRepeat_ms, how_, drawn.seen);
  if (observer_.seen) observer_.seen(built.index, view, built.model, drawn.seen, drawn.drawings);
  Drawing one;
  finish(built, view, drawn.seen, cells, [&](size_t method) -> Drawing& {
    if (experiment_.picture) return drawn.drawings[method];
    one = {};
    if (needs_ink())
      one = draw(experiment_.methods[method].calls.front(), built.model, planned.scene, camera, drawn.seen, Frames::in_sequence);
    return one;
  });
}

void ExperimentRun::run_reference(Cells cells) {
  if (!reference_) reference_ = build(0);
  Built built{*reference_, 0};
  while (!cells.empty()) {
    const Cells group = leading(cells, same_view);
    const size_t index = group.front().view;
    ReferenceView& view = views_[index];
    if (experiment_.picture && !view.seen) {
      DrawnView drawn = draw_view(0, *reference_, experiment_.cameras[index]);
      view.seen = std::move(drawn.seen);
      if (observer_.seen) observer_.seen(0, index, *reference_, *view.seen, drawn.drawings);
      for (size_t method = 0; method < drawn.drawings.size(); ++method) view.drawings[method] = std::move(drawn.drawings[method]);
    }
    reference(index);
    finish(built, index, *view.seen, group, [&](size_t method) -> Drawing& {
      reference_drawing(index, method);
      return view.drawings[method];
    });
    cells = cells.subspan(group.size());
  }
  // All that it has to draw is there, and it is the largest of all.
  if (experiment_.picture) reference_.reset();
}

void ExperimentRun::run_model(Cells cells) {
  const size_t index = cells.front().model;
  if (index == 0) return run_reference(cells);
  const auto refuse = [&](const std::string& reason) {
    if (observer_.refused) observer_.refused(cells, reason);
  };
  if (!experiment_.models[index].refused.empty()) return refuse(experiment_.models[index].refused);
  std::optional<SceneModel> model;
  try {
    model = build(index);
  } catch (const InputError& error) {
    return refuse(reason_of(error));
  } catch (const std::bad_alloc&) {
    return refuse("out of memory");
  }
  Built of{*model, index};
  while (!cells.empty()) {
    const Cells group = leading(cells, same_view);
    run_view(of, group);
    cells = cells.subspan(group.size());
  }
}

void ExperimentRun::run(Cells cells) {
  while (!cells.empty()) {
    const Cells group = leading(cells, same_model);
    run_model(group);
    cells = cells.subspan(group.size());
  }
}

}  // namespace limn
