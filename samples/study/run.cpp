#include "samples/study/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <new>
#include <set>

#include "raymarch/image_io.h"
#include "raymarch/measured_border.h"
#include "raymarch/polygons.h"
#include "samples/compare/panels.h"
#include "samples/study/reference.h"
#include "sdf/error.h"

namespace limn {
namespace {

using Clock = std::chrono::steady_clock;
double ms_since(Clock::time_point start) { return std::chrono::duration<double, std::milli>(Clock::now() - start).count(); }

constexpr double kReferenceBytes = 1.5e9;
constexpr int kThumbnailPx = 320;

/// Cells of one model in one view.
struct Group {
  size_t model = 0, view = 0;
  std::vector<size_t> cells{};
};

std::vector<Group> groups_of(const StudyWork& work) {
  std::vector<Group> groups;
  for (const size_t index : work.cells) {
    const StudyCell& cell = work.study.cells[index];
    if (groups.empty() || groups.back().model != cell.model || groups.back().view != cell.view)
      groups.push_back({cell.model, cell.view, {}});
    groups.back().cells.push_back(index);
  }
  return groups;
}

// As many views at a time as the references of fit in memory; models are built anew for the next ones.
std::vector<std::vector<Group>> batches_of(const StudyWork& work) {
  const auto views = static_cast<size_t>(std::max(1.0, kReferenceBytes / StudyReference::bytes_of_view(work.study)));
  std::map<size_t, std::vector<Group>> batches;
  for (Group& group : groups_of(work)) batches[group.view / views].push_back(std::move(group));
  std::vector<std::vector<Group>> result;
  for (auto& [index, batch] : batches) result.push_back(std::move(batch));
  return result;
}

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

  void run_model(std::vector<Group>::const_iterator first, std::vector<Group>::const_iterator last) {
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

  void drop_group(const Group& group) {
    const StudyModel& planned = work.study.models[group.model];
    ledger.drop("trace " + planned.surface, work.study.looks() * planned.cost.trace_ms);
    ledger.drop("measure " + planned.surface, work.study.measure_ms() * static_cast<double>(group.cells.size()));
  }

  void run_group(const SceneModel& model, const Group& group) {
    const StudyModel& planned = work.study.models[group.model];
    if (work.how.cancelled && work.how.cancelled()) throw Cancelled{};
    Picture& truth_picture = reference.picture(group.view);
    const auto start = Clock::now();
    Seen seen = look(model, work.study.cameras[group.view], work.study.flicker, work.how);
    ledger.done("trace " + planned.surface, work.study.looks() * planned.cost.trace_ms, ms_since(start));
    Picture picture;
    picture.gbuffer = seen.gbuffer;
    for (const size_t index : group.cells) {
      if (work.how.cancelled && work.how.cancelled()) throw Cancelled{};
      show_progress();
      run_cell(model, work.study.cells[index], seen, picture, truth_picture);
    }
  }

  void run_cell(const SceneModel& model, const StudyCell& cell, const Seen& seen, Picture& picture, Picture& truth_picture) {
    const StudyMethod& method = work.study.methods[cell.method];
    const TruthOf* truth = method.truth_threshold ? &truth_of(cell.view, *method.truth_threshold) : nullptr;
    const auto start = Clock::now();
    Ink ink = draw(work.study, model, cell.view, cell.method, seen);
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
    std::vector<StudyRow> measured = measure(model, row, truth, picture, truth_picture, ink, reference_ink);
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
                                const Picture& truth_picture, const Ink& ink, const Ink& reference_ink) const {
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

CostLedger plan_costs(const StudyWork& work) {
  const Study& study = work.study;
  CostLedger ledger;
  std::set<size_t> views;
  std::set<std::pair<size_t, double>> truths;
  for (const std::vector<Group>& batch : batches_of(work)) {
    std::set<size_t> models;
    for (const Group& group : batch) {
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
      const SceneModel model = build_model(work.study.scene, planned->settings);
      ledger.learn("build " + surface, planned->cost.build_ms, ms_since(start));
      start = Clock::now();
      render_gbuffer(model, camera, work.how);
      ledger.learn("trace " + surface, share * planned->cost.trace_ms, ms_since(start));
    } catch (const InputError&) {
      // Its cells will say so.
    }
  }
}

std::int64_t expected_bytes(const StudyWork& work) {
  std::int64_t largest = 0;
  std::set<size_t> views;
  for (const size_t index : work.cells) {
    largest = std::max(largest, work.study.models[work.study.cells[index].model].cost.bytes);
    views.insert(work.study.cells[index].view);
  }
  if (views.empty()) return 0;
  const double held = std::min(kReferenceBytes, static_cast<double>(views.size() + 1) * StudyReference::bytes_of_view(work.study));
  return largest + work.study.reference_cost.bytes + static_cast<std::int64_t>(held);
}

void run_cells(const StudyWork& work, CostLedger& ledger, StudyRecord& record, CellRows& rows, ProgressBar& bar) {
  StudyJournal journal(work.folder);
  StudyReference reference(work.study, work.how, ledger);
  Runner runner{work, ledger, record, rows, bar, journal, reference};
  for (const std::vector<Group>& batch : batches_of(work)) {
    for (auto first = batch.begin(); first != batch.end();) {
      const auto last = std::find_if(first, batch.end(), [&](const Group& group) { return group.model != first->model; });
      runner.run_model(first, last);
      first = last;
    }
    reference.clear();
  }
}

}  // namespace limn
