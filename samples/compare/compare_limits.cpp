#include "samples/compare/compare_limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "samples/compare/comparison.h"
#include "samples/page/html.h"

namespace limn {
namespace {

LimitResult check_differ(const Comparison& comparison, const Cell& cell, const LengthLimit& limit) {
  const double differ = value_of(comparison, cell, "pixels_differ"), border = comparison.reference_of(cell).ink_px;
  const double share = border > 0.0 ? 100.0 * differ / border : (differ > 0.0 ? 100.0 : 0.0);
  return {"differ", text_of(limit), fmt::format("{:.3g} % ({:.0f} px)", share, differ), (limit.percent ? share : differ) <= limit.value};
}

/// The silhouette alone, of methods whose ink does not end at a threshold.
LimitResult check_displaced(const Comparison& comparison, const Cell& cell, double limit_px) {
  const double border = value_of(comparison, cell, "border_error_p95");
  const bool is_border = std::isfinite(border);
  const double p95 = is_border ? border : value_of(comparison, cell, "silhouette_displacement_p95");
  const std::string what = is_border ? "95 % of the border lie within" : "95 % of the silhouette lie within";
  return {"displaced", fmt::format("{:g} px", limit_px), std::isfinite(p95) ? fmt::format("{:.3g} px ({})", p95, what) : "not measured",
          std::isfinite(p95) && p95 <= limit_px};
}

}  // namespace

std::vector<CellLimit> check_compare_limits(const Comparison& comparison, const CompareLimits& limits) {
  std::vector<CellLimit> results;
  for (const Cell& cell : comparison.cells) {
    if (!comparison.is_measured(cell)) continue;
    if (limits.differ) results.push_back({cell.name, check_differ(comparison, cell, *limits.differ)});
    if (limits.displaced_px) results.push_back({cell.name, check_displaced(comparison, cell, *limits.displaced_px)});
  }
  return results;
}

std::string compare_limits_text(const std::vector<CellLimit>& limits) {
  std::string text;
  for (const CellLimit& one : limits)
    text += fmt::format("{}: {}: {} {}, limit {}\n", one.result.passed ? "passed" : "FAILED", one.cell, one.result.name,
                        one.result.measured, one.result.limit);
  return text;
}

Json compare_limits_json(const std::vector<CellLimit>& limits) {
  Json json = Json::array();
  for (const CellLimit& one : limits)
    json.push_back({{"cell", one.cell},
                    {"name", one.result.name},
                    {"limit", one.result.limit},
                    {"measured", one.result.measured},
                    {"passed", one.result.passed}});
  return json;
}

std::string compare_junit(const Comparison& comparison, const std::vector<CellLimit>& limits) {
  const auto failures = std::count_if(limits.begin(), limits.end(), [](const CellLimit& one) { return !one.result.passed; });
  const std::string input = escaped(comparison.input_name);
  std::string xml =
      fmt::format("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"limn compare {}\" tests=\"{}\" failures=\"{}\">\n", input,
                  limits.size(), failures);
  for (const CellLimit& one : limits) {
    const LimitResult& result = one.result;
    xml += fmt::format("<testcase classname=\"{} {}\" name=\"{} at most {}\"", input, escaped(one.cell), result.name, result.limit);
    xml += result.passed ? "/>\n"
                         : fmt::format("><failure message=\"{} {}, limit {}\"/></testcase>\n", result.name, result.measured, result.limit);
  }
  return xml + "</testsuite>\n";
}

}  // namespace limn
