// A comparison as an experiment: one view, every method on every model, finished pictures, and what is kept of them.

#include <algorithm>
#include <array>
#include <cmath>
#include <future>
#include <limits>

#include "raymarch/image_io.h"
#include "raymarch/metric/inked_pixels.h"
#include "raymarch/picture/pixel_lanes.h"
#include "samples/compare/comparison.h"
#include "samples/experiment/empty_picture.h"
#include "samples/experiment/thread_settings.h"
#include "sdf/color.h"
#include "sdf/error.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

Experiment experiment_of(const Comparison& comparison) {
  Experiment experiment;
  experiment.scene = comparison.reference().scene;
  experiment.cameras = {comparison.camera};
  for (const ComparedModel& model : comparison.models)
    experiment.models.push_back({model.title, model.scene, model.surface, model.skipped, model.local});
  for (const ComparedMethod& method : comparison.methods) experiment.methods.push_back({method.name, method.calls, method.truth_threshold});
  for (const Metric& metric : metrics()) {
    const bool of_pictures = metric.subject == MetricSubject::gbuffer || metric.subject == MetricSubject::ink;
    if (of_pictures || metric.about.name.ends_with("_displacement") || metric.about.name == "border_error")
      experiment.metrics.push_back(&metric);
  }
  experiment.picture = comparison.picture;
  experiment.silhouette_of_all = true;
  experiment.reference = comparison.truth_reference;
  experiment.share_meshes = true;
  experiment.meshes = comparison.meshes;
  return experiment;
}

// One picture is a file as `limn render` writes it; several are layers of one file, over the shading without ink: written while they are
// measured, and until the future is there they must stay as they are.
std::future<void> write_layers(const ComparedModel& model, const Comparison& comparison, Picture& seen, std::span<Drawing> drawings) {
  const std::string call = comparison.call + " [" + model.name + "]";
  if (!comparison.is_matrix() && drawings[0].refused.empty()) {
    std::swap(drawings[0].picture.gbuffer, seen.gbuffer);
    write_exr(drawings[0].picture, comparison.camera, call, model.exr);
    std::swap(drawings[0].picture.gbuffer, seen.gbuffer);
    return {};
  }
  std::vector<NamedLayer> layers;
  for (size_t column = 0; column < drawings.size(); ++column) {
    if (drawings[column].refused.empty()) layers.push_back({comparison.methods[column].name, &drawings[column].picture});
  }
  return run_beside([&seen, camera = comparison.camera, call, file = model.exr, layers = std::move(layers)] {
    write_exr(seen, camera, call, file, layers);
  });
}

void skip_model(size_t row, const std::string& reason, Comparison& comparison) {
  comparison.models[row].skipped = reason;
  for (size_t column = 0; column < comparison.methods.size(); ++column) comparison.at(row, column).skipped = reason;
}

// What the engine is told to do with what it made.
struct Keeper {
  Comparison& comparison;
  const std::filesystem::path& folder;
  ProgressBar& bar;

  ExperimentObserver observer() {
    return {.stage = [this](const std::string& what) { return bar.stage(what); },
            .built = [this](size_t row, const SceneModel& model, double, const Timing&) { comparison.models[row].info = total(model); },
            .refused = [this](auto cells, const std::string& reason) { skip_model(cells.front().model, reason, comparison); },
            .seen = [this](size_t row, size_t, const SceneModel& model, Seen& seen,
                           auto drawings) { return keep_seen(row, model, seen, drawings); },
            .solved = [this](size_t, const ExperimentTruth& truth, double) { comparison.truths.push_back(truth); },
            .measured = [this](MeasuredCell& cell) { keep_cell(cell); }};
  }

