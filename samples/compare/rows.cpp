#include "samples/compare/comparison.h"

namespace limn {
namespace {

Json parameters_json(const Cell& cell) {
  Json parameters = Json::object();
  for (const SurfaceDescriptor& kind : surface_kinds()) {
    if (kind.about.name != cell.surface.kind) continue;
    for (const std::string& name : kind.settings) {
      if (name == "voxels" && cell.surface.voxel_size <= 0.0) parameters["voxels"] = cell.surface.voxels;
      if ((name == "voxel_size" || name == "voxel-size") && cell.surface.voxel_size > 0.0)
        parameters["voxel_size"] = cell.surface.voxel_size;
      if (name == "gradient") parameters["gradient"] = cell.surface.gradient;
      if (name == "level") parameters["level"] = cell.surface.level;
      if (name == "scheme" && cell.surface.scheme) parameters["scheme"] = name_of(*cell.surface.scheme);
      if (name == "normals" && cell.surface.normals) parameters["normals"] = name_of(*cell.surface.normals);
    }
  }
  return parameters;
}

Json cell_json(const Cell& cell) {
  Json json = {{"name", cell.name}, {"surface", cell.surface.kind}, {"details", cell.details}, {"parameters", parameters_json(cell)}};
  if (!cell.skipped.empty()) {
    json["skipped"] = cell.skipped;
    return json;
  }
  json["hits"] = cell.counts.hits;
  json["out_of_steps"] = cell.counts.out_of_steps;
  json["build_ms"] = cell.info.build_ms;
  json["trace_ms"] = cell.trace_ms;
  json["bytes"] = cell.info.bytes;
  json["voxels"] = cell.info.voxels;
  json["triangles"] = cell.info.triangles;
  json["border_px"] = border_area_px(cell);
  json["metrics"] = Json::object();
  for (const MetricValue& value : cell.values) json["metrics"][value.name] = number_or_null(value.value);
  json["notes"] = cell.notes;
  json["exr"] = cell.exr.string();
  return json;
}

}  // namespace

Json rows_json(const Comparison& comparison) {
  Json rows = Json::array();
  for (const Cell& cell : comparison.cells) {
    for (const MetricValue& value : cell.values) {
      rows.push_back({{"scene", comparison.input_name},
                      {"view", 0},
                      {"cell", cell.name},
                      {"surface", cell.surface.kind},
                      {"surface_parameters", parameters_json(cell)},
                      {"method", comparison.method_words},
                      {"reference", comparison.reference.name},
                      {"metric", value.name},
                      {"value", number_or_null(value.value)},
                      {"unit", value.unit},
                      {"time_ms", cell.info.build_ms + cell.trace_ms + cell.border_ms},
                      {"bytes", cell.info.bytes}});
    }
    if (!cell.skipped.empty()) {
      rows.push_back(
          {{"scene", comparison.input_name}, {"view", 0}, {"cell", cell.name}, {"surface", cell.surface.kind}, {"skipped", cell.skipped}});
    }
  }
  return rows;
}

Json comparison_json(const Comparison& comparison, const std::vector<std::filesystem::path>& files) {
  Json cells = Json::array();
  for (const Cell& cell : comparison.cells) cells.push_back(cell_json(cell));
  Json names = Json::array();
  for (const std::filesystem::path& file : files) names.push_back(file.string());
  return {{"input", comparison.input_name},
          {"reference", cell_json(comparison.reference)},
          {"reference_words", comparison.reference_words},
          {"method", comparison.method_words},
          {"summary", summary_sentences(comparison)},
          {"cells", cells},
          {"files", names}};
}

}  // namespace limn
