#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "samples/compare/comparison.h"
#include "samples/compare/words.h"

namespace limn {
namespace {

std::string cell_sentence(const Cell& cell, double reference_area) {
  const double differ = value_of(cell, "pixels_differ");
  const std::string share = reference_area > 0.0 ? " (" + share_text(differ / reference_area) + " of the border)" : "";
  std::string text = fmt::format("{}: {} border pixels differ{}", heading(full_title(cell)), counted(differ), differ > 0.0 ? share : "");
  if (const double overlap = value_of(cell, "overlap"); std::isfinite(overlap)) text += fmt::format(", overlap {:.4f}", overlap);
  const double mean = value_of(cell, "normal_error_mean"), worst = value_of(cell, "normal_error_max");
  if (std::isfinite(mean))
    text += fmt::format("; normals are off by {} degrees on average and {} at worst", short_number(mean), short_number(worst));
  return text + fmt::format("; built in {}, traced in {}, {} held.", time_text(cell.info.build_ms), time_text(cell.trace_ms),
                            bytes_text(static_cast<double>(cell.info.bytes)));
}

}  // namespace

std::vector<std::string> summary_sentences(const Comparison& comparison) {
  const double area = border_area_px(comparison.reference);
  std::vector<const Cell*> drawn;
  for (const Cell& cell : comparison.cells) {
    if (cell.skipped.empty()) drawn.push_back(&cell);
  }
  std::stable_sort(drawn.begin(), drawn.end(),
                   [](const Cell* a, const Cell* b) { return value_of(*a, "pixels_differ") < value_of(*b, "pixels_differ"); });
  std::vector<std::string> sentences;
  std::string first = fmt::format(
      "'{}' was drawn {} times with the same camera ({} x {} pixels), each time from another model of its surface, and every picture was "
      "measured against {}. Its border, the dark line where the surface turns away from the eye ({}), covers {} pixels of the reference.",
      comparison.input_name, drawn.size() + 1, comparison.camera.width_px, comparison.camera.height_px, comparison.reference_words,
      comparison.method_words, counted(area));
  sentences.push_back(first);
  if (drawn.empty()) {
    sentences.push_back("No other representation can model this input, so there is nothing to compare.");
    return sentences;
  }
  if (drawn.size() > 1) {
    const double best = value_of(*drawn.front(), "pixels_differ"), worst = value_of(*drawn.back(), "pixels_differ");
    if (best == worst) {
      sentences.push_back(fmt::format("All {} differ from it in {} pixels of the border.", drawn.size(), counted(best)));
    } else {
      sentences.push_back(fmt::format("Closest to it comes the {} with {} wrong border pixels, farthest off is the {} with {}.",
                                      full_title(*drawn.front()), counted(best), full_title(*drawn.back()), counted(worst)));
    }
  }
  for (const Cell* cell : drawn) sentences.push_back(cell_sentence(*cell, area));
  return sentences;
}

}  // namespace limn
