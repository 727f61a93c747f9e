#include <fmt/format.h>

#include "raymarch/audit.h"
#include "raymarch/look.h"
#include "raymarch/metric.h"
#include "raymarch/surface.h"
#include "samples/reference/parameter_text.h"
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

std::string entry(const Description& about, const std::string& more, std::span<const Parameter> parameters) {
  const std::string source = about.source.empty() || about.source == "limn" ? std::string() : fmt::format(" ({})", about.source);
  std::string text =
      fmt::format("\n**`{}`**: {}{}.{}\n", about.name, about.help, source, more.empty() ? std::string() : fmt::format(" {}", more));
  if (parameters.empty()) return text;
  text.append("\n").append(head({"parameter", "unit", "default", "values", ""}));
  for (const Parameter& one : parameters) text += row({code(one.name), one.unit, default_text(one), range_text(one), one.help});
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
  text += "\n## Normals of meshes\n";
  for (const Description& one : normal_kinds()) text += entry(one, "", {});
  text += "\n## Outline methods\n";
  for (const BorderMethod& one : border_methods()) text += entry(one.about, "Reads " + list_of(one.inputs) + ".", one.parameters);
  text += "\n## Looks\n";
  for (const Look& one : looks()) {
    std::vector<std::string> methods;
    for (const LookInk& ink : one.inks) methods.push_back(ink.method);
    text += entry(one.about, methods.empty() ? "" : "Drawn by " + list_of(methods) + ".", {});
  }
  text += "\n## Shadings\n";
  for (const ShadingDescriptor& one : shadings()) text += entry(one.about, "", {});
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

std::vector<Description> normal_kinds() {
  return {{"flat", "a face's own normal", "limn"},
          {"vertex", "averaged at vertices by corner angle, split at infinitely sharp creases", "Thuermer and Wuethrich 1998"},
          {"limit", "those of the limit surface (cages) or of the field (tessellated shapes)", "Stam 1998; OpenSubdiv"}};
}

std::string reference_page() {
  std::string text = "# Reference\n\n`limn list reference` prints this page from what the program has; a test compares the two.\n";
  text += variants();
  text += "\n## Scene files\n\nTOML; [commands.md](commands.md#scene-files) has an example. `world` is the scene's unit of length.\n\n";
  text += keys(scene_keys(), "table");
  text +=
      "\n## Rows of a study\n\n`rows.csv` and `rows.jsonl`: a row for each metric of each cell. The lines of "
      "rows.jsonl keep what the surface and the method were made with as texts in `surface_parameters` and `method_parameters`.\n\n";
  text += keys(row_columns(), nullptr);
  text +=
      "\n## JSON\n\nWhat the commands print as JSON, and the rows of `compare`. `[]`: of each element; `.*`: names that the text before "
      "them "
      "lists.\n\n";
  text += keys(json_keys(), "command");
  return text;
}

}  // namespace limn
