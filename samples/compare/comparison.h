#pragma once
// A comparison: one reference, and cells that are each measured against it. Cells become rows of numbers, a sheet and a page.

#include <string>
#include <vector>

#include "raymarch/metric.h"
#include "raymarch/picture.h"
#include "samples/compare/panels.h"
#include "samples/input.h"
#include "samples/job.h"
#include "samples/output.h"

namespace limn {

/// One way to model and draw the scene.
struct Cell {
  std::string name;     ///< Of its files: "level_set".
  std::string title;    ///< For people: "level set".
  std::string details;  ///< "256 voxels, central gradient".
  Scene scene;          ///< The input's, with levels set as this cell needs them.
  SurfaceSettings surface;
  std::string skipped;  ///< Why there is nothing to show; then nothing below is filled.

  SurfaceInfo info;
  double trace_ms = 0.0, border_ms = 0.0;
  HitCounts counts;
  Image<float> border;
  Image<glm::vec4> composite;
  Image<glm::vec4> difference;      ///< Against the reference; empty for the reference itself.
  std::vector<MetricValue> values;  ///< All metrics, in the registry's order; empty for the reference.
  std::vector<std::string> notes;
  std::filesystem::path exr;
};

struct Comparison {
  std::string input_name;
  std::string reference_words;  ///< "the analytic surface itself".
  std::string method_words;     ///< "rim threshold=0.4".
  std::string call;             ///< The resolved call.
  Camera camera;
  PictureSettings picture;
  Cell reference;
  std::vector<Cell> cells;
  Window seen;  ///< The part of the pictures where any cell hits something, with a margin; panels show that.
};

/// What is to be compared with what, before anything is drawn. `only` restricts the cells to those representations.
Comparison plan_comparison(const SceneInput& input, const SurfaceSettings& settings, const std::vector<std::string>& only,
                           bool gradient_chosen);

/// Draws the reference and every cell, writes each one's EXR into `folder`, measures. A cell that cannot be drawn keeps its reason.
void draw_comparison(Comparison& comparison, const std::filesystem::path& folder, const ExecutionSettings& how, ProgressBar& bar);

/// Input name as a heading: "machined part".
std::string heading(const std::string& name);
/// Value of a metric by name; NaN where there is none.
double value_of(const Cell& cell, const std::string& name);
/// Area of ink in the picture, pixels.
double border_area_px(const Cell& cell);

/// The result in a few sentences with numbers, for someone who has never seen the program; plain text.
std::vector<std::string> summary_sentences(const Comparison& comparison);

/// The rows as a study would write them, and the document of --json.
Json rows_json(const Comparison& comparison);
Json comparison_json(const Comparison& comparison, const std::vector<std::filesystem::path>& files);

/// One picture of everything, with labels where a font is found (`has_labels`).
struct Sheet {
  Image<glm::vec4> picture;
  bool has_labels = false;
};
Sheet contact_sheet(const Comparison& comparison);

/// One HTML file that holds all it shows.
std::string report_page(const Comparison& comparison);

}  // namespace limn
