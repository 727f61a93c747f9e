#include "samples/stability/results.h"

#include <algorithm>

#include "sdf/error.h"
#include "sdf/version.h"

namespace limn {
namespace {

const StabilityCaseText& case_of(const StabilityResults& results, const std::string& name) {
  const auto found =
      std::find_if(results.cases.begin(), results.cases.end(), [&](const StabilityCaseText& one) { return one.name == name; });
  LIMN_CHECK(found != results.cases.end());
  return *found;
}

Json json_of(const StabilityCaseText& text) {
  return {{"name", text.name},   {"row", text.row},     {"breaks", text.breaks},
          {"holds", text.holds}, {"check", text.check}, {"looks", text.looks}};
}

Json json_of(const StabilityCell& cell, const std::string& row) {
  Json parameters = Json::object();
  for (const auto& [name, value] : cell.parameters) parameters[name] = value;
  return {{"case", cell.case_name},
          {"row", row},
          {"draw", cell.draw},
          {"surface", cell.surface},
          {"method", cell.method},
          {"outcome", name_of(cell.outcome)},
          {"number", number_or_null(cell.number)},
          {"unit", cell.unit},
          {"bound", number_or_null(cell.bound)},
          {"outer", number_or_null(cell.outer)},
          {"message", cell.message},
          {"said", cell.said},
          {"picture", cell.picture},
          {"seed", cell.seed},
          {"parameters", std::move(parameters)}};
}

}  // namespace

const char* name_of(StabilityOutcome outcome) {
  switch (outcome) {
    case StabilityOutcome::held:
      return "held";
    case StabilityOutcome::degraded:
      return "degraded";
    case StabilityOutcome::fails_as_expected:
      return "fails as expected";
    case StabilityOutcome::wrong:
      return "wrong";
    case StabilityOutcome::skipped:
      return "skipped";
  }
  return "";
}

std::int64_t count(const StabilityResults& results, StabilityOutcome outcome) {
  return std::count_if(results.cells.begin(), results.cells.end(), [&](const StabilityCell& cell) { return cell.outcome == outcome; });
}

Json stability_json(const StabilityResults& results) {
  Json document = {
      {"version", kVersion}, {"seed", results.seed}, {"counts", Json::object()}, {"cases", Json::array()}, {"cells", Json::array()}};
  for (const StabilityOutcome outcome : kStabilityOutcomes) document["counts"][name_of(outcome)] = count(results, outcome);
  for (const StabilityCaseText& text : results.cases) document["cases"].push_back(json_of(text));
  for (const StabilityCell& cell : results.cells) document["cells"].push_back(json_of(cell, case_of(results, cell.case_name).row));
  return document;
}

}  // namespace limn
