#include "samples/study/run_cells.h"
#include "samples/experiment/local_request.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <mutex>
#include <string_view>

#include "raymarch/image_io.h"
#include "raymarch/mesh/polygons.h"
#include "samples/experiment/empty_picture.h"
#include "samples/experiment/engine.h"
#include "samples/page/panels.h"
#include "samples/study/run_batches.h"
#include "samples/study/study_files.h"
#include "sdf/error.h"
#include "sdf/output_file.h"

namespace limn {
namespace {

using Clock = std::chrono::steady_clock;
double ms_since(Clock::time_point start) { return std::chrono::duration<double, std::milli>(Clock::now() - start).count(); }

constexpr int kThumbnailPx = 320;

double mean_edge(const Mesh& mesh) {
  double sum = 0.0;
  size_t first = 0;
  for (const std::int32_t size : mesh.face_sizes) {
    for (std::int32_t i = 0; i < size; ++i) {
      const auto at = [&](std::int32_t corner) {
        return mesh.positions[static_cast<size_t>(mesh.corner_vertices[first + static_cast<size_t>(corner)])];
      };
      sum += glm::length(at(i) - at((i + 1) % size));
    }
    first += static_cast<size_t>(size);
  }
  return mesh.corner_vertices.empty() ? 0.0 : sum / static_cast<double>(mesh.corner_vertices.size());
}

// Of several objects the coarsest counts.
double resolution_of(const SceneModel& model, double longest_side) {
  double coarsest = 0.0;
  for (const Surface& surface : model.surfaces) {
    double own = surface.info.voxel_size;
    if (own == 0.0 && surface.polygons) own = mean_edge(surface.polygons->mesh());
    coarsest = std::max(coarsest, own);
  }
  return coarsest > 0.0 && longest_side > 0.0 ? coarsest / longest_side : std::numeric_limits<double>::quiet_NaN();
}

/// Null for a model that is as fine everywhere.
std::shared_ptr<const LocalSettings> local_of(const Study& study, const StudyModel& model) {
  if (!model.local_px) return nullptr;
  std::vector<MethodCall> calls;
  for (const StudyMethod& method : study.methods) calls.push_back(method.call);
  return std::make_shared<const LocalSettings>(local_settings(*model.local_px, false, calls, study.cameras));
}

Experiment experiment_of(const Study& study) {
  Experiment experiment;
  experiment.scene = study.scene;
  experiment.cameras = study.cameras;
  experiment.models.push_back({"reference", study.scene, study.reference, {}});
  for (const StudyModel& model : study.models)
    experiment.models.push_back({model.surface, study.scene, model.settings, model.refused, local_of(study, model)});
  for (const StudyMethod& method : study.methods)
    experiment.methods.push_back({method.call.method->about.name, {method.call}, method.truth_threshold});
  for (const Metric& metric : metrics()) experiment.metrics.push_back(&metric);
  if (study.flicker) experiment.path = kFlickerPath;
  experiment.repeats = kStudyRepeats;
  experiment.share_meshes = true;
  experiment.meshes = study.meshes;
  experiment.reference = study.truth_reference;
  experiment.waiting_bytes = study.waiting_bytes;
  return experiment;
}

TruthRecord record_of(size_t view, const ExperimentTruth& solved) {
  TruthRecord record;
  record.view = static_cast<int>(view);
  record.threshold = solved.threshold;
  record.failed = solved.failed;
  if (!solved.truth) return record;
  record.from = solved.truth->from;
  record.exact = solved.truth->exact;
  record.bound_px = solved.truth->bound_px;
  record.notes = solved.truth->notes;
  return record;
}

RowTruth row_truth_of(const MeasuredCell& cell) {
  RowTruth row;
  if (cell.truth == nullptr) return row;
  row.threshold = cell.truth->threshold;
  if (!cell.truth->truth) return row;
  row.from = cell.truth->truth->from;
  row.exact = cell.truth->truth->exact;
  row.bound_px = cell.truth->truth->bound_px;
  return row;
}

double floor_of(const MeasuredCell& cell, const std::string& value) {
  for (const Measurement& one : cell.floor)
    if (one.value.name == value) return one.value.value;
  return std::numeric_limits<double>::quiet_NaN();
}

// Keeps what the engine measures: rows, journal, thumbnails, and what is left to do.
struct Runner {
  const StudyWork& work;
  CostLedger& ledger;
  StudyRecord& record;
  CellRows& rows;
  ProgressBar& bar;
  StudyJournal& journal;
  ExperimentRun* run = nullptr;
  struct Built {
    Timing build{};
    std::int64_t bytes = 0;
    double resolution = 0.0;
  };
  std::map<size_t, Built> models{};  ///< By the engine's number of the model.
  size_t done = 0;
  std::mutex thumbnails_mutex{};
  std::map<size_t, std::vector<std::byte>> thumbnails{};  ///< PNG files of cells whose rows are not written yet, by the cell's number.