  std::future<void> keep_seen(size_t row, const SceneModel& model, Seen& seen, std::span<Drawing> drawings) {
    ComparedModel& modelled = comparison.models[row];
    modelled.trace_ms = seen.trace.median_ms;
    modelled.counts = count_hits(seen.picture.gbuffer);
    for (std::string& reason : why_empty(modelled.scene, model, comparison.camera, modelled.counts))
      modelled.info.warnings.push_back(std::move(reason));
    modelled.exr = folder / (modelled.name + ".exr");
    std::future<void> writing = write_layers(modelled, comparison, seen.picture, drawings);
    const Window window = hit_window(seen.picture.gbuffer);
    if (row == 0)
      comparison.seen = window;
    else if (modelled.counts.hits > 0)
      comparison.seen = merge(comparison.seen, window);
    if (const auto progress = bar.stage("measuring " + modelled.title)) progress(0.0);
    return writing;
  }

  void keep_cell(MeasuredCell& done) {
    Cell& cell = comparison.at(done.cell.model, done.cell.method);
    cell.skipped = done.drawing.refused;
    if (!cell.skipped.empty()) return;
    Picture& picture = done.drawing.picture;
    cell.border_ms = picture.border_ms;
    cell.notes = std::move(picture.notes);
    parallel_invoke(
        [&] {
          // A gigabyte of float pictures becomes a quarter of it; the page and the sheet show eight bits anyway.
          cell.composite = encoded(picture.composite);
          picture.composite = {};
        },
        [&] {
          // The other models' ink is measured against the reference's.
          cell.border = done.cell.model == 0 ? picture.border : std::move(picture.border);
          visit_inked(cell.border, cell.border, [&](size_t i) { cell.ink_px += double{cell.border.pixels[i]}; });
        });
    for (const Measurement& one : done.floor) cell.floors.push_back(one.value);
    std::vector<MetricValue>& of_model = comparison.models[done.cell.model].values;
    const bool first = of_model.empty();
    for (Measurement& one : done.measurements) {
      const MetricSubject subject = one.metric->subject;
      if (subject == MetricSubject::gbuffer && !first) continue;
      auto& values = subject == MetricSubject::gbuffer ? of_model : subject == MetricSubject::ink ? cell.values : cell.truth_values;
      values.push_back(std::move(one.value));
    }
  }
};

}  // namespace

void draw_comparison(Comparison& comparison, const std::filesystem::path& folder, const ExecutionSettings& how, ProgressBar& bar) {
  Keeper keeper{comparison, folder, bar};
  ExperimentRun run(experiment_of(comparison), how, keeper.observer());
  comparison.meshes = {};  // the run's now, which lets them go
  for (size_t row = 0; row < comparison.models.size(); ++row) {
    std::vector<ExperimentCell> cells;
    for (size_t column = 0; column < comparison.methods.size(); ++column) cells.push_back({row, 0, column});
    try {
      run.run(cells);
    } catch (const InputError& error) {
      // What one representation cannot do is part of the answer, not the end of the comparison; without a reference there is none.
      if (row == 0) throw;
      skip_model(row, reason_of(error), comparison);
    }
  }
}

Image<glm::vec4> linear_composite(const Cell& cell, const Window& window) {
  auto out = Image<glm::vec4>::unset(window.width, window.height);
  std::array<float, 256> linear_of;
  for (size_t code = 0; code < linear_of.size(); ++code) linear_of[code] = linear_from_srgb(static_cast<float>(code) / 255.0f);
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      const glm::u8vec4& color = cell.composite.at(window.x + x, window.y + y);
      const glm::vec3 linear(linear_of[color.r], linear_of[color.g], linear_of[color.b]);
      const float alpha = static_cast<float>(color.a) / 255.0f;
      out.at(x, y) = glm::vec4(linear * alpha, alpha);
    }
  }
  return out;
}

double value_of(const Comparison& comparison, const Cell& cell, const std::string& name) {
  for (const std::vector<MetricValue>* values : {&cell.values, &comparison.model_of(cell).values, &cell.truth_values}) {
    for (const MetricValue& value : *values) {
      if (value.name == name) return value.value;
    }
  }
  return std::numeric_limits<double>::quiet_NaN();
}

double time_ms_of(const Comparison& comparison, const Cell& cell) {
  const ComparedModel& model = comparison.model_of(cell);
  return model.info.build_ms + model.trace_ms + cell.border_ms;
}

}  // namespace limn
