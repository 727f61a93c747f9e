#include "samples/experiment/engine.h"

#include <algorithm>
#include <chrono>
#include <new>

#include "samples/experiment/engine_views.h"

namespace limn {
namespace {

using Clock = std::chrono::steady_clock;
double ms_since(Clock::time_point start) { return std::chrono::duration<double, std::milli>(Clock::now() - start).count(); }

void wait_for(std::future<void> work) {
  if (work.valid()) work.get();
}

/// What the views of one model may take that wait to be measured, whether or not models wait, too.
constexpr double kWaitingViewsBytes = 64e6;

double bytes_of_views(const WaitingModel& model) {
  return model.views.empty() ? 0.0 : static_cast<double>(model.views.size()) * bytes_of(model.views.front());
}

double bytes_of(const WaitingModel& model) { return bytes_of_views(model) + static_cast<double>(total(model.built).bytes); }

template <class Same>
std::span<const ExperimentCell> leading(std::span<const ExperimentCell> cells, const Same& same) {
  const auto end = std::find_if_not(cells.begin(), cells.end(), [&](const ExperimentCell& cell) { return same(cell, cells.front()); });
  return cells.first(static_cast<size_t>(end - cells.begin()));
}

bool same_model(const ExperimentCell& a, const ExperimentCell& b) { return a.model == b.model; }
bool same_view(const ExperimentCell& a, const ExperimentCell& b) { return a.view == b.view; }

}  // namespace

ExperimentRun::ExperimentRun(Experiment experiment, const ExecutionSettings& how, ExperimentObserver observer)
    : experiment_(std::move(experiment)), how_(how), observer_(std::move(observer)), meshes_(std::move(experiment_.meshes)) {}
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
    return planned.local ? build_local_model(planned.scene, settings, *planned.local, meshes)
                         : build_model(planned.scene, settings, meshes);
  };
  SceneModel model = build_one(experiment_.share_meshes && index > 0 ? &meshes_ : nullptr);
  const double first_ms = ms_since(start);
  std::vector<double> times = {total(model).build_ms};
  // Each of them from the start; the first counts what it found ready as if it had been made anew.
  double repeated_ms = times.front();
  while (index > 0 && static_cast<int>(times.size()) < experiment_.repeats && repeated_ms < kMostRepeat_ms) {
    times.push_back(total(build_one(nullptr)).build_ms);
    repeated_ms += times.back();
  }
  // Kept beyond the model only where a later one may want it.
  const auto is_meshed = [](const ExperimentModel& one) { return one.settings.kind.starts_with("mesh"); };
  const auto later = experiment_.models.begin() + static_cast<std::ptrdiff_t>(index) + 1;
  if (index == 0 || (!experiment_.adds_models && std::none_of(later, experiment_.models.end(), is_meshed))) meshes_.kept.clear();
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
    settings.cache = &truth_cache_;
    if (const ExperimentModel& finest = experiment_.models.front(); reference_ && !finest.local)
      offer_model(finest.scene, finest.settings, *reference_, truth_cache_);
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
  if (observer_.seen) wait_for(observer_.seen(0, index, *reference_, *seen, {}));
  return *seen;
}

const Drawing& ExperimentRun::reference_drawing(size_t index, size_t method) {
  ReferenceView& view = views_[index];
  if (const auto found = view.drawings.find(method); found != view.drawings.end()) return found->second;
  const MethodCall& call = experiment_.methods[method].calls.front();
  Drawing drawing = draw(call, *reference_, experiment_.scene, experiment_.cameras[index], reference(index), Frames::each_alone);
  return view.drawings.emplace(method, std::move(drawing)).first->second;
}

DrawnView ExperimentRun::draw_view(size_t model, size_t view, const SceneModel& built) {
  const ExperimentModel& planned = experiment_.models[model];
  std::vector<std::vector<MethodCall>> methods;
  for (const ExperimentMethod& method : experiment_.methods) methods.push_back(method.calls);
  const auto before_method = [&](size_t method) {
    if (const auto progress = stage("drawing " + experiment_.methods[method].title + ", " + planned.title))
      progress(static_cast<double>(method) / static_cast<double>(methods.size()));
  };
  return draw_all(methods, built, planned.scene, experiment_.cameras[view], *experiment_.picture, with_progress("tracing " + planned.title),
                  views_[view].lines, before_method);
}

