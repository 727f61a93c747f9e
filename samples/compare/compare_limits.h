#pragma once
// What a comparison lets pass, for pipelines.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "samples/judge/judge_report.h"

namespace limn {

struct Comparison;

/// Beyond which a comparison fails; of every picture that is measured against the reference.
struct CompareLimits {
  std::optional<LengthLimit> differ{};   ///< Border pixels that differ; a share is of the reference's border.
  std::optional<double> displaced_px{};  ///< 95 % of the border lie within, from the true one.
  std::filesystem::path junit{};         ///< Where the results go; empty: nowhere.
};

/// A limit of one picture, and what was measured.
struct CellLimit {
  std::string cell{};  ///< "level_set", "level_set-rim".
  LimitResult result{};
};

/// In the order of the cells. What cannot be measured fails: nobody knows that it is right.
std::vector<CellLimit> check_compare_limits(const Comparison& comparison, const CompareLimits& limits);
/// A line each: "passed: level_set: differ 2.3 % (31 px), limit 5 %".
std::string compare_limits_text(const std::vector<CellLimit>& limits);
Json compare_limits_json(const std::vector<CellLimit>& limits);
/// One test case a limit and picture, failed where it is exceeded.
std::string compare_junit(const Comparison& comparison, const std::vector<CellLimit>& limits);

}  // namespace limn
