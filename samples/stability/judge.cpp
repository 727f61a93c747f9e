#include "samples/stability/judge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace limn {
namespace {

bool among(const std::vector<std::string>& names, const std::string& name) {
  return names.empty() || std::any_of(names.begin(), names.end(),
                                      [&](const std::string& one) { return one == "all" || one == name || name.starts_with(one + " "); });
}

/// The last one that is about the cell decides each of its points.
StabilityExpectation expected(const StabilityCase& one, const StabilityCell& cell) {
  StabilityExpectation all;
  for (const StabilityExpectation& expect : one.expectations) {
    if (!among(expect.surfaces, cell.surface) || !among(expect.methods, cell.method)) continue;
    if (expect.bound) all.bound = expect.bound;
    if (expect.outer) all.outer = expect.outer;
    if (expect.fails) all.fails = expect.fails;
    if (!expect.says.empty()) all.says = expect.says;
    if (!expect.refused.empty()) all.refused = expect.refused;
  }
  return all;
}

/// A sentence with these words and a number: without one nobody knows how bad it is.
bool says(const std::vector<std::string>& said, const std::string& words) {
  return std::any_of(said.begin(), said.end(), [&](const std::string& sentence) {
    return sentence.find(words) != std::string::npos &&
           std::any_of(sentence.begin(), sentence.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
  });
}

/// The first that neither the cell's own sentences nor the audit's says.
std::string unsaid(const StabilityEvent& event, const std::vector<std::string>& wanted) {
  for (const std::string& words : wanted) {
    if (!says(event.finding->said, words) && !says(event.audit, words)) return words;
  }
  return {};
}

void judge_refusal(const StabilityExpectation& expect, const std::string& refused, StabilityCell& cell) {
  const bool right = !expect.refused.empty() && refused.find(expect.refused) != std::string::npos;
  cell.outcome = right ? StabilityOutcome::held : StabilityOutcome::wrong;
  cell.message = "refused: " + refused;
  if (!right && !expect.refused.empty()) cell.message += fmt::format(" (must say '{}')", expect.refused);
}

}  // namespace

void judge(const StabilityCase& one, const StabilityEvent& event, StabilityCell& cell) {
  const StabilityExpectation expect = expected(one, cell);
  cell.bound = expect.bound.value_or(one.bound);
  cell.outer = std::max(cell.bound, expect.outer.value_or(expect.bound ? cell.bound : one.outer));
  if (!event.finding) {
    judge_refusal(expect, event.refused, cell);
    return;
  }
  const StabilityFinding& finding = *event.finding;
  cell.number = finding.number;
  cell.message = finding.message;
  cell.said = finding.said;
  const bool held = finding.number <= cell.bound, degraded = finding.number <= cell.outer;
  if (!expect.refused.empty()) {
    cell.outcome = StabilityOutcome::wrong;
    cell.message += fmt::format(" (must be refused with '{}')", expect.refused);
  } else if (held || degraded) {
    cell.outcome = held ? StabilityOutcome::held : StabilityOutcome::degraded;
    std::vector<std::string> wanted = one.says;
    if (!expect.fails) wanted.insert(wanted.end(), expect.says.begin(), expect.says.end());
    if (const std::string words = unsaid(event, wanted); !words.empty()) {
      cell.outcome = StabilityOutcome::wrong;
      cell.message += fmt::format(" (nothing says '{}' with a number)", words);
    }
  } else if (expect.fails && expect.fails->first <= finding.number && finding.number <= expect.fails->second) {
    const std::string words = unsaid(event, expect.says);
    cell.outcome = words.empty() ? StabilityOutcome::fails_as_expected : StabilityOutcome::wrong;
    if (!words.empty()) cell.message += fmt::format(" (fails, and nothing says '{}' with a number)", words);
  } else {
    cell.outcome = StabilityOutcome::wrong;
    if (expect.fails) cell.message += fmt::format(" (expected to fail by {:g} to {:g})", expect.fails->first, expect.fails->second);
  }
}

}  // namespace limn
