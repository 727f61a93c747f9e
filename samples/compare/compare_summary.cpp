#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "samples/compare/compare_words.h"
#include "samples/compare/comparison.h"

namespace limn {
namespace {

using Cells = std::vector<const Cell*>;

// Measured cells of one method, the closest to the reference first.
Cells ranking(const Comparison& comparison, size_t method) {
  Cells cells;
  for (size_t model = 1; model < comparison.models.size(); ++model) {
    const Cell& cell = comparison.at(model, method);
    if (comparison.is_measured(cell)) cells.push_back(&cell);
  }
  const auto wrong = [&](const Cell* cell) { return value_of(comparison, *cell, "pixels_differ"); };
  std::stable_sort(cells.begin(), cells.end(), [&](const Cell* a, const Cell* b) { return wrong(a) < wrong(b); });
  return cells;
}

std::string cell_sentence(const Comparison& comparison, const Cell& cell) {
  const ComparedModel& model = comparison.model_of(cell);
  const double differ = value_of(comparison, cell, "pixels_differ"), area = comparison.reference_of(cell).ink_px;
  const std::string share = area > 0.0 ? " (" + share_text(differ / area) + " of the border)" : "";
  std::string text = fmt::format("{}: {} border pixels differ{}", heading(full_title(model)), counted(differ), differ > 0.0 ? share : "");
  if (const double overlap = value_of(comparison, cell, "overlap"); std::isfinite(overlap))
    text += fmt::format(", overlap {:.4f}", overlap);
  if (const std::string border_error = border_error_text(comparison, cell); !border_error.empty()) text += "; " + border_error;
  const double mean = value_of(comparison, cell, "normal_error_mean"), worst = value_of(comparison, cell, "normal_error_max");
  if (std::isfinite(mean))
    text += fmt::format("; normals are off by {} degrees on average and {} at worst", short_number(mean), short_number(worst));
  if (comparison.with_times) text += fmt::format("; built in {}, traced in {}", time_text(model.info.build_ms), time_text(model.trace_ms));
  return text + fmt::format("{} {} held.", comparison.with_times ? "," : ";", bytes_text(static_cast<double>(model.info.bytes)));
}

size_t drawn_models(const Comparison& comparison) {
  return static_cast<size_t>(
      std::count_if(comparison.models.begin(), comparison.models.end(), [](const ComparedModel& model) { return model.skipped.empty(); }));
}

std::vector<std::string> one_method(const Comparison& comparison) {
  std::vector<std::string> sentences;
  sentences.push_back(fmt::format(
      "'{}' was drawn {} times with the same camera ({} x {} pixels), each time from another model of its surface, and every picture was "
      "measured against {}. Its border, the dark line where the surface turns away from the eye ({}), covers {} pixels of the reference.",
      comparison.input_name, drawn_models(comparison), comparison.camera.width_px, comparison.camera.height_px, comparison.reference_words,
      comparison.methods.front().words, counted(comparison.cells.front().ink_px)));
  const Cells drawn = ranking(comparison, 0);
  if (drawn.empty()) {
    sentences.emplace_back("No other representation can model this input, so there is nothing to compare.");
    return sentences;
  }
  if (drawn.size() > 1) {
    const double best = value_of(comparison, *drawn.front(), "pixels_differ");
    const double worst = value_of(comparison, *drawn.back(), "pixels_differ");
    if (best == worst) {
      sentences.push_back(fmt::format("All {} differ from it in {} pixels of the border.", drawn.size(), counted(best)));
    } else {
      sentences.push_back(fmt::format("Closest to it comes the {} with {} wrong border pixels, farthest off is the {} with {}.",
                                      full_title(comparison.model_of(*drawn.front())), counted(best),
                                      full_title(comparison.model_of(*drawn.back())), counted(worst)));
    }
  }
  for (const Cell* cell : drawn) sentences.push_back(cell_sentence(comparison, *cell));
  return sentences;
}

std::string method_sentence(const Comparison& comparison, size_t method) {
  const Cell& reference = comparison.at(0, method);
  std::string text = comparison.methods[method].name + ": ";
  if (!reference.skipped.empty()) return text + "not measured, because it cannot run on the reference (" + reference.skipped + ").";
  text += fmt::format("{} pixels of ink on the reference", counted(reference.ink_px));
  const Cells drawn = ranking(comparison, method);
  for (size_t i = 0; i < drawn.size(); ++i) {
    text += fmt::format("{} {} {} the {}", i == 0 ? ";" : ",", counted(value_of(comparison, *drawn[i], "pixels_differ")),
                        i == 0 ? "differ on" : "on", comparison.model_of(*drawn[i]).title);
  }
  return text + ".";
}

/// Of the method whose ink has a truth, if there is one; else the silhouette's, which is the same for all methods.
std::string model_border_error(const Comparison& comparison, size_t model) {
  std::string longest;
  for (size_t method = 0; method < comparison.methods.size(); ++method) {
    const std::string text = border_error_text(comparison, comparison.at(model, method));
    if (text.size() > longest.size()) longest = text;
  }
  return longest;
}

std::vector<std::string> many_methods(const Comparison& comparison) {
  std::vector<std::string> sentences;
  const size_t models = drawn_models(comparison);
  sentences.push_back(fmt::format(
      "'{}' was drawn by {} methods on {} {} of its surface, with the same camera ({} x {} pixels). Every picture was measured against the "
      "same method on {}.",
      comparison.input_name, comparison.methods.size(), models, models == 1 ? "model" : "models", comparison.camera.width_px,
      comparison.camera.height_px, comparison.reference_words));
  for (size_t method = 0; method < comparison.methods.size(); ++method) sentences.push_back(method_sentence(comparison, method));
  for (size_t model = 1; model < comparison.models.size(); ++model) {
    const std::string border_error = model_border_error(comparison, model);
    if (!border_error.empty()) sentences.push_back(heading(full_title(comparison.models[model])) + ": " + border_error + ".");
  }
  return sentences;
}

}  // namespace

std::vector<std::string> summary_sentences(const Comparison& comparison) {
  std::vector<std::string> sentences = comparison.is_matrix() ? many_methods(comparison) : one_method(comparison);
  for (const ExperimentTruth& truth : comparison.truths) sentences.push_back(truth_text(truth));
  return sentences;
}

std::vector<std::string> skipped_sentences(const Comparison& comparison) {
  std::vector<std::string> sentences;
  for (const ComparedModel& model : comparison.models) {
    if (!model.skipped.empty()) sentences.push_back(model.title + ": " + model.skipped);
  }
  for (const Cell& cell : comparison.cells) {
    const ComparedModel& model = comparison.model_of(cell);
    if (cell.skipped.empty() || !model.skipped.empty()) continue;
    sentences.push_back(comparison.method_of(cell).name + " on the " + (cell.model == 0 ? "reference" : model.title) + ": " + cell.skipped);
  }
  return sentences;
}

std::vector<std::string> note_sentences(const Comparison& comparison) {
  std::vector<std::string> sentences;
  for (const ComparedModel& model : comparison.models) {
    for (const std::string& warning : model.info.warnings) sentences.push_back(model.title + ": " + warning);
  }
  for (const Cell& cell : comparison.cells) {
    for (const std::string& note : cell.notes) sentences.push_back(comparison.model_of(cell).title + ": " + note);
  }
  return sentences;
}

}  // namespace limn
