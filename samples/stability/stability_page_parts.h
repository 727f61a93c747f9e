#pragma once
// Internal: what the page of `limn stability` is made of.

#include <map>
#include <string>
#include <vector>

#include "samples/stability/results.h"

namespace limn {

/// All draws of one case on one surface by one method: one mark in the matrix.
struct StabilityMark {
  std::string case_name{}, surface{}, method{};
  std::vector<size_t> cells{};  ///< Indices into StabilityResults::cells.
  size_t worst = 0;             ///< Of them, the one that is shown.
};
/// In the order in which the cells stand.
std::vector<StabilityMark> stability_marks(const StabilityResults& results);

/// Told apart without colour: "✓".
const char* glyph_of(StabilityOutcome outcome);
/// As a class and an id: "fails-as-expected".
std::string class_of(StabilityOutcome outcome);
/// How much an outcome weighs: wrong most, skipped least.
int weight_of(StabilityOutcome outcome);
/// "rim" of "rim threshold=0.4", and the rest.
std::string method_name(const std::string& method);
std::string method_parameters(const std::string& method);
/// "4 gaps", "0.004"; empty where nothing was measured.
std::string number_text(const StabilityCell& cell);
/// The same without its unit, short enough for a mark.
std::string short_number(const StabilityCell& cell);
/// The call that runs the cell's case again.
std::string command_of(const StabilityCell& cell);

/// Results in one or several sentences.
std::vector<std::string> stability_sentences(const StabilityResults& results);

std::string stability_matrix_html(const StabilityResults& results, const std::vector<StabilityMark>& marks);
/// What did not hold, worst first, with its reasons.
std::string stability_list_html(const StabilityResults& results, const std::vector<StabilityMark>& marks);

}  // namespace limn
