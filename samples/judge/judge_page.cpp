// The page of `limn judge`: one file with everything in it, that asks for nothing and no one.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "samples/judge/judge_report.h"
#include "samples/page/html.h"
#include "samples/page/page_assets.h"
#include "sdf/version.h"

namespace limn {
namespace {

/// Findings that are enlarged, of each kind.
constexpr size_t kMostEnlarged = 6;

constexpr const char* kHead =
    "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width, "
    "initial-scale=1\">\n<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'\">\n"
    "<title>limn judge</title>\n<style>\n";

constexpr const char* kStyle = R"css(
.over { display: block; width: 100%; height: auto; background: #fff; border: 1px solid var(--line); border-radius: 8px; }
.line, .behind, .drawn, .missed, .false, .hidden, .doubled, .displaced {
  fill: none; vector-effect: non-scaling-stroke; stroke-linecap: round; stroke-linejoin: round;
}
.line { stroke: #7ab8ff; stroke-width: 5px; }
.behind { stroke: #c9c9c9; stroke-width: 1.5px; stroke-dasharray: 2 4; }
.drawn { stroke: #1a1a1a; stroke-width: 1.2px; }
.missed { stroke: #d0021b; stroke-width: 4px; }
.false { stroke: #f08c00; stroke-width: 4px; }
.hidden { stroke: #8e24aa; stroke-width: 4px; }
.doubled { stroke: #00897b; stroke-width: 4px; }
.displaced { stroke: #c2185b; stroke-width: 2px; }
.legend i.line, .legend i.drawn, .legend i.behind { background: #7ab8ff; }
.legend i.drawn { background: #1a1a1a; }
.legend i.behind { background: #c9c9c9; }
.legend i.missed { background: #d0021b; }
.legend i.false { background: #f08c00; }
.legend i.hidden { background: #8e24aa; }
.legend i.doubled { background: #00897b; }
.legend i.displaced { background: #c2185b; }
figure { margin: 0; }
.places { display: grid; grid-template-columns: repeat(auto-fill, minmax(260px, 1fr)); gap: 16px; padding: 0; margin: 0; list-style: none; }
.failed { color: var(--warn); font-weight: 600; }
)css";

void add_path(const std::vector<glm::dvec2>& points, bool closed, const char* kind, std::string& svg) {
  if (points.size() < 2) return;
  svg += fmt::format("<path class=\"{}\" d=\"M", kind);
  for (const glm::dvec2& p : points) svg += fmt::format("{:.2f} {:.2f} ", p.x, p.y);
  svg += closed ? "Z\"/>\n" : "\"/>\n";
}

/// Hidden lines, visible ones, the findings beneath the drawing, the drawing.
std::string layers_svg(const JudgeReport& report) {
  std::string svg = "<g id=\"layers\">\n";
  for (const bool visible : {false, true}) {
    for (const LineEdge& edge : report.graph.edges) {
      if ((edge.invisibility == 0) != visible) continue;
      std::vector<glm::dvec2> points;
      for (const LinePoint& point : edge.points) points.push_back(point.px);
      add_path(points, edge.begin < 0 && edge.end < 0, visible ? "line" : "behind", svg);
    }
  }
  for (const JudgeFinding& finding : report.judgement.findings) add_path(finding.points, false, key_of(finding.kind), svg);
  for (const InkLine& line : report.drawing.lines) add_path(line.points, line.closed, "drawn", svg);
  return svg + "</g>\n";
}

std::string legend_html() {
  std::string html =
      "<p class=\"legend\"><span><i class=\"line\"></i>visible line</span><span><i class=\"behind\"></i>hidden "
      "line</span><span><i class=\"drawn\"></i>drawing</span>";
  for (const FindingKind kind : kFindingKinds) html += fmt::format("<span><i class=\"{}\"></i>{}</span>", key_of(kind), title_of(kind));
  return html + "</p>\n";
}

std::string distance_html(double px) { return std::isfinite(px) ? fmt::format("{:.4f}", px) : "&#8211;"; }

std::string row_html(const JudgeRow& row) {
  const Displacement& d = row.displacement;
  std::string html = fmt::format("<tr><td class=\"text\">{}</td>", row.line_class ? name_of(*row.line_class) : "all");
  html += fmt::format("<td>{:.1f}</td><td>{:.2f}</td><td>{}</td><td>{:.2f}</td><td>{:.2f}</td><td>{}</td><td>{}</td>", row.line_px,
                      row.missed_px, row.line_class ? "&#8211;" : fmt::format("{:.2f}", row.false_px), row.hidden_px, row.doubled_px,
                      row.gaps, row.pieces);
  for (const double px : {d.mean, d.rms, d.p95, d.worst}) html += "<td>" + distance_html(px) + "</td>";
  return html + "</tr>\n";
}

std::string table_html(const Judgement& judgement) {
  std::string html =
      "<div class=\"scroll\"><table><thead><tr><th class=\"text\">Lines<small></small></th><th>Visible<small>px</small></th>"
      "<th>Missed<small>px</small></th><th>False<small>px</small></th><th>Hidden, shown<small>px</small></th>"
      "<th>Doubled<small>px</small></th><th>Gaps<small></small></th><th>Pieces<small></small></th><th>Mean outwards<small>px</small></th>"
      "<th>RMS<small>px</small></th><th>p95<small>px</small></th><th>Worst<small>px</small></th></tr></thead><tbody>\n";
  html += row_html(judgement.all);
  for (const JudgeRow& row : judgement.classes) html += row_html(row);
  return html + "</tbody></table></div>\n";
}

std::string limits_html(const std::vector<LimitResult>& limits) {
  if (limits.empty()) return {};
  std::string html = "<h2>Limits</h2>\n<ul class=\"results\">\n";
  for (const LimitResult& limit : limits)
    html += fmt::format("<li{}>{}: {} {}, limit {}</li>\n", limit.passed ? "" : " class=\"failed\"", limit.passed ? "passed" : "failed",
                        limit.name, limit.measured, limit.limit);
  return html + "</ul>\n";
}

/// A window around the finding, as wide as it is long, within reason.
std::string enlarged_html(const JudgeFinding& finding) {
  const double width = std::clamp(1.5 * finding.length_px, 12.0, 60.0), height = 0.75 * width;
  const std::string text = escaped(text_of(finding));
  return fmt::format(
      "<li><figure><svg class=\"over\" viewBox=\"{:.2f} {:.2f} {:.2f} {:.2f}\" role=\"img\" aria-label=\"{}\"><use href=\"#layers\"/></svg>"
      "<figcaption>{}</figcaption></figure></li>\n",
      finding.px.x - 0.5 * width, finding.px.y - 0.5 * height, width, height, text, text);
}

std::string places_html(const Judgement& judgement) {
  std::string html;
  for (const FindingKind kind : kFindingKinds) {
    size_t count = 0;
    for (const JudgeFinding& finding : judgement.findings)
      if (finding.kind == kind && ++count <= kMostEnlarged) html += enlarged_html(finding);
  }
  // Without findings, the place that lies farthest off.
  const Displacement& d = judgement.all.displacement;
  if (html.empty() && std::isfinite(d.worst)) {
    JudgeFinding worst{.kind = FindingKind::displaced, .px = d.worst_at, .distance_px = d.worst};
    html = enlarged_html(worst);
  }
  return html.empty() ? html : "<h2>Worst places, enlarged</h2>\n<ul class=\"places\">\n" + html + "</ul>\n";
}

std::string list_html(const Judgement& judgement) {
  if (judgement.findings.empty()) return {};
  std::string html = fmt::format("<details><summary>All {} findings</summary><ol>\n", judgement.findings.size());
  for (const JudgeFinding& finding : judgement.findings) html += "<li>" + escaped(text_of(finding)) + "</li>\n";
  return html + "</ol></details>\n";
}

}  // namespace

std::string judge_page(const JudgeReport& report) {
  const JudgeSubject& subject = report.subject;
  const Judgement& judgement = report.judgement;
  std::string html = kHead;
  html.append(kPageStyle).append(kStyle).append("</style>\n</head>\n<body>\n<main>\n");
  html += fmt::format("<h1>{} against {}</h1>\n", escaped(subject.drawing), escaped(subject.against));
  html += fmt::format(
      "<p class=\"lead\">Of {:.1f} px of visible lines the drawing lacks {:.2f} px. Of its {:.1f} px, {:.2f} px are false, "
      "{:.2f} px are hidden lines and {:.2f} px are drawn twice.",
      judgement.all.line_px, judgement.all.missed_px, judgement.drawn_px, judgement.all.false_px, judgement.all.hidden_px,
      judgement.all.doubled_px);
  if (const std::string shift = text_of(judgement.shift); !shift.empty()) html += " It is " + escaped(shift) + ".";
  html += "</p>\n" + limits_html(report.limits) + "<h2>The drawing over the lines</h2>\n" + legend_html();
  html += fmt::format("<svg class=\"over\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"the drawing over the lines\">\n",
                      subject.width_px, subject.height_px);
  html += layers_svg(report) + "</svg>\n" + places_html(judgement) + "<h2>Numbers</h2>\n" + table_html(judgement) + list_html(judgement);
  html += fmt::format(
      "<details><summary>How this was measured</summary><p>The drawing was read as {}. A line and a stroke match where they "
      "are at most {:g} px apart and their directions differ by at most {:g}&#176;. Lengths are measured after a significant "
      "shift is taken out, displacements before. The lines are known to {:g} px. limn {}.</p></details>\n",
      escaped(report.drawing.from), subject.settings.search_px, subject.settings.angle_deg, report.graph.bound_px, kVersion);
  return html + "</main>\n</body>\n</html>\n";
}

}  // namespace limn
