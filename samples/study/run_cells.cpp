#include "samples/study/run_cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <new>

#include "raymarch/image_io.h"
#include "raymarch/measured_border.h"
#include "raymarch/polygons.h"
#include "samples/compare/panels.h"
#include "samples/empty_picture.h"
#include "samples/study/run_batches.h"
#include "samples/study/study_files.h"
#include "samples/study/study_reference.h"
#include "sdf/error.h"

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

// The run of one batch of views.
struct Runner {
  const StudyWork& work;
  CostLedger& ledger;
  StudyRecord& record;
  CellRows& rows;
  ProgressBar& bar;
  StudyJournal& journal;
  StudyReference& reference;
  size_t done = 0;

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

  void fail(const std::vector<size_t>& cells, const std::string& reason) {
    for (const size_t index : cells) {
      StudyRow row = row_of(work.study, work.study.cells[index]);
      row.failed = reason;
      keep({row});
    }
  }

  void run_model(std::vector<CellGroup>::const_iterator first, std::vector<CellGroup>::const_iterator last) {
    const StudyModel& planned = work.study.models[first->model];
    const auto refuse = [&](const std::string& reason) {
      ledger.drop("build " + planned.surface, planned.cost.build_ms);
      for (auto group = first; group != last; ++group) {
        drop_group(*group);
        fail(group->cells, reason);
      }
    };
    if (!planned.refused.empty()) return refuse(planned.refused);
    std::optional<SceneModel> model;
    const auto start = Clock::now();
    try {
      model = build_model(work.study.scene, planned.settings);
    } catch (const InputError& error) {
      return refuse(reason_of(error));
    } catch (const std::bad_alloc&) {
      return refuse("out of memory");
    }
    ledger.done("build " + planned.surface, planned.cost.build_ms, ms_since(start));
    for (auto group = first; group != last; ++group) run_group(*model, *group);
  }

  void drop_group(const CellGroup& group) {
    const StudyModel& planned = work.study.models[group.model];
    ledger.drop("trace " + planned.surface, work.study.looks() * planned.cost.trace_ms);
    ledger.drop("measure " + planned.surface, work.study.measure_ms() * static_cast<double>(group.cells.size()));
  }

  void run_group(const SceneModel& model, const CellGroup& group) {
    const StudyModel& planned = work.study.models[group.model];
    if (work.how.cancelled && work.how.cancelled()) throw Cancelled{};
    Picture& truth_picture = reference.picture(group.view);
    const auto start = Clock::now();
    Seen seen = look(model, work.study, group.view, work.how);
    ledger.done("trace " + planned.surface, work.study.looks() * planned.cost.trace_ms, ms_since(start));
    warn_of_empty(model, group, seen.gbuffer, truth_picture.gbuffer);
    Picture picture;
    picture.gbuffer = seen.gbuffer;
    for (const size_t index : group.cells) {
      if (work.how.cancelled && work.how.cancelled()) throw Cancelled{};
      show_progress();
      run_cell(model, work.study.cells[index], seen, picture, truth_picture);
    }
  }

  // Where the reference shows nothing either it is the view's doing: said once for all models.
  void warn_of_empty(const SceneModel& model, const CellGroup& group, const GBuffer& seen, const GBuffer& reference_seen) {
    const StudyModel& planned = work.study.models[group.model];
    const bool of_view = count_hits(reference_seen).hits == 0;
    for (const std::string& reason : why_empty(work.study.scene, model, work.study.cameras[group.view], count_hits(seen))) {
      std::string text = fmt::format("view {}", group.view);
      if (!of_view) {
        text += ", " + planned.surface;
        for (const auto& [name, value] : planned.parameters) text += fmt::format(" {}={}", name, value);
      }
      text += ": ";
      add_warnings({text + reason}, record);
    }
  }

