// The words of the stability page, and the table for a README.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "samples/spec/flags.h"
#include "samples/stability/stability_page.h"
#include "samples/stability/stability_page_parts.h"

namespace limn {

const char* glyph_of(StabilityOutcome outcome) {
  switch (outcome) {
    case StabilityOutcome::held:
      return "\u2713";
    case StabilityOutcome::degraded:
      return "\u2248";
    case StabilityOutcome::fails_as_expected:
      return "!";
    case StabilityOutcome::wrong:
      return "\u2717";
    case StabilityOutcome::skipped:
      return "\u2013";
  }
  return "";
}

std::string class_of(StabilityOutcome outcome) {
  std::string name = name_of(outcome);
  std::replace(name.begin(), name.end(), ' ', '-');
  return name;
}

int weight_of(StabilityOutcome outcome) {
  constexpr std::array lightest_first = {StabilityOutcome::skipped, StabilityOutcome::held, StabilityOutcome::degraded,
                                         StabilityOutcome::fails_as_expected, StabilityOutcome::wrong};
  return static_cast<int>(std::find(lightest_first.begin(), lightest_first.end(), outcome) - lightest_first.begin());
}

std::string method_name(const std::string& method) { return method.substr(0, method.find(' ')); }

std::string method_parameters(const std::string& method) {
  const size_t space = method.find(' ');
  return space == std::string::npos ? "" : method.substr(space + 1);
}

std::string number_text(const StabilityCell& cell) {
  if (!std::isfinite(cell.number)) return "";
  return fmt::format("{:.4g}{}{}", cell.number, cell.unit.empty() ? "" : " ", cell.unit);
}

std::string short_number(const StabilityCell& cell) { return std::isfinite(cell.number) ? fmt::format("{:.2g}", cell.number) : ""; }

std::string command_of(const StabilityCell& cell) {
  CallText call("stability", "");
  call.add("case", cell.case_name);
  call.add("seed", std::to_string(cell.seed));
  call.add("draws", std::to_string(cell.draw + 1));
  return call.text();
}

std::vector<StabilityMark> stability_marks(const StabilityResults& results) {
  std::vector<StabilityMark> marks;
  std::map<std::array<std::string, 3>, size_t> found;
  const auto heavier = [&](size_t a, size_t b) {
    const StabilityCell &one = results.cells[a], &other = results.cells[b];
    const int weight = weight_of(one.outcome), weight_of_other = weight_of(other.outcome);
    if (weight != weight_of_other) return weight > weight_of_other;
    return std::isfinite(one.number) && !(std::abs(one.number) <= std::abs(other.number));
  };
  for (size_t i = 0; i < results.cells.size(); ++i) {
    const StabilityCell& cell = results.cells[i];
    const auto [place, is_new] = found.try_emplace({cell.case_name, cell.surface, cell.method}, marks.size());
    if (is_new) marks.push_back({cell.case_name, cell.surface, cell.method, {}, i});
    StabilityMark& mark = marks[place->second];
    mark.cells.push_back(i);
    if (heavier(i, mark.worst)) mark.worst = i;
  }
  return marks;
}

std::vector<std::string> stability_sentences(const StabilityResults& results) {
  std::set<std::string> rows, surfaces, methods;
  for (const StabilityCaseText& one : results.cases) rows.insert(one.row);
  for (const StabilityCell& cell : results.cells) {
    surfaces.insert(cell.surface);
    if (!cell.method.empty()) methods.insert(method_name(cell.method));
  }
  const auto of = [&](StabilityOutcome outcome) { return count(results, outcome); };
  const std::int64_t ran = static_cast<std::int64_t>(results.cells.size()) - of(StabilityOutcome::skipped);
  std::vector<std::string> sentences;
  sentences.push_back(
      fmt::format("{} cases from {} ways in which drawing a border can fail, on {} representations and {} methods: {} cells.",
                  results.cases.size(), rows.size(), surfaces.size(), methods.size(), results.cells.size()));
  sentences.push_back(fmt::format("What must hold holds in {} of the {} that could run.", of(StabilityOutcome::held), ran));
  if (of(StabilityOutcome::degraded) > 0)
    sentences.push_back(fmt::format("In {} it is off by a number within a stated outer bound.", of(StabilityOutcome::degraded)));
  if (of(StabilityOutcome::fails_as_expected) > 0)
    sentences.push_back(fmt::format("In {} the method fails as it must, and says so.", of(StabilityOutcome::fails_as_expected)));
  sentences.push_back(of(StabilityOutcome::wrong) > 0 ? fmt::format("{} are wrong.", of(StabilityOutcome::wrong)) : "None is wrong.");
  return sentences;
}

std::string stability_markdown(const StabilityResults& results) {
  std::vector<std::string> rows;
  std::map<std::string, std::string> row_of;
  for (const StabilityCaseText& one : results.cases) {
    row_of[one.name] = one.row;
    if (std::find(rows.begin(), rows.end(), one.row) == rows.end()) rows.push_back(one.row);
  }
  std::map<std::string, std::map<StabilityOutcome, std::int64_t>> counts;
  for (const StabilityCell& cell : results.cells) ++counts[row_of.at(cell.case_name)][cell.outcome];
  std::string text = "| case |", rule = "|---|";
  for (const StabilityOutcome outcome : kStabilityOutcomes) {
    text += fmt::format(" {} |", name_of(outcome));
    rule += "---:|";
  }
  text += "\n" + rule + "\n";
  const auto line = [&](const std::string& name, const auto& number) {
    std::string cells;
    for (const char letter : name) cells += letter == '|' ? std::string("\\|") : std::string(1, letter);
    text += "| " + cells + " |";
    for (const StabilityOutcome outcome : kStabilityOutcomes) {
      const std::int64_t n = number(outcome);
      text += n == 0 ? "  |" : fmt::format(" {} |", n);
    }
    text += "\n";
  };
  for (const std::string& row : rows) line(row, [&](StabilityOutcome outcome) { return counts[row][outcome]; });
  line("**all**", [&](StabilityOutcome outcome) { return count(results, outcome); });
  return text;
}

}  // namespace limn