void ExperimentRun::look_at_view(const SceneModel& built, Cells cells, ViewWork& work) {
  if (how_.cancelled && how_.cancelled()) throw Cancelled{};
  work.built = &built;
  work.cells = cells;
  if (needs_reference()) reference(work.view());
  const ExperimentModel& planned = experiment_.models[work.model()];
  const Camera& camera = experiment_.cameras[work.view()];
  if (experiment_.picture)
    work.drawn = draw_view(work.model(), work.view(), built);
  else
    work.drawn.seen = look(built, planned.scene, camera, experiment_.path, how_, take_spare());
  work.seen = &work.drawn.seen;
  if (experiment_.repeats > 1) time_again(built, camera, experiment_.repeats, kMostRepeat_ms, how_, *work.seen);
  if (observer_.seen) work.under_way = observer_.seen(work.model(), work.view(), built, *work.seen, work.drawn.drawings);
  if (!experiment_.picture) {
    for (const ExperimentCell& cell : cells) {
      work.drawn.drawings.emplace_back();
      if (needs_ink())
        work.drawn.drawings.back() =
            draw(experiment_.methods[cell.method].calls.front(), built, planned.scene, camera, *work.seen, Frames::in_sequence);
    }
  }
  for (size_t i = 0; i < cells.size(); ++i) work.drawings.push_back(&work.drawn.drawings[experiment_.picture ? cells[i].method : i]);
  prepare_cells(work);
}

void ExperimentRun::look_at_reference(Cells cells, ViewWork& work) {
  const size_t index = cells.front().view;
  ReferenceView& view = views_[index];
  if (experiment_.picture && !view.seen) {
    DrawnView drawn = draw_view(0, index, *reference_);
    view.seen = std::move(drawn.seen);
    if (observer_.seen) wait_for(observer_.seen(0, index, *reference_, *view.seen, drawn.drawings));
    for (size_t method = 0; method < drawn.drawings.size(); ++method) view.drawings[method] = std::move(drawn.drawings[method]);
  }
  work.built = &*reference_;
  work.cells = cells;
  work.seen = &reference(index);
  for (const ExperimentCell& cell : cells) {
    reference_drawing(index, cell.method);
    work.drawings.push_back(&view.drawings[cell.method]);
  }
  prepare_cells(work);
}

void ExperimentRun::prepare_cells(ViewWork& work) {
  for (size_t i = 0; i < work.cells.size(); ++i) {
    const ExperimentCell& cell = work.cells[i];
    const bool compares = needs_ink() && needs_reference() && work.drawings[i]->refused.empty();
    work.truths.push_back(truth_for(work.view(), cell.method));
    work.against.push_back(compares ? &reference_drawing(work.view(), cell.method) : &work.none);
    if (measures_floor_of(cell, work.truths.back()) && !experiment_.picture) reference(work.view());
  }
}

void ExperimentRun::run_reference(Cells cells) {
  if (!reference_) reference_ = build(0);
  while (!cells.empty()) {
    const Cells group = leading(cells, same_view);
    ViewWork work;
    look_at_reference(group, work);
    ViewWork* const only = &work;
    finish({&only, 1});
    cells = cells.subspan(group.size());
  }
  // All that it has to draw is there, and it is the largest of all.
  if (experiment_.picture) reference_.reset();
}

void ExperimentRun::run_model(Cells cells, std::deque<WaitingModel>& waiting) {
  const size_t index = cells.front().model;
  if (index == 0) return run_reference(cells);
  const auto refuse = [&](const std::string& reason) {
    if (observer_.refused) observer_.refused(cells, reason);
  };
  if (!experiment_.models[index].refused.empty()) return refuse(experiment_.models[index].refused);
  // Times are taken first, while nothing else runs; then views are measured side by side, as many as may be kept.
  double others = 0.0;
  for (const WaitingModel& one : waiting) others += bytes_of(one);
  try {
    waiting.push_back({build(index), {}});
  } catch (const InputError& error) {
    return refuse(reason_of(error));
  } catch (const std::bad_alloc&) {
    if (waiting.empty()) return refuse("out of memory");
    finish(waiting);
    waiting.clear();
    return run_model(cells, waiting);
  }
  WaitingModel& model = waiting.back();
  for (; !cells.empty(); cells = cells.subspan(leading(cells, same_view).size())) {
    look_at_view(model.built, leading(cells, same_view), model.views.emplace_back());
    if (others + bytes_of_views(model) <= std::max(experiment_.waiting_bytes, kWaitingViewsBytes)) continue;
    finish(waiting);
    others = 0.0;
    while (waiting.size() > 1) waiting.pop_front();
  }
  if (others + bytes_of(model) <= experiment_.waiting_bytes) return;
  finish(waiting);
  waiting.clear();
}

void ExperimentRun::finish(std::deque<WaitingModel>& waiting) {
  std::vector<ViewWork*> works;
  for (WaitingModel& model : waiting)
    for (ViewWork& work : model.views) works.push_back(&work);
  finish(works);
  for (WaitingModel& model : waiting) model.views.clear();
}

void ExperimentRun::run(Cells cells) {
  std::deque<WaitingModel> waiting;
  while (!cells.empty()) {
    const Cells group = leading(cells, same_model);
    run_model(group, waiting);
    // Views of the first model need all truths that there are.
    truth_cache_ = {};
    cells = cells.subspan(group.size());
  }
  finish(waiting);
}

}  // namespace limn
