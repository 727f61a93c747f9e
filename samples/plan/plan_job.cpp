#include "samples/plan/plan_job.h"
#include "samples/spec/parse.h"

#include <fmt/format.h>

#include <cmath>

#include "samples/experiment/limits.h"
#include "samples/experiment/local_request.h"
#include "samples/experiment/no_effect.h"
#include "samples/input/scene_facts.h"
#include "samples/spec/surface_setting.h"
#include "sdf/error.h"

namespace limn {
namespace {

/// Of the first method that has one, whatever else the call draws.
double threshold_of(const BorderSpec& spec, const SceneInput& input) {
  for (const MethodCall& call : method_calls(spec, input)) {
    if (call.method->truth_threshold != nullptr) return call.method->truth_threshold(call.parameters);
  }
  const BorderMethod& usual = find_border_method(kDefaultMethod);
  return usual.truth_threshold(resolve(usual.parameters, {}));
}

/// What a plan chooses cannot be given.
void check_open(const SurfaceSpec& spec) {
  for (const SurfaceSetting& setting : surface_setting_list()) {
    if (!is_fixed(setting) && setting.asked(spec))
      throw InputError({"", setting.name, "", "has no effect: a plan chooses it; leave it out", ""});
  }
}

PlanSettings settings_of(const ExperimentSpec& spec, const PlanSpec& plan, const SceneInput& input) {
  LIMN_CHECK(plan.tolerance_px.has_value());
  PlanSettings settings;
  settings.tolerance_px = *plan.tolerance_px;
  settings.metric = plan.silhouette ? PlanMetric::silhouette : PlanMetric::border;
  settings.threshold = threshold_of(spec.border, input);
  settings.budget_ms = plan.budget_ms;
  settings.budget_bytes = plan.budget_bytes;
  settings.max_bytes = std::min(settings.max_bytes, model_bytes_left(spec.limits, 0.0));
  settings.kinds = spec.surfaces;
  return settings;
}

/// The least that a plan takes: one coarse model, and in each view the true border and that of a few models.
void check_least(const ExperimentSpec& spec, const Scene& scene, const CameraSettings& camera) {
  constexpr double kBytes = 70.0, kMs = 1.2e-3;  // a pixel; of an ellipsoid and a rook at 0.06 to 2 million pixels
  SurfaceSettings coarse;
  coarse.kind = spec.surfaces.empty() ? "" : spec.surfaces.front();
  coarse.voxels = 16;
  coarse.level = 0;
  PictureLoad load;
  load.pixels = static_cast<double>(camera.width_px) * camera.height_px;
  load.bytes_per_pixel = kBytes;
  load.pictures = spec.views;
  load.other_ms = load.pixels * spec.views * kMs;
  check_limits(spec.limits, scene, coarse, load);
}

/// A field is measured as the models are. A cage has nothing between it and its models.
ErrorFloor floor_of(const Scene& scene, const PlanJob& job, const ExecutionSettings& how) {
  ErrorFloor floor;
  std::optional<SceneModel> surface;
  if (all_are<Field>(scene)) surface = build_model(scene, {.kind = "analytic"});
  for (const PlanView& view : job.views) {
    floor.truth_bound_px = std::max(floor.truth_bound_px, view.truth.bound_px);
    floor.exact = floor.exact && view.truth.exact;
    double trace_ms = 0.0;
    if (!surface) continue;
    const BorderErrors errors = measure_errors(*surface, view, job.settings.threshold, how, trace_ms);
    floor.reference_px = std::max(floor.reference_px, errors.of(job.settings.metric));
  }
  return floor;
}

Json parameters_json(const ResolutionSeries& series, const PlanTrial& trial) {
  Json json = Json::object();
  if (series.local) json["local"] = series.local_at(trial.candidate)->tolerance_px;
  if (!series.by_tolerance) json[series.by_level ? "level" : "voxels"] = series.candidates[trial.candidate];
  if (series.settings.kind == "mesh")
    json["normals"] = name_of(series.settings.normals.value_or(NormalKind::limit));
  else
    json["gradient"] = series.settings.gradient;
  return json;
}

Json trial_json(const PlanAnswer& answer, const PlanTrial& trial, PlanMetric metric) {
  const ResolutionSeries& series = answer.all_series[trial.series];
  Json json = {{"surface", series.settings.kind},
               {"parameters", parameters_json(series, trial)},
               {"predicted_px", number_or_null(trial.predicted.expected.of(metric))},
               {"predicted_low_px", number_or_null(trial.predicted.low.of(metric))},
               {"predicted_high_px", number_or_null(trial.predicted.high.of(metric))},
               {"measured_px", number_or_null(trial.measured.of(metric))},
               {"silhouette_px", number_or_null(trial.measured.silhouette_px)},
               {"inner_px", number_or_null(trial.measured.inner_px)},
               {"bytes", trial.bytes},
               {"triangles", trial.triangles},
               {"voxels", trial.voxels},
               {"build_ms", trial.build_ms},
               {"trace_ms", trial.trace_ms},
               {"time_ms", trial.time_ms()}};
  if (!trial.failed.empty()) json["failed"] = trial.failed;
  return json;
}

}  // namespace

void refuse_unplanned(const ExperimentSpec& spec, const SceneInput& input) {
  check_open(spec.surface);
  if (spec.surface.half_width_voxels)
    throw InputError({"", "half_width", "", "has no effect: each model of a plan has the band that its gradient needs; leave it out", ""});
  std::vector<std::string> kinds = spec.surfaces;
  if (kinds.empty()) {
    for (const SurfaceDescriptor& kind : surface_kinds()) kinds.push_back(kind.about.name);
  }
  refuse_without_effect(spec.surface, input, {.kinds = kinds});
}

PlanJob plan_for(const ExperimentSpec& spec, const PlanSpec& plan, const SceneInput& input, ProgressBar& bar, bool local) {
  return plan_for(spec, plan, input, bar, execution_settings(spec.threads), local);
}

PlanJob plan_for(const ExperimentSpec& spec, const PlanSpec& plan, const SceneInput& input, ProgressBar& bar, const ExecutionSettings& how,
                 bool local) {
  PlanJob job;
  refuse_unplanned(spec, input);
  refuse_reference_without_effect(spec, input);
  job.settings = settings_of(spec, plan, input);
  job.settings.local = local;
  if (local)
    refuse_local_without_effect(spec, input.scene, {},
                                spec.surfaces.empty() ? std::vector<std::string>{"mesh", "level_set", "mesh_level_set"} : spec.surfaces);
  const CameraSettings camera_of = camera_settings(spec.camera, input);
  const FramedSurface framed = framed_input(spec.camera, input);
  check_least(spec, input.scene, camera_of);
  TruthCache of_scene;
  for (int view = 0; view < spec.views; ++view) {
    PlanView one;
    one.camera = camera_of_view(camera_of, framed, framing_settings(spec.camera), view, spec.views);
    ExecutionSettings solving = how;
    solving.progress = bar.stage(fmt::format("solving the true border, view {} of {}", view + 1, spec.views));
    TruthSettings truth;
    truth.threshold = job.settings.threshold;
    truth.reference = spec.reference.value_or(TruthReference::given);
    truth.cache = &of_scene;
    one.truth = solve_truth(input.scene, one.camera, truth, solving);
    job.views.push_back(std::move(one));
  }
  of_scene = {};
  // Where there is no border every model is right.
  if (std::all_of(job.views.begin(), job.views.end(), [](const PlanView& view) { return view.truth.curves.curves.empty(); }))
    throw InputError({spec.input, "camera", "", "sees no border: there is nothing to plan for",
                      "one that sees the surface (limn render shows what it sees)"});
  job.answer = make_plan(input.scene, job.views, job.settings, how, bar);
  job.answer.floor = floor_of(input.scene, job, how);
  job.answer.doubt = why_not_to_be_told(job.settings.tolerance_px, job.answer.floor);
  bar.clear();
  return job;
}

Json plan_json(const PlanJob& job) {
  const PlanAnswer& answer = job.answer;
  const PlanMetric metric = job.settings.metric;
  Json json = {
      {"tolerance_px", job.settings.tolerance_px},
      {"metric", metric == PlanMetric::silhouette ? "silhouette" : "border"},
      {"threshold", job.settings.threshold},
      {"views", job.views.size()},
      {"truth",
       {{"from", job.views.front().truth.from}, {"exact", job.views.front().truth.exact}, {"bound_px", job.views.front().truth.bound_px}}}};
  if (answer.chosen) {
    const PlanTrial& chosen = answer.trials[*answer.chosen];
    json["chosen"] = trial_json(answer, chosen, metric);
    json["predicted_px"] = number_or_null(chosen.predicted.expected.of(metric));
    json["measured_px"] = number_or_null(chosen.measured.of(metric));
    json["bytes"] = chosen.bytes;
    json["time_ms"] = chosen.time_ms();
    if (answer.all_series[chosen.series].local) {
      if (answer.all_series[chosen.series].by_tolerance) {
        json["uniform_triangles"] = answer.uniform ? Json(answer.trials[*answer.uniform].triangles) : Json();
        json["curvature_triangles"] = answer.curvature_triangles;
      }
      json["uniform_bytes"] = answer.uniform_bytes > 0 ? Json(answer.uniform_bytes) : Json();
      json["curvature_bytes"] = answer.curvature_bytes;
    }
    json["finest"] = trial_json(answer, answer.finest, metric);
    json["finest"]["built"] = answer.finest_was_built;
  } else {
    json["chosen"] = nullptr;
  }
  json["rejected"] = Json::array();
  for (size_t k = 0; k < answer.trials.size(); ++k) {
    if (!answer.chosen || k != *answer.chosen) json["rejected"].push_back(trial_json(answer, answer.trials[k], metric));
  }
  json["floor_px"] = number_or_null(answer.floor.px());
  json["doubt"] = answer.doubt;
  json["summary"] = plan_sentences(answer, job.settings);
  return json;
}

}  // namespace limn
