// The judgement as JSON.

#include <cmath>

#include "samples/judge/judge_report.h"
#include "sdf/version.h"

namespace limn {
namespace {

Json place_json(const glm::dvec2& p) { return Json::array({p.x, p.y}); }

Json row_json(const JudgeRow& row) {
  Json json;
  if (row.line_class) json["class"] = name_of(*row.line_class);
  json["visible_px"] = row.line_px;
  json["missed_px"] = row.missed_px;
  json["crowded_px"] = row.crowded_px;
  if (!row.line_class) json["false_px"] = row.false_px;
  json["hidden_px"] = row.hidden_px;
  json["doubled_px"] = row.doubled_px;
  json["chains"] = row.chains;
  json["pieces"] = row.pieces;
  json["gaps"] = row.gaps;
  const Displacement& d = row.displacement;
  json["displacement_px"] = {{"mean_outwards", number_or_null(d.mean)},
                             {"rms", number_or_null(d.rms)},
                             {"p95", number_or_null(d.p95)},
                             {"worst", number_or_null(d.worst)}};
  json["displacement_px"]["worst_at"] = std::isfinite(d.worst) ? place_json(d.worst_at) : Json();
  return json;
}

Json finding_json(const JudgeFinding& finding) {
  Json json = {{"kind", key_of(finding.kind)}};
  json["class"] = finding.line_class ? Json(name_of(*finding.line_class)) : Json();
  json["px"] = place_json(finding.px);
  json["length_px"] = finding.length_px;
  json["distance_px"] = finding.kind == FindingKind::displaced ? Json(finding.distance_px) : Json();
  json["gap"] = finding.gap;
  json["text"] = text_of(finding);
  return json;
}

}  // namespace

Json judge_json(const JudgeReport& report) {
  const Judgement& judgement = report.judgement;
  Json json;
  json["version"] = kVersion;
  json["drawing"] = report.subject.drawing;
  json["against"] = report.subject.against;
  json["size_px"] = {report.subject.width_px, report.subject.height_px};
  json["read_as"] = report.drawing.from;
  json["search_px"] = report.subject.settings.search_px;
  json["bound_px"] = report.graph.bound_px;
  json["drawn_px"] = judgement.drawn_px;
  json["strokes"] = judgement.strokes;
  const InkWidth& width = judgement.width;
  json["ink_width_px"] = width.mean_px > 0.0 ? Json{{"mean", width.mean_px}, {"least", width.least_px}, {"most", width.most_px}} : Json();
  json["all"] = row_json(judgement.all);
  json["classes"] = Json::array();
  for (const JudgeRow& row : judgement.classes) json["classes"].push_back(row_json(row));
  const DrawingShift& shift = judgement.shift;
  json["shift"] = {{"px", place_json(shift.px)},
                   {"size_px", shift.size_px},
                   {"standard_error_px", number_or_null(shift.error_px)},
                   {"significant", shift.significant}};
  json["findings"] = Json::array();
  for (const JudgeFinding& finding : judgement.findings) json["findings"].push_back(finding_json(finding));
  json["limits"] = Json::array();
  for (const LimitResult& limit : report.limits)
    json["limits"].push_back({{"name", limit.name}, {"limit", limit.limit}, {"measured", limit.measured}, {"passed", limit.passed}});
  json["notes"] = report.drawing.notes;
  return json;
}

}  // namespace limn
