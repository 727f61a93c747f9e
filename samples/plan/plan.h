#pragma once
// The coarsest model whose border is right to a tolerance, and the cheapest of these over all representations: predicted from the true
// border's curvature, built, measured against truth together with its coarser neighbour, corrected, until the two stand on either side of
// the tolerance.

#include <optional>
#include <string>
#include <vector>

#include "raymarch/local_model.h"
#include "raymarch/truth.h"
#include "samples/experiment/engine.h"
#include "samples/experiment/error_floor.h"
#include "samples/output/progress.h"

namespace limn {

/// What has to be right.
enum class PlanMetric { border, silhouette };

/// What is asked of a plan.
struct PlanSettings {
  double tolerance_px = 0.5;                       ///< Above 0.
  PlanMetric metric = PlanMetric::border;          ///< What has to be within the tolerance.
  double threshold = 0.4;                          ///< Of the rim.
  std::optional<double> budget_ms{};               ///< Of building and tracing one picture.
  std::optional<std::int64_t> budget_bytes{};      ///< Of the model.
  std::int64_t max_bytes = std::int64_t{4} << 30;  ///< Nothing larger is built.
  bool local = false;                              ///< Local models are tried, too.
  std::vector<std::string> kinds{};                ///< Only these representations; empty: all that have a resolution.
};

/// A representation whose resolution is open, with its resolutions from coarse to fine.
struct ResolutionSeries {
  std::string title{};            ///< "level set, cubic gradient".
  SurfaceSettings settings{};     ///< All but the resolution.
  bool by_level = false;          ///< Candidates are subdivision levels; else voxels along the longest side.
  bool of_file = false;           ///< Candidates are a file's volumes with other voxels; the last is the file as it is.
  bool by_tolerance = false;      ///< Of local meshes: candidates are tolerances, and nothing else of a mesh is open.
  std::vector<int> candidates{};  ///< Rising: levels, voxels along the longest side, or of local meshes 1000 / the tolerance in pixels.
  std::optional<LocalSettings> local{};  ///< Of local models; the tolerance of meshes is the candidate's.
  double growth = 2.0;                   ///< The power of 1 / size that building grows with.
  int normal_order = 2;                  ///< Of the normal's angle, by edge or voxel size.
  double normal_constant = 0.0;          ///< Angle = constant (curvature * size)^order, as far as theory knows.
  double base_size = 1.0;                ///< World size of an edge at level 0, or of a voxel times the number of voxels.
  double guess_ms = 1.0;                 ///< To build the first candidate, as an order of magnitude: the order in which series are tried.
  double fixed_ms = 0.0;  ///< Of that and of every other candidate, what does not grow: finding a shape's cage, as it took just now.

