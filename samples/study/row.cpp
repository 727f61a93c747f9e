#include "samples/study/row.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "samples/reference/reference.h"
#include "samples/spec/surface_setting.h"
#include "samples/study/whole_number.h"
#include "sdf/error.h"

namespace limn {
namespace {

// What changes along a line of a chart; every other parameter makes another line.
constexpr const char* kResolutionNames[] = {"level", "voxels", "voxel_size", "local"};

bool is_resolution(const std::string& name) {
  return std::find(std::begin(kResolutionNames), std::end(kResolutionNames), name) != std::end(kResolutionNames);
}

std::string parameter_text(const std::string& name, const std::string& value) {
  if (name == "normals") return value == "flat" ? "flat facets" : spaced(value) + " normals";
  if (name == "gradient") return spaced(value) + " gradient";
  if (name == "scheme") return spaced(value);
  return spaced(name) + " " + value;
}

// The shortest text that reads back as the same number.
std::string number_text(double value) { return std::isnan(value) ? "" : fmt::format("{}", value); }

std::string value_of(const std::map<std::string, std::string>& parameters, const std::string& name) {
  const auto found = parameters.find(name);
  return found == parameters.end() ? "" : found->second;
}

/// "rim.threshold" where the row's method is the rim.
std::string value_of(const StudyRow& row, const std::string& column) {
  const size_t dot = column.find('.');
  return column.substr(0, dot) == row.method ? value_of(row.method_parameters, column.substr(dot + 1)) : "";
}

void add_truth_fields(const RowTruth& truth, std::vector<std::string>& fields) {
  const bool known = !truth.from.empty();
  fields.insert(fields.end(), {truth.from, known ? (truth.exact ? "true" : "false") : "", number_text(truth.bound_px)});
}

std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"') out += '"';
    out += c == '\n' || c == '\r' ? ' ' : c;  // one row, one line: what reads lines must not lose count
  }
  return out + "\"";
}

// JSON knows finite numbers only.
Json number_json(double value) {
  if (std::isnan(value)) return nullptr;
  if (std::isinf(value)) return value > 0.0 ? "inf" : "-inf";
  return value;
}

struct LineReader {
  const Json& row;
  std::string place;

  [[noreturn]] void fail(const char* name, const char* expected) const {
    const auto found = row.find(name);
    throw InputError(
        {place, name, found == row.end() ? "" : found->dump(), found == row.end() ? "missing" : "of the wrong type", expected});
  }
  const Json& at(const char* name, const char* expected) const {
    const auto found = row.find(name);
    if (found == row.end()) fail(name, expected);
    return *found;
  }
  std::string text(const char* name) const {
    const Json& value = at(name, "a text");
    if (!value.is_string()) fail(name, "a text");
    return value.get<std::string>();
  }
  double number(const char* name) const {
    const Json& value = at(name, "a number or null");
    if (value.is_number()) return value.get<double>();
    if (value.is_null()) return std::numeric_limits<double>::quiet_NaN();
    if (value == "inf") return std::numeric_limits<double>::infinity();
    if (value == "-inf") return -std::numeric_limits<double>::infinity();
    fail(name, "a number or null");
  }
  template <class Integer>
  Integer integer(const char* name) const {
    const Json& value = at(name, "a whole number");
    const std::optional<Integer> whole = whole_number<Integer>(value);
    if (!whole) fail(name, "a whole number");
    return *whole;
  }
  bool yes_or_no(const char* name) const {
    const Json& value = at(name, "true or false");
    if (!value.is_boolean()) fail(name, "true or false");
    return value.get<bool>();
  }
  std::map<std::string, std::string> parameters(const char* name) const {
    std::map<std::string, std::string> all;
    const Json& object = at(name, "an object of texts");
    if (!object.is_object()) fail(name, "an object of texts");
    for (const auto& [key, value] : object.items()) {
      if (!value.is_string()) fail(name, "an object of texts");
      all[key] = value.get<std::string>();
    }
    return all;
  }
};

}  // namespace

