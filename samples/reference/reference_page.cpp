#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "raymarch/audit.h"
#include "raymarch/metric.h"
#include "raymarch/surface.h"
#include "samples/reference/reference.h"
#include "samples/scenes/scenes.h"
#include "samples/stability/checks/check.h"
#include "sdf/shape.h"

namespace limn {
namespace {

std::string row(const std::vector<std::string>& cells) {
  std::string text = "|";
  for (const std::string& one : cells) {
    text += ' ';
    for (const char c : one) {
      if (c == '|') text += '\\';  // a bar would end the cell
      text += c;
    }
    text.append(" |");
  }
  text += "\n";
  return text;
}

std::string head(const std::vector<std::string>& names) {
  std::string text = row(names);
  text += "|";
  for (size_t i = 0; i < names.size(); ++i) text.append(3, '-').append("|");
  text += "\n";
  return text;
}

std::string code(std::string_view text) { return text.empty() ? "" : fmt::format("`{}`", text); }

std::string default_of(const Parameter& parameter) {
  std::string text;
  for (const double value : parameter.default_value) {
    if (!text.empty()) text += ", ";
    if (text.size() > 40) return text + "…";
    text += parameter.kind == ParameterKind::flag     ? (value != 0.0 ? "true" : "false")
            : parameter.kind == ParameterKind::choice ? parameter.choices.at(static_cast<size_t>(value))
                                                      : fmt::format("{}", value);
  }
  return text;
}

std::string range_of(const Parameter& parameter) {
  if (!parameter.choices.empty()) {
    std::string text = parameter.choices.front();
    for (size_t i = 1; i < parameter.choices.size(); ++i) text.append(", ").append(parameter.choices[i]);
    return text;
  }
  if (parameter.kind == ParameterKind::flag) return "true, false";
  const bool below = std::isfinite(parameter.min), above = std::isfinite(parameter.max);
  if (below && above) return fmt::format("{:g} to {:g}", parameter.min, parameter.max);
  return below ? fmt::format("from {:g}", parameter.min) : above ? fmt::format("up to {:g}", parameter.max) : "any";
}

std::string entry(const Description& about, const std::string& more, std::span<const Parameter> parameters) {
  const std::string source = about.source.empty() || about.source == "limn" ? std::string() : fmt::format(" ({})", about.source);
  std::string text =
      fmt::format("\n**`{}`**: {}{}.{}\n", about.name, about.help, source, more.empty() ? std::string() : fmt::format(" {}", more));
  if (parameters.empty()) return text;
  text.append("\n").append(head({"parameter", "unit", "default", "values", ""}));
  for (const Parameter& one : parameters) text += row({code(one.name), one.unit, default_of(one), range_of(one), one.help});
  return text;
}

std::string list_of(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + code(name);
  return text;
}

std::string variants() {
  std::string text = "\n## Shapes\n";
  for (const ShapeDescriptor& one : shapes()) text += entry(one.about, "", one.parameters);
  text += "\n## Surfaces\n";
  for (const SurfaceDescriptor& one : surface_kinds())
    text += entry(one.about, one.settings.empty() ? "" : "Reads " + list_of(one.settings) + ".", {});
  text += "\n## Gradients\n";
  for (const GradientDescriptor& one : gradients())
    text += entry(one.about, fmt::format("Half width {:.3g} voxels, order {}.", one.half_width_voxels, one.order), {});
  text += "\n## Outline methods\n";
  for (const BorderMethod& one : border_methods()) text += entry(one.about, "Reads " + list_of(one.inputs) + ".", one.parameters);
  text += "\n## Metrics\n";
  for (const Metric& one : metrics()) text += entry(one.about, "Yields " + list_of(one.values) + ".", {});
  text += "\n## Scenes\n";
  for (const SceneDescriptor& one : scenes()) text += entry(one.about, "", {});
  text += "\n## Checks of inputs\n";
  for (const AuditCheck& one : audit_checks()) text += entry(one.about, "", {});
  text += "\n## Checks of stability\n";
  for (const StabilityCheck& one : stability_checks()) text += entry(one.about, "In " + one.unit + ".", one.parameters);
  return text;
}

std::string keys(std::span<const DocumentedKey> all, const char* place) {
  std::string text = place != nullptr ? head({place, "key", "unit", ""}) : head({"column", "unit", ""});
  for (const DocumentedKey& one : all) {
    if (place != nullptr)
      text += row({std::string(one.where), code(one.key), std::string(one.unit), std::string(one.help)});
    else
      text += row({code(one.key), std::string(one.unit), std::string(one.help)});
  }
  return text;
}

}  // namespace

std::string reference_page() {
  std::string text = "# Reference\n\n`limn list reference` prints this page from what the program has; a test compares the two.\n";
  text += variants();
  text += "\n## Scene files\n\nTOML; [commands.md](commands.md#scene-files) has an example. `world` is the scene's unit of length.\n\n";
  text += keys(scene_keys(), "table");
  text += "\n## Rows of a study\n\n`rows.csv` and `rows.jsonl`: a row for each metric of each cell.\n\n";
  text += keys(row_columns(), nullptr);
  text +=
      "\n## JSON\n\nWhat the commands print as JSON, and the rows of `compare`. `[]`: of each element; `.*`: names that the text before "
      "them "
      "lists.\n\n";
  text += keys(json_keys(), "command");
  return text;
}

}  // namespace limn