  ExperimentObserver observer() {
    return {.cell_begins = [this] { show_progress(); },
            .built = [this](size_t model, const SceneModel& built, double ms, const Timing& times) { has_built(model, built, ms, times); },
            .refused = [this](auto cells, const std::string& reason) { refuse(cells, reason); },
            .seen =
                [this](size_t model, size_t view, const SceneModel& built, Seen& seen, auto) {
                  has_seen(model, view, built, seen);
                  return std::future<void>();
                },
            .solved = [this](size_t view, const ExperimentTruth& truth, double ms) { has_solved(view, truth, ms); },
            .drawn = [this](const ExperimentCell& cell, const Drawing& drawing,
                            const Drawing& reference) { make_thumbnail(cell.id, drawing, reference); },
            .measured = [this](MeasuredCell& cell) { has_measured(cell); }};
  }

  const StudyModel& planned(size_t model) const { return work.study.models[model - 1]; }  // the engine's first is the reference

  void show_progress() const {
    const double remaining = ledger.remaining_ms(), spent = ledger.spent_ms();
    const std::string what = fmt::format("{}/{}, {} left", done, work.cells.size(), duration_text(remaining));
    if (const auto progress = bar.stage(what)) progress(spent / std::max(1.0, spent + remaining));
  }

  void keep(std::vector<StudyRow> cell) {
    journal.append(cell);
    rows[cell.front().key] = std::move(cell);
    ++done;
    show_progress();
  }

  void fail(size_t cell, const std::string& reason) {
    StudyRow row = row_of(work.study, work.study.cells[cell]);
    row.failed = reason;
    keep({row});
  }

  void has_built(size_t model, const SceneModel& built, double ms, const Timing& times) {
    if (model > 0) models[model] = {times, total(built).bytes, resolution_of(built, work.study.longest_side)};
    if (model == 0)
      ledger.done("reference build", work.study.reference_cost.build_ms, ms);
    else
      ledger.done("build " + planned(model).surface, planned(model).cost.build_ms, ms);
  }

  void refuse(std::span<const ExperimentCell> cells, const std::string& reason) {
    const StudyModel& model = planned(cells.front().model);
    ledger.drop("build " + model.surface, model.cost.build_ms);
    for (size_t i = 0; i < cells.size(); ++i) {
      if (i == 0 || cells[i].view != cells[i - 1].view) ledger.drop("trace " + model.surface, work.study.looks() * model.cost.trace_ms);
      ledger.drop("measure " + model.surface, work.study.measure_ms());
    }
    for (const ExperimentCell& cell : cells) fail(cell.id, reason);
  }

  void has_seen(size_t model, size_t view, const SceneModel& built, const Seen& seen) {
    if (model == 0) return ledger.done("reference trace", work.study.looks() * work.study.reference_cost.trace_ms, seen.all_ms);
    ledger.done("trace " + planned(model).surface, work.study.looks() * planned(model).cost.trace_ms, seen.all_ms);
    warn_of_empty(model, view, built, seen.picture.gbuffer);
  }

