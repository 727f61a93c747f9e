#pragma once
// `limn stability`: all cells of a corpus.

#include <filesystem>

#include "raymarch/gbuffer.h"
#include "samples/stability/case.h"
#include "samples/stability/results.h"

namespace limn {

/// The cases that come with the program, in the order of their files' names.
std::vector<StabilityCase> stability_corpus();
/// A case by the name of a built-in one, or by its file. Throws InputError.
StabilityCase find_stability_case(const std::string& name_or_file);

/// How a corpus is run.
struct StabilityRunSettings {
  std::uint64_t seed = 1;                  ///< Of the random parameters.
  std::optional<int> draws{};              ///< Of the random parameters; unset: each case's own.
  std::optional<int> longest_side_px{};    ///< Pictures no larger than this, for tests that must be quick.
  std::vector<std::string> surfaces{};     ///< Empty: each case's own.
  std::vector<std::string> methods{};      ///< Cells of these alone, and none without a method; empty: all.
  std::filesystem::path folder{};          ///< Where pictures go; empty: nowhere.
  ExecutionSettings how{};                 ///< Threads and tiles, where a variant does not set them.
  std::function<void(double)> progress{};  ///< 0..1; may be empty.
};

/// Cells in an order, and with content, that depend on nothing but the cases, the seed and the draws.
StabilityResults run_stability(const std::vector<StabilityCase>& cases, const StabilityRunSettings& settings);

}  // namespace limn
