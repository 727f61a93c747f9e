// Local models as series of a plan: of meshes each candidate asks for a smaller tolerance than the one before, of level sets for smaller
// voxels, as those that are as fine everywhere.

#include <algorithm>

#include "samples/plan/plan.h"

namespace limn {
namespace {

/// Candidates are whole numbers: thousandths of 1 / px.
constexpr double kCandidatesPerPixel = 1000.0;
/// Tolerances from 4 to 0.031 pixels, whatever the plan's own: what one plan tried serves the next. Triangles grow with the power 0.36 of
/// 1 / tolerance: by 1.28 from candidate to candidate, which is as much as times of single runs differ by. Smaller steps would cost more
/// than they save.
const std::vector<int> kLocalCandidates = {250, 500, 1000, 2000, 4000, 8000, 16000, 32000};
/// Of the tolerance, what 95 % of a border is off: in single views of nine scenes at 300 x 300 pixels 0.43 to 0.66 of 0.25 px, and allowed
/// for more.
constexpr double kExpected = 0.45, kLeast = 0.3, kMost = 1.0;

/// Of the plan's tolerance: what local level sets may be off by, beside what their smallest voxels are.
constexpr double kGridShare = 0.5;
/// Finding where the border runs takes longer than the values of a coarse grid.
constexpr double kGridStart = 4.0;
/// Memory and building of local level sets grow with about this power of the resolution (docs/performance.md).
constexpr double kGridGrowth = 1.3;

double tolerance_of(const ResolutionSeries& series, size_t candidate) { return kCandidatesPerPixel / series.candidates[candidate]; }

LocalSettings local_for(const std::vector<PlanView>& views, const PlanSettings& settings) {
  LocalSettings local;
  for (const PlanView& view : views) local.cameras.push_back(view.camera);
  if (settings.metric == PlanMetric::border) local.thresholds.push_back(settings.threshold);
  return local;
}

bool all_local(const Scene& scene, const SurfaceSettings& settings) {
  const auto has_one = [&](const SceneObject& object) { return why_not_local(object, settings).empty(); };
  return !scene.objects.empty() && std::all_of(scene.objects.begin(), scene.objects.end(), has_one);
}

std::optional<ResolutionSeries> mesh_series(const Scene& scene, const std::vector<PlanView>& views, const PlanSettings& settings) {
  const bool wanted = settings.kinds.empty() || std::find(settings.kinds.begin(), settings.kinds.end(), "mesh") != settings.kinds.end();
  if (!wanted || !all_local(scene, {})) return {};
  ResolutionSeries series;
  series.title = "local mesh, limit normals";
  series.settings.kind = "mesh";
  series.settings.normals = NormalKind::limit;
  series.settings.max_bytes = settings.max_bytes;
  series.by_tolerance = true;
  series.candidates = kLocalCandidates;
  series.local = local_for(views, settings);
  return series;
}

ResolutionSeries grid_series(const ResolutionSeries& uniform, const std::vector<PlanView>& views, const PlanSettings& settings) {
  ResolutionSeries series = uniform;
  series.title = "local " + uniform.title;
  series.guess_ms *= kGridStart;
  series.growth = kGridGrowth;
  series.settings.max_bytes = settings.max_bytes;  // more while it is built than it keeps
  series.local = local_for(views, settings);
  series.local->tolerance_px = kGridShare * settings.tolerance_px;
  return series;
}

}  // namespace

std::vector<ResolutionSeries> local_series(const Scene& scene, const std::vector<PlanView>& views, const PlanSettings& settings,
                                           const std::vector<ResolutionSeries>& uniform) {
  std::vector<ResolutionSeries> all_series;
  if (auto mesh = mesh_series(scene, views, settings)) all_series.push_back(std::move(*mesh));
  for (const ResolutionSeries& series : uniform) {
    if (has_local_bricks(series.settings.kind) && !series.of_file && all_local(scene, series.settings))
      all_series.push_back(grid_series(series, views, settings));
  }
  return all_series;
}

PredictedErrors predict_local_errors(const ResolutionSeries& series, size_t candidate) {
  const auto of = [&](double share) {
    const double px = share * tolerance_of(series, candidate);
    return BorderErrors{px, px, px};
  };
  return {of(kExpected), of(kLeast), of(kMost)};
}

PredictedErrors predict_local_errors(const ResolutionSeries& series, const PredictedErrors& uniform) {
  const auto with = [&](const BorderErrors& errors, double share) {
    const double px = share * series.local->tolerance_px;
    return BorderErrors{std::max(errors.silhouette_px, px), std::max(errors.inner_px, px), std::max(errors.border_px, px)};
  };
  return {with(uniform.expected, kExpected), with(uniform.low, 0.0), with(uniform.high, kMost)};
}

std::shared_ptr<const LocalSettings> ResolutionSeries::local_at(size_t candidate) const {
  if (!local) return nullptr;
  auto result = std::make_shared<LocalSettings>(*local);
  if (by_tolerance) result->tolerance_px = tolerance_of(*this, candidate);
  return result;
}

}  // namespace limn
