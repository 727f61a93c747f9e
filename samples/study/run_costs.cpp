// The order of a study's cells, and what they are expected to take.

#include <algorithm>
#include <chrono>
#include <map>
#include <set>

#include "samples/study/run_batches.h"
#include "sdf/error.h"

namespace limn {
namespace {

using Clock = std::chrono::steady_clock;
double ms_since(Clock::time_point start) { return std::chrono::duration<double, std::milli>(Clock::now() - start).count(); }

constexpr double kGBufferBytes = 64.0;
// Peaks of studies of 1 to 16 views of 14,000 to 920,000 pixels, less what their models take (docs/performance.md): in each view its
// pictures and what is measured of them, those after small moves, and its true border; rows, charts and pages.
constexpr double kPixelBytes = 130.0, kMovedPixelBytes = 72.0, kViewBytes = 10e6, kStudyBytes = 90e6;

/// What holding the reference in one view takes.
double bytes_of_view(const Study& study) {
  return study.pixels() * study.looks() * (kGBufferBytes + 8.0 * static_cast<double>(study.methods.size()));
}

std::vector<CellGroup> groups_of(const StudyWork& work) {
  std::vector<CellGroup> groups;
  for (const size_t index : work.cells) {
    const StudyCell& cell = work.study.cells[index];
    if (groups.empty() || groups.back().model != cell.model || groups.back().view != cell.view)
      groups.push_back({cell.model, cell.view, {}});
    groups.back().cells.push_back(index);
  }
  return groups;
}

}  // namespace

std::vector<std::vector<CellGroup>> batches_of(const StudyWork& work) {
  const auto views = static_cast<size_t>(std::max(1.0, kReferenceBytes / bytes_of_view(work.study)));
  std::map<size_t, std::vector<CellGroup>> batches;
  for (CellGroup& group : groups_of(work)) batches[group.view / views].push_back(std::move(group));
  std::vector<std::vector<CellGroup>> result;
  result.reserve(batches.size());
  for (auto& [index, batch] : batches) result.push_back(std::move(batch));
  return result;
}

CostLedger plan_costs(const StudyWork& work) {
  const Study& study = work.study;
  CostLedger ledger;
  std::set<size_t> views;
  std::set<std::pair<size_t, double>> truths;
  for (const std::vector<CellGroup>& batch : batches_of(work)) {
    std::set<size_t> models;
    for (const CellGroup& group : batch) {
      const StudyModel& model = study.models[group.model];
      if (models.insert(group.model).second) ledger.plan("build " + model.surface, model.cost.build_ms);
      if (!model.refused.empty()) continue;
      views.insert(group.view);
      ledger.plan("trace " + model.surface, study.looks() * model.cost.trace_ms);
      ledger.plan("measure " + model.surface, study.measure_ms() * static_cast<double>(group.cells.size()));
      for (const size_t index : group.cells) {
        const StudyMethod& method = study.methods[study.cells[index].method];
        if (method.truth_threshold) truths.insert({group.view, *method.truth_threshold});
      }
    }
  }
  if (views.empty()) return ledger;
  ledger.plan("reference build", study.reference_cost.build_ms);
  ledger.plan("reference trace", study.looks() * study.reference_cost.trace_ms * static_cast<double>(views.size()));
  ledger.plan("truth", study.truth_ms() * static_cast<double>(truths.size()));
  return ledger;
}

void calibrate(const StudyWork& work, CostLedger& ledger) {
  constexpr int kSmaller = 8;
  constexpr double kCheap_ms = 100.0;
  std::map<std::string, const StudyModel*> cheapest;
  for (const size_t index : work.cells) {
    const StudyModel& model = work.study.models[work.study.cells[index].model];
    const StudyModel*& least = cheapest[model.surface];
    if (model.refused.empty() && (least == nullptr || model.cost.build_ms < least->cost.build_ms)) least = &model;
  }
  Camera camera = work.study.cameras.front();
  camera.width_px = std::max(1, camera.width_px / kSmaller);
  camera.height_px = std::max(1, camera.height_px / kSmaller);
  camera.focal_px /= kSmaller;
  camera.pixels_per_unit /= kSmaller;
  const double share = static_cast<double>(camera.width_px) * camera.height_px / work.study.pixels();
  for (const auto& [surface, planned] : cheapest) {
    if (planned == nullptr || planned->cost.build_ms > kCheap_ms) continue;
    try {
      auto start = Clock::now();
      // As in the study, where meshes start from what is found.
      ObjectMeshCache meshes{.kept = {}, .starts = work.study.meshes.starts};
      const SceneModel model = build_model(work.study.scene, planned->settings, &meshes);
      ledger.learn("build " + surface, planned->cost.build_ms, ms_since(start));
      start = Clock::now();
      render_gbuffer(model, camera, work.how);
      ledger.learn("trace " + surface, share * planned->cost.trace_ms, ms_since(start));
    } catch (const InputError&) {
      // Its cells will say so.
    }
  }
}

double bytes_beside_models(const Study& study, double views) {
  const double inks = 8.0 * static_cast<double>(study.methods.size()), moved = study.looks() - 1.0;
  const double in_view = study.pixels() * (kPixelBytes + inks + moved * (kMovedPixelBytes + inks));
  return kStudyBytes + views * kViewBytes + std::min(kReferenceBytes, views * in_view);
}

std::int64_t expected_bytes(const StudyWork& work) {
  std::int64_t largest = 0;
  std::set<size_t> views;
  for (const size_t index : work.cells) {
    largest = std::max(largest, work.study.models[work.study.cells[index].model].cost.bytes);
    views.insert(work.study.cells[index].view);
  }
  if (views.empty()) return 0;
  return largest + work.study.reference_cost.bytes +
         static_cast<std::int64_t>(bytes_beside_models(work.study, static_cast<double>(views.size())) + work.study.waiting_bytes);
}

}  // namespace limn
