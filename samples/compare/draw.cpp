#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "raymarch/image_io.h"
#include "samples/compare/comparison.h"
#include "sdf/error.h"

namespace limn {
namespace {

// The picture is handed back for measuring and then goes: a G-buffer is the largest thing here.
Picture draw_cell(Cell& cell, const Comparison& comparison, const std::filesystem::path& folder, const ExecutionSettings& how,
                  ProgressBar& bar) {
  SurfaceSettings settings = cell.surface;
  settings.progress = bar.stage("building " + cell.title);
  const SceneModel model = build_model(cell.scene, settings);
  ExecutionSettings tracing = how;
  tracing.progress = bar.stage("tracing " + cell.title);
  Picture picture = draw_picture(cell.scene, model, comparison.camera, comparison.picture, tracing);
  if (how.cancelled && how.cancelled()) throw Cancelled{};
  cell.info = total(model);
  cell.trace_ms = picture.trace_ms;
  cell.border_ms = picture.border_ms;
  cell.counts = count_hits(picture.gbuffer);
  cell.notes = cell.info.warnings;
  cell.notes.insert(cell.notes.end(), picture.notes.begin(), picture.notes.end());
  cell.exr = folder / (cell.name + ".exr");
  write_exr(picture, comparison.camera, comparison.call + " [" + cell.name + "]", cell.exr);
  cell.border = picture.border;
  cell.composite = picture.composite;
  return picture;
}

}  // namespace

void draw_comparison(Comparison& comparison, const std::filesystem::path& folder, const ExecutionSettings& how, ProgressBar& bar) {
  const Picture reference = draw_cell(comparison.reference, comparison, folder, how, bar);
  comparison.seen = hit_window(reference.gbuffer);
  for (Cell& cell : comparison.cells) {
    if (!cell.skipped.empty()) continue;
    try {
      const Picture picture = draw_cell(cell, comparison, folder, how, bar);
      for (const Metric& metric : metrics()) {
        const std::vector<MetricValue> values = metric.measure({picture, reference, comparison.camera});
        cell.values.insert(cell.values.end(), values.begin(), values.end());
      }
      if (cell.counts.hits > 0) comparison.seen = merge(comparison.seen, hit_window(picture.gbuffer));
      cell.difference = difference_picture(cell.border, comparison.reference.border);
    } catch (const InputError& error) {
      // What one representation cannot do is part of the answer, not the end of the comparison.
      cell.skipped = error.fault().problem;
      if (!error.fault().expected.empty()) cell.skipped += "; " + error.fault().expected;
    }
  }
}

double value_of(const Cell& cell, const std::string& name) {
  for (const MetricValue& value : cell.values) {
    if (value.name == name) return value.value;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

double border_area_px(const Cell& cell) {
  double area = 0.0;
  for (const float coverage : cell.border.pixels) area += coverage;
  return area;
}

}  // namespace limn