  // Where the reference shows nothing either it is the view's doing: said once for all models.
  void warn_of_empty(size_t model, size_t view, const SceneModel& built, const GBuffer& seen) {
    const bool of_view = count_hits(run->reference(view).picture.gbuffer).hits == 0;
    for (const std::string& reason : why_empty(work.study.scene, built, work.study.cameras[view], count_hits(seen))) {
      std::string text = fmt::format("view {}", view);
      if (!of_view) {
        text += ", " + planned(model).surface;
        for (const auto& [name, value] : planned(model).parameters) text += fmt::format(" {}={}", name, value);
      }
      text += ": ";
      add_warnings({text + reason}, record);
    }
  }

  void has_solved(size_t view, const ExperimentTruth& truth, double ms) {
    ledger.done("truth", work.study.truth_ms(), ms);
    const size_t known = record.truths.size();
    add_truths({record_of(view, truth)}, record);
    // On the disk before the rows that it stands behind.
    if (record.truths.size() > known) write_record(record, work.folder);
  }

  void has_measured(const MeasuredCell& cell) {
    const StudyModel& model = planned(cell.cell.model);
    if (!cell.drawing.refused.empty()) {
      ledger.drop("measure " + model.surface, work.study.measure_ms());
      return fail(cell.cell.id, cell.drawing.refused);
    }
    const auto start = Clock::now();
    StudyRow row = row_of(work.study, work.study.cells[cell.cell.id]);
    const Built& of = models.at(cell.cell.model);
    row.resolution = of.resolution;
    row.build = of.build;
    row.trace = cell.seen.trace;
    row.truth = row_truth_of(cell);
    row.border_ms = cell.drawing.picture.border_ms;
    row.bytes = of.bytes;
    std::vector<StudyRow> measured;
    for (const Measurement& one : cell.measurements) {
      if (std::isnan(one.value.value)) continue;
      measured.push_back(row);
      measured.back().metric = one.value.name;
      measured.back().value = one.value.value;
      measured.back().unit = one.value.unit;
      measured.back().floor = floor_of(cell, one.value.name);
    }
    if (measured.empty()) {
      measured.push_back(row);
      measured.back().failed = "nothing to measure";
    }
    keep(std::move(measured));
    const std::vector<std::byte> png = std::move(thumbnails.extract(cell.cell.id).mapped());
    write_whole(thumbnail_file(work.folder, row.key), std::string_view(reinterpret_cast<const char*>(png.data()), png.size()));
    ledger.done("measure " + model.surface, work.study.measure_ms(), cell.measure_ms + ms_since(start));
  }

  /// Any thread. Written after the cell's rows, which it shows to be whole.
  void make_thumbnail(size_t cell, const Drawing& drawing, const Drawing& reference) {
    const Image<float>& ink = drawing.picture.border;
    const Image<float>& truth = reference.refused.empty() ? reference.picture.border : ink;
    std::vector<std::byte> png = encode_png(fitted_difference(difference_picture(ink, truth), ink, truth, kThumbnailPx, kThumbnailPx));
    const std::lock_guard lock(thumbnails_mutex);
    thumbnails.insert_or_assign(cell, std::move(png));
  }
};

}  // namespace

void run_cells(const StudyWork& work, CostLedger& ledger, StudyRecord& record, CellRows& rows, ProgressBar& bar) {
  StudyJournal journal(work.folder, work.study.head.parameters);
  Runner runner{work, ledger, record, rows, bar, journal};
  ExperimentRun run(experiment_of(work.study), work.how, runner.observer());
  runner.run = &run;
  for (const std::vector<CellGroup>& batch : batches_of(work)) {
    std::vector<ExperimentCell> cells;
    for (const CellGroup& group : batch)
      for (const size_t index : group.cells) cells.push_back({group.model + 1, group.view, work.study.cells[index].method, index});
    run.run(cells);
    run.forget_views();
  }
}

}  // namespace limn
