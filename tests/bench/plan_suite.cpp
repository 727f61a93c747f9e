#include "tests/bench/plan_suite.h"

#include <fmt/core.h>

#include <map>
#include <optional>

#include "raymarch/truth/proxy.h"
#include "samples/experiment/job.h"
#include "samples/output/output.h"
#include "samples/scenes/scenes.h"
#include "tests/plan_check.h"

namespace limn::bench {
namespace {

constexpr double kTolerances_px[] = {1.0, 0.5, 0.25};
constexpr double kShare = 0.05;  // of the border that may lie beyond the tolerance

struct Sums {
  int plans = 0, chosen = 0, meets = 0, with_coarser = 0, coarser_fails = 0, quarter = 0, local = 0;
  double time_ms = 0.0, finest_time_ms = 0.0, bytes = 0.0, finest_bytes = 0.0;
  std::string example{};
  void add(const Sums& other) {
    plans += other.plans, chosen += other.chosen, meets += other.meets, with_coarser += other.with_coarser;
    coarser_fails += other.coarser_fails, quarter += other.quarter, local += other.local, time_ms += other.time_ms,
        finest_time_ms += other.finest_time_ms;
    bytes += other.bytes, finest_bytes += other.finest_bytes;
  }
};

struct Built {
  double time_ms = 0.0;
  double bytes = 0.0;
};

SceneModel build(const Scene& scene, const ResolutionSeries& series, size_t candidate) {
  Scene bare = scene;
  for (SceneObject& object : bare.objects) object.level.reset();
  if (const auto local = series.local_at(candidate)) return build_local_model(bare, series.at(candidate), *local);
  return build_model(bare, series.at(candidate));
}

/// The last candidate, built and traced for real; the last one that fits into memory.
Built finest_of(const Scene& scene, const ResolutionSeries& series, const PlanView& view) {
  for (size_t candidate = series.candidates.size(); candidate-- > 0;) {
    try {
      const SceneModel model = build(scene, series, candidate);
      double trace_ms = 0.0;
      measure_errors(model, view, 0.4, {}, trace_ms);
      const SurfaceInfo info = total(model);
      return {info.build_ms + trace_ms, static_cast<double>(info.bytes)};
    } catch (const std::exception&) {
      continue;
    }
  }
  return {};
}

struct Case {
  const Scene& scene;
  const PlanView& view;
  const SceneModel& reference;
  int view_index;
  std::map<std::string, Built>& finest;  ///< By series: built once a scene, traced in the view that asked first.
  std::vector<PlanTrial>& known;         ///< Of the other tolerances.
};

nlohmann::json run_plan(const Case& at, double tolerance_px, bool local, Sums& sums) {
  PlanSettings settings;
  settings.local = local;
  settings.tolerance_px = tolerance_px;
  ProgressBar bar(false);
  const PlanAnswer answer = make_plan(at.scene, {at.view}, settings, {}, bar, at.known);
  at.known = answer.trials;
  nlohmann::json row = {{"suite", "plan"}, {"scene", at.scene.name}, {"view", at.view_index}, {"tolerance_px", tolerance_px}};
  ++sums.plans;
  if (!answer.chosen) {
    row["chosen"] = nullptr;
    return row;
  }
  const PlanTrial& chosen = answer.trials[*answer.chosen];
  const ResolutionSeries& series = answer.all_series[chosen.series];
  const auto beyond = [&](const SceneModel& model, bool of_all = false) {
    return test::share_beyond(model, at.reference, at.view, settings.threshold, tolerance_px, settings.metric, of_all);
  };
  const auto [finest, added] = at.finest.try_emplace(series.title);
  if (added) finest->second = finest_of(at.scene, series, at.view);
  const SceneModel model = build(at.scene, series, chosen.candidate);
  const double share = beyond(model);
  std::optional<double> coarser;
  if (chosen.candidate > 0) coarser = beyond(build(at.scene, series, chosen.candidate - 1));
  ++sums.chosen;
  sums.local += series.local.has_value();
  sums.meets += share <= kShare;
  sums.with_coarser += coarser.has_value();
  sums.coarser_fails += coarser.value_or(0.0) > kShare;
  sums.quarter += chosen.time_ms() <= 0.25 * finest->second.time_ms;
  sums.time_ms += chosen.time_ms(), sums.finest_time_ms += finest->second.time_ms;
  sums.bytes += static_cast<double>(chosen.bytes), sums.finest_bytes += finest->second.bytes;
  if (tolerance_px == 0.5 && sums.example.empty()) sums.example = series.title + ", " + series.words_at(chosen.candidate);
  row["chosen"] = series.title + ", " + series.words_at(chosen.candidate);
  row["measured_px"] = chosen.measured.of(settings.metric);
  row["predicted_px"] = chosen.predicted.expected.of(settings.metric);
  row["share_beyond"] = share;
  row["share_beyond_of_all"] = beyond(model, true);
  row["coarser_share_beyond"] = coarser ? nlohmann::json(*coarser) : nlohmann::json(nullptr);
  row["time_ms"] = chosen.time_ms(), row["bytes"] = chosen.bytes;
  row["finest_time_ms"] = finest->second.time_ms, row["finest_bytes"] = finest->second.bytes;
  row["local"] = series.local.has_value();
  row["trials"] = answer.trials.size();
  row["notes"] = answer.notes;
  return row;
}

std::string line(const std::string& name, const Sums& sums) {
  const double n = std::max(1, sums.chosen);
  return fmt::format("| {} | {}/{} | {}/{} | {}/{} | {}/{} | {} | {} | {:.0f}x | {} | {} | {:.0f}x |\n", name, sums.local, sums.chosen,
                     sums.meets, sums.plans, sums.coarser_fails, sums.with_coarser, sums.quarter, sums.chosen, time_text(sums.time_ms / n),
                     time_text(sums.finest_time_ms / n), sums.finest_time_ms / std::max(sums.time_ms, 1e-9), bytes_text(sums.bytes / n),
                     bytes_text(sums.finest_bytes / n), sums.finest_bytes / std::max(sums.bytes, 1.0));
}

Sums run_scene(const SceneDescriptor& descriptor, const PlanBenchSettings& settings, nlohmann::json& rows) {
  Sums sums;
  Scene scene = descriptor.make();
  scene.name = descriptor.about.name;
  CameraSettings camera = scene.camera;
  camera.width_px = settings.width_px;
  camera.height_px = settings.height_px;
  std::map<std::string, Built> finest;
  for (int index = 0; index < settings.views; ++index) {
    if (settings.only_view && index != *settings.only_view) continue;
    PlanView view;
    view.camera = camera_of_view(camera, {bounds(scene), {}}, {}, index, settings.views);
    view.truth = solve_truth(scene, view.camera, {}, {});
    const TruthProxy reference = make_proxy(scene, view.camera, std::int64_t{4} << 30, 1.0);
    std::vector<PlanTrial> known;
    for (const double tolerance_px : kTolerances_px) {
      rows.push_back(run_plan({scene, view, reference.model, index, finest, known}, tolerance_px, settings.local, sums));
      fmt::print(stderr, "{}\n", rows.back().dump());
    }
  }
  return sums;
}

}  // namespace

nlohmann::json bench_plan(const PlanBenchSettings& settings) {
  nlohmann::json rows = nlohmann::json::array();
  fmt::print(settings.table,
             "| scene | local | meets the tolerance | next coarser fails | at most a quarter of the finest's time | time | finest | saved "
             "| memory | "
             "finest | saved |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
  Sums all;
  for (const SceneDescriptor& scene : scenes()) {
    const auto wanted = [&] {
      return std::find(settings.scenes.begin(), settings.scenes.end(), scene.about.name) != settings.scenes.end();
    };
    if (!settings.scenes.empty() && !wanted()) continue;
    const Sums sums = run_scene(scene, settings, rows);
    fmt::print(settings.table, "{}", line(scene.about.name, sums));
    std::fflush(settings.table);
    all.add(sums);
  }
  fmt::print(settings.table, "{}", line("all", all));
  return rows;
}

}  // namespace limn::bench
