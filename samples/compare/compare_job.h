#pragma once
// From a specification to a comparison that can be drawn: what `limn compare` and other callers have in common.

#include <optional>

#include "samples/compare/comparison.h"

namespace limn {

/// A local mesh beside the other models: within how many pixels its border lies, and whether the silhouette alone counts.
struct ComparedLocal {
  double tolerance_px = 0.0;
  bool silhouette = false;
};

/// Models, methods and camera of a comparison, nothing drawn yet; without a background it is white. Levels that were chosen for the view
/// are told in `notes`. Throws InputError.
Comparison comparison_for(const ExperimentSpec& spec, SceneInput& input, std::vector<std::string>& notes,
                          const std::optional<ComparedLocal>& local = {});

/// Throws InputError for settings that none of the comparison's models reads.
void refuse_uncompared(const ExperimentSpec& spec, const SceneInput& input, const Comparison& comparison);

/// Files of draw_comparison, in the order of models: known before anything is drawn, as long as no model turns out to be impossible.
std::vector<std::filesystem::path> layer_files(const Comparison& comparison);

/// sheet.png, rows.json and report.html of a drawn comparison. Returns false where no font was found, so that the sheet has no labels.
bool write_comparison(const Comparison& comparison, const std::filesystem::path& folder);

}  // namespace limn
