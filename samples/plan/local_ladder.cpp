// Local meshes as a ladder of a plan: each rung asks for a smaller tolerance than the one before.

#include <algorithm>

#include "samples/plan/plan.h"

namespace limn {
namespace {

/// Rungs are whole numbers: thousandths of 1 / px.
constexpr double kRungsPerPixel = 1000.0;
/// Tolerances from 4 to 0.031 pixels, whatever the plan's own: what one plan tried serves the next. Triangles grow with the power 0.36 of
/// 1 / tolerance: by 1.28 from rung to rung, which is as much as times of single runs differ by. Smaller steps would cost more than they
/// save.
const std::vector<int> kLocalRungs = {250, 500, 1000, 2000, 4000, 8000, 16000, 32000};
/// Of the tolerance, what 95 % of a border is off: in single views of nine scenes at 300 x 300 pixels 0.43 to 0.66 of 0.25 px, and allowed
/// for more.
constexpr double kExpected = 0.45, kLeast = 0.3, kMost = 1.0;

double tolerance_of(const Ladder& ladder, size_t rung) { return kRungsPerPixel / ladder.rungs[rung]; }

}  // namespace

std::optional<Ladder> local_ladder(const Scene& scene, const std::vector<PlanView>& views, const PlanSettings& settings) {
  const bool wanted = settings.kinds.empty() || std::find(settings.kinds.begin(), settings.kinds.end(), "mesh") != settings.kinds.end();
  const auto has_one = [](const SceneObject& object) { return why_not_local(object, {}).empty(); };
  if (!wanted || scene.objects.empty() || !std::all_of(scene.objects.begin(), scene.objects.end(), has_one)) return {};
  Ladder ladder;
  ladder.title = "local mesh, limit normals";
  ladder.settings.kind = "mesh";
  ladder.settings.normals = NormalKind::limit;
  ladder.settings.max_bytes = settings.max_bytes;
  ladder.by_level = false;
  ladder.rungs = kLocalRungs;
  ladder.local.emplace();
  for (const PlanView& view : views) ladder.local->cameras.push_back(view.camera);
  if (settings.metric == PlanMetric::border) ladder.local->thresholds.push_back(settings.threshold);
  return ladder;
}

PredictedErrors predict_local_errors(const Ladder& ladder, size_t rung) {
  const auto of = [&](double share) {
    const double px = share * tolerance_of(ladder, rung);
    return BorderErrors{px, px, px};
  };
  return {of(kExpected), of(kLeast), of(kMost)};
}

std::shared_ptr<const LocalSettings> Ladder::local_at(size_t rung) const {
  if (!local) return nullptr;
  auto result = std::make_shared<LocalSettings>(*local);
  result->tolerance_px = tolerance_of(*this, rung);
  return result;
}

}  // namespace limn
