#include "samples/compare/compare_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

namespace limn {

std::string heading(const std::string& name) {
  std::string text = name;
  std::replace(text.begin(), text.end(), '_', ' ');
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

std::string counted(double value) {
  std::string digits = fmt::format("{:.0f}", value);
  for (int at = static_cast<int>(digits.size()) - 3; at > 0; at -= 3) digits.insert(static_cast<size_t>(at), 1, ',');
  return digits;
}

std::string share_text(double share) {
  if (share == 0.0) return "none";
  if (share < 0.0001) return "less than 0.01 %";
  return share < 0.1 ? fmt::format("{:.2f} %", 100.0 * share) : fmt::format("{:.0f} %", 100.0 * share);
}

std::string short_number(double value) { return std::abs(value) >= 10.0 ? fmt::format("{:.0f}", value) : fmt::format("{:.2g}", value); }

std::string full_title(const ComparedModel& model) {
  return model.details.empty() ? model.title : model.title + " (" + model.details + ")";
}

std::string cell_title(const Comparison& comparison, const Cell& cell) {
  const ComparedModel& model = comparison.model_of(cell);
  if (!comparison.is_matrix()) return model.title;
  return comparison.method_of(cell).name + " on the " + (cell.model == 0 ? "reference" : model.title);
}

std::vector<std::string> caption_lines(const Comparison& comparison, const Cell& cell) {
  const ComparedModel& model = comparison.model_of(cell);
  std::vector<std::string> lines;
  if (comparison.is_measured(cell)) {
    const double differ = value_of(comparison, cell, "pixels_differ");
    const double area = comparison.reference_of(cell).ink_px;
    lines.push_back(fmt::format("{} border px differ ({})", counted(differ), share_text(differ / std::max(1.0, area))));
    const std::string off = short_border_error(comparison, cell);
    lines.push_back(fmt::format("overlap (IoU) {:.4f}{}{}", value_of(comparison, cell, "overlap"), off.empty() ? "" : ", ", off));
  } else {
    lines.push_back(fmt::format("border: {} px", counted(cell.ink_px)));
    if (cell.model > 0) lines.emplace_back("no reference: the method cannot run there");
  }
  if (comparison.is_matrix()) {
    const double ms = time_ms_of(comparison, cell);
    if (comparison.with_times) lines.push_back(fmt::format("drawn in {}, with its model {}", time_text(cell.border_ms), time_text(ms)));
  } else {
    const double mean = value_of(comparison, cell, "normal_error_mean"), worst = value_of(comparison, cell, "normal_error_max");
    if (std::isfinite(mean)) lines.push_back(fmt::format("normals off by {} deg, worst {} deg", short_number(mean), short_number(worst)));
    if (comparison.with_times)
      lines.push_back(fmt::format("build {}, trace {}", time_text(model.info.build_ms), time_text(model.trace_ms)));
  }
  if (model.info.bytes > 0) lines.push_back(bytes_text(static_cast<double>(model.info.bytes)) + " held");
  if (model.counts.out_of_steps > 0) lines.push_back(fmt::format("{} rays out of steps", model.counts.out_of_steps));
  return lines;
}

}  // namespace limn
