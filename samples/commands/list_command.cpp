#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "raymarch/border.h"
#include "raymarch/lines.h"
#include "raymarch/look.h"
#include "raymarch/metric.h"
#include "raymarch/surface.h"
#include "samples/commands/command.h"
#include "samples/commands/list_kinds.h"
#include "samples/output/output.h"
#include "samples/reference/parameter_text.h"
#include "samples/reference/reference.h"
#include "samples/scenes/scenes.h"
#include "sdf/error.h"
#include "sdf/level_set.h"
#include "sdf/shape.h"

namespace limn {
namespace {

struct Entry {
  Description about;
  std::vector<std::string> inputs;
  std::vector<Parameter> parameters;
};

std::vector<Entry> list_shapes() {
  std::vector<Entry> entries;
  for (const ShapeDescriptor& shape : shapes()) entries.push_back({shape.about, {}, shape.parameters});
  return entries;
}

std::vector<Entry> list_surfaces() {
  std::vector<Entry> entries;
  for (const SurfaceDescriptor& surface : surface_kinds()) entries.push_back({surface.about, surface.settings, {}});
  return entries;
}

std::vector<Entry> list_gradients() {
  std::vector<Entry> entries;
  for (const GradientDescriptor& gradient : gradients()) {
    Description about = gradient.about;
    about.help += fmt::format("; half width {:.3g} voxels, order {}", gradient.half_width_voxels, gradient.order);
    entries.push_back({about, {}, {}});
  }
  return entries;
}

std::vector<Entry> list_normals() {
  std::vector<Entry> entries;
  for (const Description& one : normal_kinds()) entries.push_back({one, {"mesh"}, {}});
  return entries;
}

std::vector<Entry> list_methods() {
  std::vector<Entry> entries;
  for (const BorderMethod& method : border_methods()) entries.push_back({method.about, method.inputs, method.parameters});
  return entries;
}

std::vector<Entry> list_looks() {
  std::vector<Entry> entries;
  for (const Look& look : looks()) entries.push_back({look.about, {}, {}});
  return entries;
}

std::vector<Entry> list_shadings() {
  std::vector<Entry> entries;
  for (const ShadingDescriptor& shading : shadings()) entries.push_back({shading.about, {}, {}});
  return entries;
}

std::vector<Entry> list_metrics() {
  std::vector<Entry> entries;
  for (const Metric& metric : metrics()) {
    Entry entry{metric.about, {"picture", "reference"}, {}};
    std::string values;
    for (const std::string& value : metric.values) values += (values.empty() ? "" : ", ") + value;
    entry.about.help += "; yields " + values;
    entries.push_back(std::move(entry));
  }
  return entries;
}

std::vector<Entry> list_lines() {
  std::vector<Entry> entries;
  for (const LineClassDescriptor& one : line_classes()) entries.push_back({one.about, {}, {}});
  return entries;
}

std::vector<Entry> list_scenes() {
  std::vector<Entry> entries;
  for (const SceneDescriptor& scene : scenes()) entries.push_back({scene.about, {}, {}});
  return entries;
}

struct Kind {
  const char* name;
  std::vector<Entry> (*entries)();
};
constexpr Kind kKinds[] = {
    {"shapes", list_shapes},   {"surfaces", list_surfaces}, {"gradients", list_gradients}, {"normals", list_normals},
    {"methods", list_methods}, {"metrics", list_metrics},   {"lines", list_lines},         {"scenes", list_scenes},
    {"looks", list_looks},     {"shadings", list_shadings},
};

Json default_json(const Parameter& parameter) {
  const std::vector<double>& values = parameter.default_value;
  if (parameter.kind == ParameterKind::flag) return !values.empty() && values[0] != 0.0;
  if (parameter.kind == ParameterKind::choice) return value_text(parameter, values.at(0));
  if (parameter.kind == ParameterKind::number || parameter.kind == ParameterKind::integer) return number_or_null(values.at(0));
  if (parameter.kind != ParameterKind::list || parameter.group == 1) return Json(values);
  Json groups = Json::array();
  for (size_t i = 0; i < values.size(); i += static_cast<size_t>(parameter.group)) {
    groups.push_back(std::vector<double>(values.begin() + static_cast<std::ptrdiff_t>(i),
                                         values.begin() + static_cast<std::ptrdiff_t>(i) + parameter.group));
  }
  return groups;
}

Json to_json(const Entry& entry) {
  Json parameters = Json::array();
  for (const Parameter& parameter : entry.parameters) {
    Json one = {{"name", parameter.name},
                {"unit", parameter.unit},
                {"default", default_json(parameter)},
                {"min", number_or_null(parameter.min)},
                {"max", number_or_null(parameter.max)},
                {"help", parameter.help}};
    if (!parameter.choices.empty()) one["choices"] = parameter.choices;
    parameters.push_back(std::move(one));
  }
  return {{"name", entry.about.name},
          {"help", entry.about.help},
          {"source", entry.about.source},
          {"inputs", entry.inputs},
          {"parameters", parameters}};
}

std::string to_text(const std::vector<Entry>& entries) {
  std::string text;
  for (const Entry& entry : entries) {
    const bool has_source = !entry.about.source.empty() && entry.about.source != "limn";
    text += fmt::format("{:<16} {}{}\n", entry.about.name, entry.about.help, has_source ? " [" + entry.about.source + "]" : "");
    size_t width = 12;
    for (const Parameter& parameter : entry.parameters) width = std::max(width, parameter.name.size());
    for (const Parameter& parameter : entry.parameters) {
      const std::string unit = parameter.unit.empty() ? "" : " " + parameter.unit;
      text += fmt::format("    {:<{}} {} (default {}{}; {})\n", parameter.name, width, parameter.help, default_text(parameter), unit,
                          range_text(parameter));
    }
  }
  return text;
}

void add_options(CLI::App& app, Options& options) {
  add_kind(app, options);
  add_json(app, options);
}

int run(const Options& options) {
  if (options.kind == "reference" && !options.json) {
    print_text(reference_page());
    return 0;
  }
  std::vector<std::string> known;
  for (const Kind& kind : kKinds) {
    known.emplace_back(kind.name);
    if (options.kind != kind.name) continue;
    const std::vector<Entry> entries = kind.entries();
    if (options.json) {
      Json document = Json::array();
      for (const Entry& entry : entries) document.push_back(to_json(entry));
      print_json(document);
    } else {
      print_text(to_text(entries));
    }
    return 0;
  }
  throw InputError({"", "KIND", options.kind, "nothing of that kind to list", known_names(options.kind, known)});
}

}  // namespace

std::vector<std::string> list_kinds() {
  std::vector<std::string> names;
  for (const Kind& kind : kKinds) names.emplace_back(kind.name);
  names.emplace_back("reference");
  return names;
}

std::vector<std::string> names_of_kind(const std::string& name) {
  std::vector<std::string> names;
  for (const Kind& kind : kKinds) {
    if (name != kind.name) continue;
    for (const Entry& entry : kind.entries()) names.push_back(entry.about.name);
  }
  return names;
}

Command list_command() {
  return {"list",
          "names what there is to choose from: shapes, surfaces, gradients, normals, methods, metrics, lines, scenes, looks, shadings",
          "  limn list shapes\n  limn list methods --json", add_options, run};
}

}  // namespace limn
