// The summary, the limits and JUnit XML.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "samples/judge/judge_report.h"
#include "samples/page/html.h"
#include "samples/spec/parse.h"
#include "sdf/error.h"

namespace limn {
namespace {

/// "0.0123"; "-" for no number.
std::string distance_text(double px) { return std::isfinite(px) ? fmt::format("{:.4f}", px) : "-"; }

std::string row_text(const JudgeRow& row) {
  const Displacement& d = row.displacement;
  return fmt::format("{:<13}{:>9.1f}{:>9.2f}{:>9}{:>9.2f}{:>9.2f}{:>6}{:>6}{:>10}{:>9}{:>9}{:>9}\n",
                     row.line_class ? name_of(*row.line_class) : "all", row.line_px, row.missed_px,
                     row.line_class ? "-" : fmt::format("{:.2f}", row.false_px), row.hidden_px, row.doubled_px, row.gaps, row.pieces,
                     distance_text(d.mean), distance_text(d.rms), distance_text(d.p95), distance_text(d.worst));
}

double share_of(double part, double whole) { return whole > 0.0 ? 100.0 * part / whole : part > 0.0 ? 100.0 : 0.0; }

void check_length(const char* name, const std::optional<LengthLimit>& limit, double px, double whole, std::vector<LimitResult>& results) {
  if (!limit) return;
  const double percent = share_of(px, whole);
  results.push_back(
      {name, text_of(*limit), fmt::format("{:.3g} px, {:.3g} %", px, percent), (limit->percent ? percent : px) <= limit->value});
}

}  // namespace

LengthLimit parse_length_limit(const std::string& field, const std::string& text) {
  LengthLimit limit;
  std::string number = text;
  if (number.ends_with("%"))
    limit.percent = true, number.pop_back();
  else if (number.ends_with("px"))
    number.resize(number.size() - 2);
  const char* const expected = "pixels or a share, such as 5px or 1%";
  try {
    limit.value = parse_number_above(field, number, 0.0, true, expected);
  } catch (const InputError&) {
    throw InputError({"", field, text, "no length", expected});
  }
  if (limit.percent && limit.value > 100.0) throw InputError({"", field, text, "out of range", "0% to 100%"});
  return limit;
}

std::string text_of(const LengthLimit& limit) { return fmt::format("{:g} {}", limit.value, limit.percent ? "%" : "px"); }

std::vector<LimitResult> check_judge_limits(const Judgement& judgement, const JudgeLimits& limits) {
  std::vector<LimitResult> results;
  const JudgeRow& all = judgement.all;
  check_length("missed", limits.missed, all.missed_px, all.line_px, results);
  check_length("false", limits.false_ink, all.false_px, judgement.drawn_px, results);
  check_length("hidden", limits.hidden, all.hidden_px, judgement.drawn_px, results);
  check_length("doubled", limits.doubled, all.doubled_px, judgement.drawn_px, results);
  if (limits.displaced_px) {
    const double p95 = all.displacement.p95;
    results.push_back({"displaced", fmt::format("{:g} px", *limits.displaced_px),
                       std::isfinite(p95) ? fmt::format("{:.3g} px (95 % lie within)", p95) : "nothing matches",
                       std::isfinite(p95) ? p95 <= *limits.displaced_px : all.line_px <= 0.0});
  }
  return results;
}

std::string text_of(const JudgeFinding& finding) {
  std::string text = title_of(finding.kind);
  text += ":";
  if (finding.line_class) text += " " + name_of(*finding.line_class) + ",";
  if (finding.kind == FindingKind::displaced) text += fmt::format(" by {:.2f} px,", finding.distance_px);
  text += fmt::format(" {:.1f} px at {:.1f}, {:.1f}", finding.length_px, finding.px.x, finding.px.y);
  if (finding.gap) text += " (a gap)";
  return text;
}

std::string text_of(const DrawingShift& shift) {
  if (!shift.significant) return {};
  return fmt::format("shifted by {:.3f} px ({:.3f} {}, {:.3f} {}), standard error {:.2g} px", shift.size_px, std::fabs(shift.px.x),
                     shift.px.x < 0.0 ? "left" : "right", std::fabs(shift.px.y), shift.px.y < 0.0 ? "up" : "down", shift.error_px);
}

std::string judge_text(const JudgeReport& report) {
  const Judgement& judgement = report.judgement;
  std::string text = fmt::format("{} against {}, {}x{} px\n", report.subject.drawing, report.subject.against, report.subject.width_px,
                                 report.subject.height_px);
  text += fmt::format("{} {}, {:.1f} px", judgement.strokes, report.drawing.from, judgement.drawn_px);
  const InkWidth& width = judgement.width;
  if (width.mean_px > 0.0)
    text += fmt::format(", {:.2f} px wide on average ({:.2f} to {:.2f})", width.mean_px, width.least_px, width.most_px);
  text += "\n\npx           visible   missed    false   hidden  doubled  gaps pieces   mean out      RMS      p95    worst\n";
  text += row_text(judgement.all);
  for (const JudgeRow& row : judgement.classes) text += row_text(row);
  if (const std::string shift = text_of(judgement.shift); !shift.empty()) text += "\n" + shift + "\n";
  const Displacement& d = judgement.all.displacement;
  constexpr double kWorthSaying_px = 0.01;
  if (d.worst > kWorthSaying_px) text += fmt::format("\nfarthest off: {:.4f} px at {:.1f}, {:.1f}\n", d.worst, d.worst_at.x, d.worst_at.y);
  if (judgement.all.crowded_px > 0.0)
    text += fmt::format(
        "\n{:.1f} px of line are too near to others to be told apart in this picture: only whether there is ink was looked at\n",
        judgement.all.crowded_px);
  if (judgement.drawn_px > 0.0 && judgement.all.missed_px > 0.5 * judgement.all.line_px)
    text +=
        "\nmore than half of the lines are missed: the drawing may show another view (another eye, target, field of view or projection)\n";
  constexpr size_t kMostOfKind = 10;
  for (const FindingKind kind : kFindingKinds) {
    size_t count = 0;
    for (const JudgeFinding& finding : judgement.findings) {
      if (finding.kind != kind) continue;
      if (count == 0) text += "\n";
      if (++count <= kMostOfKind) text += text_of(finding) + "\n";
    }
    if (count > kMostOfKind) text += fmt::format("... and {} more\n", count - kMostOfKind);
  }
  if (judgement.findings.empty()) text += "\nno findings\n";
  if (!report.limits.empty()) text += "\n";
  for (const LimitResult& limit : report.limits)
    text += fmt::format("{}: {} {}, limit {}\n", limit.passed ? "passed" : "FAILED", limit.name, limit.measured, limit.limit);
  return text;
}

std::string judge_junit(const JudgeReport& report) {
  const auto failures = std::count_if(report.limits.begin(), report.limits.end(), [](const LimitResult& limit) { return !limit.passed; });
  std::string xml =
      fmt::format("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"limn judge {}\" tests=\"{}\" failures=\"{}\">\n",
                  escaped(report.subject.drawing), report.limits.size(), failures);
  for (const LimitResult& limit : report.limits) {
    xml += fmt::format("<testcase classname=\"{}\" name=\"{} at most {}\"", escaped(report.subject.drawing), limit.name, limit.limit);
    if (limit.passed) {
      xml += "/>\n";
      continue;
    }
    xml += fmt::format("><failure message=\"{} {}, limit {}\">", limit.name, limit.measured, limit.limit);
    for (const JudgeFinding& finding : report.judgement.findings)
      if (key_of(finding.kind) == limit.name) xml += escaped(text_of(finding)) + "\n";
    if (limit.name == "displaced") xml += escaped(text_of(report.judgement.shift)) + "\n";
    xml += "</failure></testcase>\n";
  }
  return xml + "</testsuite>\n";
}

}  // namespace limn
