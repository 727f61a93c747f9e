#include "samples/compare/comparison.h"
#include "samples/spec/parse.h"

namespace limn {
namespace {

Json parameters_json(const ComparedModel& model) {
  Json parameters = Json::object();
  for (const SurfaceDescriptor& kind : surface_kinds()) {
    if (kind.about.name != model.surface.kind) continue;
    for (const std::string& name : kind.settings) {
      if (name == "voxels" && model.surface.voxel_size <= 0.0) parameters["voxels"] = model.surface.voxels;
      if (name == "voxel_size" && model.surface.voxel_size > 0.0) parameters["voxel_size"] = model.surface.voxel_size;
      if (name == "gradient") parameters["gradient"] = model.surface.gradient;
      if (name == "level") parameters["level"] = model.surface.level;
      if (name == "scheme" && model.surface.scheme) parameters["scheme"] = name_of(*model.surface.scheme);
      if (name == "normals" && model.surface.normals) parameters["normals"] = name_of(*model.surface.normals);
    }
  }
  return parameters;
}

/// What went wrong, in building the model and in drawing the border.
std::vector<std::string> notes_of(const Comparison& comparison, const Cell& cell) {
  std::vector<std::string> notes = comparison.model_of(cell).info.warnings;
  notes.insert(notes.end(), cell.notes.begin(), cell.notes.end());
  return notes;
}

Json cell_json(const Comparison& comparison, const Cell& cell) {
  const ComparedModel& model = comparison.model_of(cell);
  Json json = {{"name", cell.name},
               {"surface", model.surface.kind},
               {"details", model.details},
               {"parameters", parameters_json(model)},
               {"method", comparison.method_of(cell).name}};
  if (!cell.skipped.empty()) {
    json["skipped"] = cell.skipped;
    return json;
  }
  json["hits"] = model.counts.hits;
  json["out_of_steps"] = model.counts.out_of_steps;
  if (comparison.with_times) {
    json["build_ms"] = model.info.build_ms;
    json["trace_ms"] = model.trace_ms;
    json["border_ms"] = cell.border_ms;
  }
  json["bytes"] = model.info.bytes;
  json["voxels"] = model.info.voxels;
  json["triangles"] = model.info.triangles;
  json["border_px"] = cell.ink_px;
  json["metrics"] = Json::object();
  for (const auto* values : {&cell.values, &model.values, &cell.truth_values}) {
    for (const MetricValue& value : *values) json["metrics"][value.name] = number_or_null(value.value);
  }
  json["notes"] = notes_of(comparison, cell);
  json["exr"] = model.exr.string();
  return json;
}

Json truth_json(const ExperimentTruth& truth) {
  Json json = {{"threshold", truth.threshold}};
  if (!truth.truth) {
    json["failed"] = truth.failed;
    return json;
  }
  json["from"] = truth.truth->from;
  json["exact"] = truth.truth->exact;
  json["bound_px"] = number_or_null(truth.truth->bound_px);
  json["notes"] = truth.truth->notes;
  return json;
}

void add_rows(const Comparison& comparison, const Cell& cell, Json& rows) {
  const ComparedModel& model = comparison.model_of(cell);
  const Json head = {{"scene", comparison.input_name},
                     {"view", 0},
                     {"cell", cell.name},
                     {"surface", model.surface.kind},
                     {"surface_parameters", parameters_json(model)},
                     {"method", comparison.method_of(cell).words}};
  if (!cell.skipped.empty()) {
    Json row = head;
    row["skipped"] = cell.skipped;
    rows.push_back(row);
    return;
  }
  std::vector<MetricValue> values = {{"border_px", cell.ink_px, "px"}};
  values.insert(values.end(), cell.values.begin(), cell.values.end());
  values.insert(values.end(), model.values.begin(), model.values.end());
  values.insert(values.end(), cell.truth_values.begin(), cell.truth_values.end());
  const std::vector<std::string> notes = notes_of(comparison, cell);
  for (const MetricValue& value : values) {
    Json row = head;
    row["reference"] = comparison.reference().name;
    row["metric"] = value.name;
    row["value"] = number_or_null(value.value);
    row["unit"] = value.unit;
    row["time_ms"] = comparison.with_times ? Json(time_ms_of(comparison, cell)) : Json(nullptr);
    row["bytes"] = model.info.bytes;
    // As time and memory: of the cell, and so on each of its rows, that a row can be judged by itself.
    row["notes"] = notes;
    rows.push_back(row);
  }
}

}  // namespace

Json rows_json(const Comparison& comparison) {
  Json rows = Json::array();
  for (const Cell& cell : comparison.cells) add_rows(comparison, cell, rows);
  return rows;
}

Json comparison_json(const Comparison& comparison, const std::vector<std::filesystem::path>& files) {
  Json cells = Json::array(), reference_cells = Json::array(), names = Json::array();
  for (const Cell& cell : comparison.cells) (cell.model == 0 ? reference_cells : cells).push_back(cell_json(comparison, cell));
  for (const std::filesystem::path& file : files) names.push_back(file.string());
  Json methods = Json::array();
  for (const ComparedMethod& method : comparison.methods) methods.push_back(method.words);
  Json truths = Json::array();
  for (const ExperimentTruth& truth : comparison.truths) truths.push_back(truth_json(truth));
  return {{"input", comparison.input_name},
          {"reference", reference_cells.front()},
          {"reference_words", comparison.reference_words},
          {"methods", methods},
          {"truth", truths},
          {"summary", summary_sentences(comparison)},
          {"reference_cells", reference_cells},
          {"cells", cells},
          {"files", names}};
}

}  // namespace limn
