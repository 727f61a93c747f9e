// Cases down, methods across; and the list of what did not hold.

#include <fmt/format.h>

#include <algorithm>

#include "raymarch/border.h"
#include "samples/page/html.h"
#include "samples/stability/stability_page_parts.h"

namespace limn {
namespace {

constexpr const char* kAlone = "no method";

std::string with_spaces(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

/// "ML" of "mesh_level_set": the initials; of what has one word only the first letter; "level_set" is L.
std::string tag_of(const std::string& surface) {
  if (surface == "level_set") return "L";
  if (surface == "mesh_level_set") return "ML";
  return surface.empty() ? "?" : std::string(1, static_cast<char>(std::toupper(static_cast<unsigned char>(surface.front()))));
}

/// Methods that any mark has: the surfaces themselves first, then in the registry's order.
std::vector<std::string> columns_of(const std::vector<StabilityMark>& marks) {
  std::vector<std::string> known{""}, columns;
  for (const BorderMethod& method : border_methods()) known.push_back(method.about.name);
  for (const StabilityMark& mark : marks) {
    const std::string name = method_name(mark.method);
    if (std::find(known.begin(), known.end(), name) == known.end()) known.push_back(name);
  }
  for (const std::string& name : known) {
    const auto has = [&](const StabilityMark& mark) { return method_name(mark.method) == name; };
    if (std::any_of(marks.begin(), marks.end(), has)) columns.push_back(name);
  }
  return columns;
}

std::string spoken(const StabilityMark& mark, const StabilityCell& cell) {
  std::string text = fmt::format("{}: {} on {}, {}", name_of(cell.outcome), mark.method.empty() ? "the surface itself" : mark.method,
                                 with_spaces(mark.surface), mark.case_name);
  if (const std::string number = number_text(cell); !number.empty()) text += fmt::format(", {}, bound {:.4g}", number, cell.bound);
  if (mark.cells.size() > 1) text += fmt::format(", worst of {} draws", mark.cells.size());
  return text;
}

std::string mark_html(const StabilityResults& results, const StabilityMark& mark, size_t index) {
  const StabilityCell& cell = results.cells[mark.worst];
  const bool quiet = cell.outcome == StabilityOutcome::held || cell.outcome == StabilityOutcome::skipped;
  return fmt::format(
      "<button type=\"button\" class=\"mark {}\" data-mark=\"{}\" data-surface=\"{}\" tabindex=\"-1\" "
      "aria-label=\"{}\"><b>{}</b><i>{}</i>{}"
      "</button>",
      class_of(cell.outcome), index, escaped(mark.surface), escaped(spoken(mark, cell)), glyph_of(cell.outcome), tag_of(mark.surface),
      quiet || short_number(cell).empty() ? "" : "<small>" + short_number(cell) + "</small>");
}

std::string breakable(const std::string& text) {
  std::string html;
  for (const char letter : escaped(text)) {
    html += letter;
    if (letter == '_' || letter == '=') html += "<wbr>";
  }
  return html;
}

/// One method's marks in one case: those with the same parameters stand together under them.
std::string cell_html(const StabilityResults& results, const std::vector<StabilityMark>& marks, const std::string& case_name,
                      const std::string& column) {
  std::vector<std::string> variants;
  std::map<std::string, std::string> inside;
  for (size_t i = 0; i < marks.size(); ++i) {
    if (marks[i].case_name != case_name || method_name(marks[i].method) != column) continue;
    const std::string variant = method_parameters(marks[i].method);
    if (!inside.contains(variant)) variants.push_back(variant);
    inside[variant] += mark_html(results, marks[i], i);
  }
  std::string html =
      fmt::format("<td role=\"cell\"{} data-method=\"{}\">", variants.empty() ? " class=\"empty\"" : "", column.empty() ? kAlone : column);
  for (const std::string& variant : variants) {
    html += "<div class=\"marks\">";
    if (!variant.empty()) html += "<small class=\"variant\">" + breakable(variant) + "</small>";
    html += inside[variant] + "</div>";
  }
  return html + "</td>";
}

std::string row_heading(const StabilityCaseText& one, size_t columns) {
  return fmt::format(
      "<tr class=\"row\" role=\"row\"><th role=\"rowheader\" scope=\"rowgroup\" colspan=\"{}\"><div><strong>{}</strong>"
      "<span><em>breaks</em> {}</span><span><em>must hold</em> {}</span></div></th></tr>\n",
      columns + 1, escaped(one.row), escaped(one.breaks), escaped(one.holds));
}

}  // namespace

std::string stability_matrix_html(const StabilityResults& results, const std::vector<StabilityMark>& marks) {
  const std::vector<std::string> columns = columns_of(marks);
  std::string html =
      "<div class=\"scroll\"><table class=\"matrix\" role=\"table\" aria-label=\"Cases down, methods across\">\n<thead "
      "role=\"rowgroup\"><tr "
      "role=\"row\"><th role=\"columnheader\" scope=\"col\" class=\"text\">case</th>";
  for (const std::string& column : columns) {
    html += fmt::format("<th role=\"columnheader\" scope=\"col\">{}</th>", escaped(column.empty() ? kAlone : column));
  }
  html += "</tr></thead>\n";
  std::vector<std::string> rows;
  for (const StabilityCaseText& one : results.cases) {
    if (std::find(rows.begin(), rows.end(), one.row) == rows.end()) rows.push_back(one.row);
  }
  for (const std::string& row : rows) {
    html += "<tbody role=\"rowgroup\">";
    bool first = true;
    for (const StabilityCaseText& one : results.cases) {
      if (one.row != row) continue;
      if (first) html += row_heading(one, columns.size());
      first = false;
      html += fmt::format(
          "<tr role=\"row\" class=\"case\"><th role=\"rowheader\" scope=\"row\" class=\"text\"><div>{}<small>{}</small></div></th>",
          escaped(with_spaces(one.name)), escaped(one.looks));
      for (const std::string& column : columns) html += cell_html(results, marks, one.name, column);
      html += "</tr>\n";
    }
    html += "</tbody>\n";
  }
  return html + "</table></div>\n";
}

std::string stability_list_html(const StabilityResults& results, const std::vector<StabilityMark>& marks) {
  std::vector<size_t> order;
  for (size_t i = 0; i < marks.size(); ++i) {
    const StabilityOutcome outcome = results.cells[marks[i].worst].outcome;
    if (outcome != StabilityOutcome::held && outcome != StabilityOutcome::skipped) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return weight_of(results.cells[marks[a].worst].outcome) > weight_of(results.cells[marks[b].worst].outcome);
  });
  if (order.empty()) return "<p>Everything held that could run.</p>\n";
  std::string html =
      "<div class=\"scroll\"><table class=\"list\">\n<thead><tr><th class=\"text\" scope=\"col\">outcome</th><th class=\"text\" "
      "scope=\"col\">case</th><th class=\"text\" scope=\"col\">surface</th><th class=\"text\" scope=\"col\">method</th><th "
      "scope=\"col\">number</th><th scope=\"col\">bound</th><th class=\"text\" scope=\"col\">what was found</th></tr></thead>\n<tbody>\n";
  for (const size_t i : order) {
    const StabilityCell& cell = results.cells[marks[i].worst];
    std::string said;
    for (const std::string& sentence : cell.said) said += "<br><q>" + escaped(sentence) + "</q>";
    html += fmt::format(
        "<tr class=\"{0}\"><td class=\"text\"><span class=\"mark {0}\"><b>{1}</b></span> {2}</td><td class=\"text\">{3}</td><td "
        "class=\"text\">{4}</td><td class=\"text\">{5}</td><td>{6}</td><td>{7:.4g}</td><td class=\"text wide\">{8}{9}</td></tr>\n",
        class_of(cell.outcome), glyph_of(cell.outcome), name_of(cell.outcome), escaped(with_spaces(cell.case_name)),
        escaped(with_spaces(cell.surface)), escaped(cell.method.empty() ? kAlone : cell.method), escaped(number_text(cell)), cell.bound,
        escaped(cell.message), said);
  }
  return html + "</tbody></table></div>\n";
}

}  // namespace limn
