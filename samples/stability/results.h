#pragma once
// What `limn stability` found out: one cell for each case, surface and method. results.json is this and nothing else.

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "samples/output/output.h"

namespace limn {

/// held: the property is within its bound. degraded: beyond the bound, within the stated outer one. fails_as_expected: the case says that
/// it must fail here, it does, and the program says so itself. wrong: anything else, and an expected failure that the program keeps quiet
/// about. skipped: the method cannot run on this surface; `message` says why.
enum class StabilityOutcome { held, degraded, fails_as_expected, wrong, skipped };
/// All outcomes, in the order of reports.
inline constexpr std::array kStabilityOutcomes = {StabilityOutcome::held, StabilityOutcome::degraded, StabilityOutcome::fails_as_expected,
                                                  StabilityOutcome::wrong, StabilityOutcome::skipped};
/// "held", "degraded", "fails as expected", "wrong", "skipped".
const char* name_of(StabilityOutcome outcome);

/// A case of the corpus, as its file states it.
struct StabilityCaseText {
  std::string name{};    ///< The file's, without its ending.
  std::string row{};     ///< Of the catalogue: cases that share it belong together.
  std::string breaks{};  ///< What goes wrong where nobody cares for it.
  std::string holds{};   ///< What must hold.
  std::string check{};   ///< How it is looked at.
  std::string looks{};   ///< The check in one line.
};

/// What was found out of one case, surface and method.
struct StabilityCell {
  std::string case_name{};  ///< StabilityCaseText::name.
  int draw = 0;             ///< From 0: which draw of the case's random parameters.
  std::string surface{};    ///< Representation.
  std::string method{};     ///< With the parameters that differ from their defaults; empty: the surface alone was looked at.
  StabilityOutcome outcome = StabilityOutcome::held;         ///< See StabilityOutcome.
  double number = std::numeric_limits<double>::quiet_NaN();  ///< The worst place of all views; NaN where none was measured.
  std::string unit{};                                        ///< "px", "pixels", "deg", "gaps".
  double bound = 0.0;                                        ///< Held up to here.
  double outer = 0.0;                                        ///< Degraded up to here.
  std::string message{};                                     ///< What was found where, or the reason.
  std::vector<std::string> said{};                           ///< Notes, warnings and audit: what the program said of it itself.
  std::string picture{};                                     ///< Of the worst view, relative to results.json; empty: there is none.
  std::uint64_t seed = 0;  ///< `limn stability --case NAME --seed SEED --draws DRAW+1` runs the cell again.
  std::vector<std::pair<std::string, double>> parameters{};  ///< As drawn.
};

/// Everything, in the order of the corpus.
struct StabilityResults {
  std::uint64_t seed = 0;                  ///< That random parameters were drawn from.
  std::vector<StabilityCaseText> cases{};  ///< In the order of the corpus.
  std::vector<StabilityCell> cells{};      ///< By case, then draw, surface and method.
};

/// Cells with that outcome.
std::int64_t count(const StabilityResults& results, StabilityOutcome outcome);

/// {version, seed, counts: {held, …}, cases: [{name, row, breaks, holds, check, looks}], cells: [{case, row, draw, surface, method,
/// outcome, number, unit, bound, outer, message, said, picture, seed, parameters}]}; numbers that are not finite are null.
Json stability_json(const StabilityResults& results);

}  // namespace limn
