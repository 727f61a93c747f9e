#pragma once
// Rows such as a study makes, from laws that are known: error = factor * resolution^order, some scatter over the views, costs that grow.

#include <filesystem>
#include <vector>

#include "samples/study/row.h"

namespace limn::test {

struct SyntheticStudy {
  StudyHead head{};
  std::vector<StudyRow> rows{};
};

struct SyntheticSettings {
  int views = 12;
  std::vector<double> thresholds{0.2, 0.4};
  double scatter = 0.25;  ///< Of the logarithm over the views; 0: every view the same.
  unsigned seed = 1;
  bool with_failures = true;  ///< cubic at 1024 voxels does not fit.
};

/// Meshes of three kinds of normals at 7 levels, level sets of three gradients at 7 resolutions.
SyntheticStudy synthetic_study(const SyntheticSettings& settings);
/// Order with which the synthetic inner border of a series converges: "mesh, flat facets" 1, ….
double synthetic_order(const std::string& series);
/// A circle with wrong ink in red and missing ink in blue, for each cell.
void write_synthetic_thumbnails(const std::vector<StudyRow>& rows, const std::filesystem::path& folder);

}  // namespace limn::test