  double size_at(size_t candidate) const;  ///< World: of an edge or a (smallest) voxel; of local meshes in proportion to it.
  /// The settings with the candidate's resolution.
  SurfaceSettings at(size_t candidate) const;
  std::string words_at(size_t candidate) const;  ///< "level 3", "128 voxels", "0.25 px".
  /// What a local model of the candidate is made for; null for other series.
  std::shared_ptr<const LocalSettings> local_at(size_t candidate) const;
};

/// How far a border lies from truth: the distance that 95 % of it keep to, by the metric border_error. The worst over all views.
struct BorderErrors {
  double silhouette_px = 0.0,          ///< Of the silhouette.
      inner_px = 0.0,                  ///< Of the inner border.
      border_px = 0.0;                 ///< Of both together: what studies and comparisons judge by.
  double of(PlanMetric metric) const;  ///< `border`: of both; `silhouette`: of that one.
};

/// Errors that theory expects of a model, and the bounds that they are expected between.
struct PredictedErrors {
  BorderErrors expected{},  ///< The likeliest.
      low{},                ///< At least.
      high{};               ///< At most.
};

/// One candidate, built and measured.
struct PlanTrial {
  size_t series = 0,                                      ///< Index into PlanAnswer::all_series.
      candidate = 0;                                      ///< Index into ResolutionSeries::candidates.
  PredictedErrors predicted{};                            ///< By predict_errors(), the worst view's.
  BorderErrors measured{};                                ///< By measure_errors().
  std::int64_t bytes = 0;                                 ///< Of the model.
  std::int64_t triangles = 0,                             ///< 0 where there are none.
      voxels = 0;                                         ///< The same.
  double build_ms = 0.0,                                  ///< Wall clock.
      trace_ms = 0.0;                                     ///< Mean over the views.
  std::string failed{};                                   ///< Why there are no figures; empty where there are.
  double time_ms() const { return build_ms + trace_ms; }  ///< What the budget is compared with.
};

/// One view of a plan, with the border that models are measured against.
struct PlanView {
  Camera camera{};      ///< Of the picture.
  BorderTruth truth{};  ///< Seen by it.
};

/// What a plan came to.
struct PlanAnswer {
  std::vector<ResolutionSeries> all_series{};  ///< What trials refer to.
  std::vector<PlanTrial> trials{};             ///< In the order in which they were made.
  std::optional<size_t> chosen{};              ///< Index into trials: the fastest that meets tolerance and budget.
  std::optional<size_t> coarser{};             ///< The next coarser one of its series, where there is one.
  std::optional<size_t> best{};                ///< Where nothing was chosen: the nearest to the tolerance.
  PlanTrial finest{};                  ///< Of the chosen series: its last candidate; extrapolated from the trials unless it was one.
  bool finest_was_built = false;       ///< False where `finest` is extrapolated.
  std::optional<size_t> silhouette{};  ///< Trial of the chosen series that is enough for the silhouette alone, where that is a coarser one.
  ErrorFloor floor{};                  ///< What an error can be told from: truth in all views, and what a field itself scores.
  std::string doubt{};                 ///< Why nothing can be called right to the tolerance; empty where it can.
  std::int64_t curvature_triangles = 0,  ///< Where a local mesh was chosen: of a mesh refined by curvature alone to the tolerance.
      curvature_bytes = 0,               ///< Where a local model was chosen: of the one that follows curvature alone.
      uniform_bytes = 0;                 ///< Then, too: of the trial below, else of a level set of as many voxels; 0 where it is too large.
  std::optional<size_t> uniform{};       ///< Then, too: the trial of the coarsest model of its kind, as fine everywhere, that keeps to it.
  size_t views = 1;                      ///< What the answer holds for.
  ObjectMeshCache meshes{};              ///< What models of the scene start from: spares whoever builds one of the trials again.
  std::vector<std::string> notes{};      ///< Series that were given up, and why; what else a person should know.
};

/// The series that a scene can search; empty where nothing of it has a resolution to choose (a mesh that is no cage). `notes` is told what
/// was left out, and why; may be null.
/// `cache`: of build_model, which then starts from the cages that were looked at; may be null.
std::vector<ResolutionSeries> series_of_scene(const Scene& scene, const PlanSettings& settings, std::vector<std::string>* notes = nullptr,
                                              ObjectMeshCache* cache = nullptr);

/// Local models for the views: meshes of tolerances about that of the plan, and a series beside each of `uniform` that is of level sets.
std::vector<ResolutionSeries> local_series(const Scene& scene, const std::vector<PlanView>& views, const PlanSettings& settings,
                                           const std::vector<ResolutionSeries>& uniform);
/// What is expected of a candidate of local meshes.
PredictedErrors predict_local_errors(const ResolutionSeries& series, size_t candidate);
/// The same of local level sets, from what is expected of one that is as fine everywhere.
PredictedErrors predict_local_errors(const ResolutionSeries& series, const PredictedErrors& uniform);

/// What the engine measures for a plan: border_error.
const Metric& plan_metric();
/// Its values as BorderErrors.
BorderErrors errors_of(std::span<const Measurement> measured);
/// The same for a model that is there, without an experiment; `trace_ms` of one picture is added.
BorderErrors measure_errors(const SceneModel& model, const PlanView& view, double threshold, const ExecutionSettings& how,
                            double& trace_ms);

/// `known`: trials of an earlier plan for the same scene, views and threshold (any tolerance), which are not made again.
/// Throws InputError where no series is left.
PlanAnswer make_plan(const Scene& scene, const std::vector<PlanView>& views, const PlanSettings& settings, const ExecutionSettings& how,
                     ProgressBar& bar, const std::vector<PlanTrial>& known = {});

/// The answer in sentences with numbers, the choice first.
std::vector<std::string> plan_sentences(const PlanAnswer& answer, const PlanSettings& settings);

}  // namespace limn