  void run_cell(const SceneModel& model, const StudyCell& cell, const Seen& seen, Picture& picture, Picture& truth_picture) {
    const StudyMethod& method = work.study.methods[cell.method];
    const TruthOf* truth = method.truth_threshold ? &truth_of(cell.view, *method.truth_threshold) : nullptr;
    const auto start = Clock::now();
    Ink ink = draw(work.study, model, cell.view, cell.method, seen, Frames::in_sequence);
    if (!ink.refused.empty()) {
      drop_cell(cell);
      return fail({static_cast<size_t>(&cell - work.study.cells.data())}, ink.refused);
    }
    const SurfaceInfo info = total(model);
    StudyRow row = row_of(work.study, cell);
    row.resolution = resolution_of(model, work.study.longest_side);
    row.build_ms = info.build_ms;
    row.trace_ms = seen.trace_ms;
    row.border_ms = ink.border_ms;
    row.bytes = info.bytes;
    Ink& reference_ink = reference.ink(cell.view, cell.method);
    std::swap(picture.border, ink.ink);
    std::swap(truth_picture.border, reference_ink.ink);
    std::vector<StudyRow> measured = measure(model, row, truth, picture, truth_picture, seen, ink, reference_ink);
    if (measured.empty()) {
      row.failed = "nothing to measure";
      measured.push_back(row);
    }
    const std::string key = row.key;
    keep(std::move(measured));
    write_thumbnail(key, picture.border, reference_ink.refused.empty() ? truth_picture.border : picture.border);
    std::swap(truth_picture.border, reference_ink.ink);
    ledger.done("measure " + row.surface, work.study.measure_ms(), ms_since(start));
  }

  void drop_cell(const StudyCell& cell) { ledger.drop("measure " + work.study.models[cell.model].surface, work.study.measure_ms()); }

  const TruthOf& truth_of(size_t view, double threshold) {
    const TruthOf& truth = reference.truth(view, threshold);
    const size_t known = record.truths.size();
    add_truths({truth.record}, record);
    // On the disk before the rows that it stands behind.
    if (record.truths.size() > known) write_record(record, work.folder);
    return truth;
  }

  std::vector<StudyRow> measure(const SceneModel& model, const StudyRow& like, const TruthOf* truth, const Picture& picture,
                                const Picture& truth_picture, const Seen& seen, const Ink& ink, const Ink& reference_ink) const {
    const Camera& camera = work.study.cameras[static_cast<size_t>(like.view)];
    MetricInput input{picture, truth_picture, camera};
    BorderCurves curves;
    if (truth != nullptr && truth->truth) {
      MeasuredBorderSettings settings;
      settings.threshold = truth->record.threshold;
      curves = measure_border(model, camera, picture.gbuffer, settings, work.how);
      input.curves = &curves;
      input.truth = &*truth->truth;
      input.model = &model;
    }
    input.moved = ink.moved;
    input.reference_moved = reference_ink.moved;
    input.moved_before = seen.before;
    input.reference_moved_before = reference.before(static_cast<size_t>(like.view));
    std::vector<StudyRow> measured;
    for (const Metric& metric : metrics()) {
      if (!has_subject(metric, input, reference_ink.refused.empty())) continue;
      for (const MetricValue& value : metric.measure(input)) {
        if (std::isnan(value.value)) continue;
        StudyRow row = like;
        row.metric = value.name;
        row.value = value.value;
        row.unit = value.unit;
        measured.push_back(std::move(row));
      }
    }
    return measured;
  }

  void write_thumbnail(const std::string& key, const Image<float>& ink, const Image<float>& truth) const {
    const Image<glm::vec4> small = fitted_difference(difference_picture(ink, truth), ink, truth, kThumbnailPx, kThumbnailPx);
    write_image(small, thumbnail_file(work.folder, key));
  }
};

}  // namespace

void run_cells(const StudyWork& work, CostLedger& ledger, StudyRecord& record, CellRows& rows, ProgressBar& bar) {
  StudyJournal journal(work.folder);
  StudyReference reference(work.study, work.how, ledger);
  Runner runner{work, ledger, record, rows, bar, journal, reference};
  for (const std::vector<CellGroup>& batch : batches_of(work)) {
    for (auto first = batch.begin(); first != batch.end();) {
      const auto last = std::find_if(first, batch.end(), [&](const CellGroup& group) { return group.model != first->model; });
      runner.run_model(first, last);
      first = last;
    }
    reference.clear();
  }
}

}  // namespace limn
