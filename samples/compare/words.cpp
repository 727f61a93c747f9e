#include "samples/compare/words.h"

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

std::string full_title(const Cell& cell) { return cell.details.empty() ? cell.title : cell.title + " (" + cell.details + ")"; }

std::vector<std::string> caption_lines(const Cell& cell, double reference_area_px) {
  std::vector<std::string> lines;
  if (cell.values.empty()) {
    lines.push_back(fmt::format("border: {} px", counted(border_area_px(cell))));
  } else {
    const double differ = value_of(cell, "pixels_differ");
    lines.push_back(fmt::format("{} border px differ ({})", counted(differ), share_text(differ / std::max(1.0, reference_area_px))));
    lines.push_back(fmt::format("overlap (IoU) {:.4f}", value_of(cell, "overlap")));
    const double mean = value_of(cell, "normal_error_mean"), worst = value_of(cell, "normal_error_max");
    if (std::isfinite(mean)) lines.push_back(fmt::format("normals off by {} deg, worst {} deg", short_number(mean), short_number(worst)));
  }
  lines.push_back(fmt::format("build {}, trace {}", time_text(cell.info.build_ms), time_text(cell.trace_ms)));
  if (cell.info.bytes > 0) lines.push_back(bytes_text(static_cast<double>(cell.info.bytes)) + " held");
  if (cell.counts.out_of_steps > 0) lines.push_back(fmt::format("{} rays out of steps", cell.counts.out_of_steps));
  return lines;
}

}  // namespace limn