std::string spaced(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

std::string series_of(const StudyRow& row) {
  std::string text = spaced(row.surface);
  for (const auto& [name, value] : row.surface_parameters) {
    if (!is_resolution(name)) text += ", " + parameter_text(name, value);
  }
  return text;
}

std::string resolution_text(const StudyRow& row) {
  std::string text;
  for (const char* name : kResolutionNames) {
    const auto found = row.surface_parameters.find(name);
    if (found == row.surface_parameters.end()) continue;
    const std::string& value = found->second;
    text += (text.empty() ? "" : ", ") + (found->first == "voxels" ? value + " voxels" : spaced(found->first) + " " + value);
  }
  return text;
}

std::string csv_header(const std::vector<std::string>& parameters) {
  std::string text;
  for (const DocumentedKey& column : row_columns()) text.append(text.empty() ? "" : ",").append(column.key);
  for (const std::string& parameter : parameters) text.append(",").append(csv_field(parameter));
  return text;
}

std::string csv_line(const StudyRow& row, const std::vector<std::string>& parameters) {
  std::vector<std::string> fields = {
      row.key, row.scene, std::to_string(row.view), std::to_string(row.width_px), std::to_string(row.height_px), row.surface,
  };
  for (const SurfaceSetting& setting : surface_setting_list()) fields.push_back(value_of(row.surface_parameters, setting.name));
  fields.push_back(value_of(row.surface_parameters, "local"));
  fields.insert(fields.end(), {row.method, number_text(row.truth.threshold), row.metric, number_text(row.value), row.unit});
  fields.push_back(number_text(row.floor));
  add_truth_fields(row.truth, fields);
  for (const double number : {row.resolution, row.time_ms(), row.time_low_ms(), row.time_high_ms(), row.build.median_ms, row.build.low_ms,
                              row.build.high_ms, row.trace.median_ms, row.trace.low_ms, row.trace.high_ms, row.border_ms})
    fields.push_back(number_text(number));
  fields.insert(fields.end(), {std::to_string(row.bytes), row.failed});
  for (const std::string& parameter : parameters) fields.push_back(value_of(row, parameter));
  std::string line;
  for (const std::string& field : fields) line.append(&field == &fields.front() ? "" : ",").append(csv_field(field));
  return line;
}

std::string json_line(const StudyRow& row) {
  Json json = {{"key", row.key},           {"scene", row.scene},         {"view", row.view},
               {"width_px", row.width_px}, {"height_px", row.height_px}, {"surface", row.surface}};
  json["surface_parameters"] = row.surface_parameters;
  json["method"] = row.method;
  json["method_parameters"] = row.method_parameters;
  json["metric"] = row.metric;
  json["value"] = number_json(row.value);
  json["unit"] = row.unit;
  json["floor"] = number_json(row.floor);
  json["threshold"] = number_json(row.truth.threshold);
  if (!row.truth.from.empty()) {
    json["truth"] = row.truth.from;
    json["truth_exact"] = row.truth.exact;
    json["truth_bound_px"] = number_json(row.truth.bound_px);
  }
  json["resolution"] = number_json(row.resolution);
  json["time_ms"] = number_json(row.time_ms());
  json["time_low_ms"] = number_json(row.time_low_ms());
  json["time_high_ms"] = number_json(row.time_high_ms());
  for (const auto& [name, times] : {std::pair("build", &row.build), std::pair("trace", &row.trace)}) {
    json[std::string(name) + "_ms"] = number_json(times->median_ms);
    json[std::string(name) + "_low_ms"] = number_json(times->low_ms);
    json[std::string(name) + "_high_ms"] = number_json(times->high_ms);
  }
  json["border_ms"] = number_json(row.border_ms);
  json["bytes"] = row.bytes;
  if (!row.failed.empty()) json["failed"] = row.failed;
  // A file's name or a reason may hold bytes that are no UTF-8; they must not end a study.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

StudyRow row_from_json(const std::string& line, const std::filesystem::path& file, int line_number) {
  const std::string place = fmt::format("{}:{}", file.string(), line_number);
  const Json json = Json::parse(line, nullptr, false);
  if (!json.is_object()) throw InputError({place, "", line.substr(0, 60), "not a row of a study", "a JSON object on one line"});
  const LineReader read{json, place};
  StudyRow row;
  row.key = read.text("key");
  row.scene = read.text("scene");
  row.view = read.integer<int>("view");
  row.width_px = read.integer<int>("width_px");
  row.height_px = read.integer<int>("height_px");
  row.surface = read.text("surface");
  row.surface_parameters = read.parameters("surface_parameters");
  row.method = read.text("method");
  row.method_parameters = read.parameters("method_parameters");
  row.metric = read.text("metric");
  row.value = read.number("value");
  row.unit = read.text("unit");
  row.floor = read.number("floor");
  row.truth.threshold = read.number("threshold");
  if (json.contains("truth"))
    row.truth = {row.truth.threshold, read.text("truth"), read.yes_or_no("truth_exact"), read.number("truth_bound_px")};
  row.resolution = read.number("resolution");
  row.build = {read.number("build_ms"), read.number("build_low_ms"), read.number("build_high_ms")};
  row.trace = {read.number("trace_ms"), read.number("trace_low_ms"), read.number("trace_high_ms")};
  row.border_ms = read.number("border_ms");
  row.bytes = read.integer<std::int64_t>("bytes");
  if (json.contains("failed")) row.failed = read.text("failed");
  return row;
}

std::filesystem::path thumbnail_file(const std::filesystem::path& folder, const std::string& key) {
  return folder / "cells" / (key + ".png");
}

}  // namespace limn
