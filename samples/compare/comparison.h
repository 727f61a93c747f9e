#pragma once
// A comparison: one reference, and other models of the same scene, each drawn by one or several methods. A cell is one method on one model,
// measured against the same method on the reference. Cells become rows of numbers, a sheet and a page.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "raymarch/metric.h"
#include "raymarch/picture.h"
#include "samples/experiment/engine.h"
#include "samples/experiment/job.h"
#include "samples/input/input.h"
#include "samples/output/output.h"
#include "samples/page/panels.h"

namespace limn {

/// One way to model the scene.
struct ComparedModel {
  std::string name;                              ///< Of its file: "level_set".
  std::string title;                             ///< For people: "level set".
  std::string details;                           ///< "256 voxels, central gradient".
  Scene scene;                                   ///< The input's, with levels set as this model needs them.
  SurfaceSettings surface;                       ///< How this model is built.
  std::shared_ptr<const LocalSettings> local{};  ///< Of a local mesh; null: as fine everywhere.
  std::string skipped;                           ///< Why there is nothing to show; then nothing below is filled.

  SurfaceInfo info;                 ///< Sums over the objects (total()).
  double trace_ms = 0.0;            ///< Of one picture, all samples.
  HitCounts counts;                 ///< Of the pixel centres.
  std::vector<MetricValue> values;  ///< Of the G-buffer, in the registry's order; empty for the reference.
  std::filesystem::path exr;        ///< The file with all its layers.
};

/// One way to draw it.
struct ComparedMethod {
  std::string name;                       ///< "rim"; "rim+edge_quads" where several make one picture.
  std::string words;                      ///< "rim threshold=0.4".
  std::string help;                       ///< What it does, in a line.
  std::vector<MethodCall> calls;          ///< Inks in order, the last on top.
  std::optional<double> truth_threshold;  ///< Where its ink ends (BorderMethod::truth_threshold); unset: only the silhouette has a truth.
};

/// One method on one model.
struct Cell {
  std::string name;     ///< "level_set", or "level_set-rim" where there are several methods.
  size_t model = 0,     ///< Index into Comparison::models.
      method = 0;       ///< Index into Comparison::methods.
  std::string skipped;  ///< Why there is no picture; then nothing below is filled.

  double border_ms = 0.0;                 ///< Of the methods, all samples.
  double ink_px = 0.0;                    ///< Area of ink.
  Image<float> border;                    ///< Ink coverage in [0, 1].
  Image<glm::u8vec4> composite;           ///< sRGB, opaque or not: as it goes into a PNG.
  std::vector<MetricValue> values;        ///< Of the border, in the registry's order; empty where there is no reference.
  std::vector<MetricValue> truth_values;  ///< Displacements from the truth, of the reference too; empty where there is none.
  std::vector<MetricValue> floors;        ///< What the reference scores by the same measurement.
  std::vector<std::string> notes;         ///< What failed, as the method measured it.
};

/// A comparison, planned or drawn: plan_comparison(), plan_methods() and draw_comparison() fill it in this order.
struct Comparison {
  std::string input_name;                                  ///< SceneInput::name.
  std::string reference_words;                             ///< "the analytic surface itself".
  std::string call;                                        ///< The resolved call.
  TruthReference truth_reference = TruthReference::given;  ///< What the true border of meshes and volumes is asked of.
  Camera camera;                                           ///< Of all pictures.
  PictureSettings picture;                                 ///< Samples and background; the methods are those below.
  std::vector<ComparedMethod> methods;                     ///< One a column.
  std::vector<ComparedModel> models;                       ///< The first is the reference.
  std::vector<Cell> cells;                                 ///< All methods of the first model, then of the next.
  std::vector<ExperimentTruth> truths;                     ///< One a threshold; the first serves methods without one.
  ObjectMeshCache meshes;                                  ///< What meshes start from, as far as somebody has looked for it.
  bool with_times = true;  ///< Measured times are shown and written; without them equal calls write equal bytes.
  Window seen;             ///< The part of the pictures where any model hits something, with a margin; panels show that.

  const ComparedModel& reference() const { return models.front(); }  ///< The first model; there must be one.
  bool is_matrix() const { return methods.size() > 1; }              ///< True where there are several methods.
  /// The cell of a model and a method, by their indices; not checked.
  const Cell& at(size_t model, size_t method) const { return cells[model * methods.size() + method]; }
  /// The cell of a model and a method, by their indices; not checked.
  Cell& at(size_t model, size_t method) { return cells[model * methods.size() + method]; }
  const ComparedModel& model_of(const Cell& cell) const { return models[cell.model]; }      ///< The row that a cell is in.
  const ComparedMethod& method_of(const Cell& cell) const { return methods[cell.method]; }  ///< The column that a cell is in.
  /// The same method on the reference; may have been skipped.
  const Cell& reference_of(const Cell& cell) const { return at(0, cell.method); }
  /// True where there is something to measure against.
  bool is_measured(const Cell& cell) const { return cell.model > 0 && cell.skipped.empty() && reference_of(cell).skipped.empty(); }
};

/// What is to be compared with what, before anything is drawn: models, no methods yet. `only` restricts the models to those
/// representations.
Comparison plan_comparison(const SceneInput& input, const SurfaceSettings& settings, const std::vector<std::string>& only,
                           bool gradient_chosen);
/// Makes a method a column and fills the cells.
void plan_methods(const std::vector<std::vector<MethodCall>>& columns, Comparison& comparison);
/// Makes the mesh, beside the reference, a local one.
void plan_local(const LocalSettings& local, Comparison& comparison);

/// Draws every cell, writes each model's EXR into `folder`, measures. Each model is built and traced once. A cell that cannot be drawn
/// keeps its reason.
void draw_comparison(Comparison& comparison, const std::filesystem::path& folder, const ExecutionSettings& how, ProgressBar& bar);

/// Of the methods of one picture: the first that has one.
std::optional<double> truth_threshold(const std::vector<MethodCall>& calls);
/// What displacements are measured from, in a sentence.
std::string truth_text(const ExperimentTruth& truth);
/// "95 % of its border is within 0.13 px of the truth (silhouette 0.02 px, inner border 0.15 px), right to 0.5 px"; of methods that have no
/// threshold the silhouette alone; empty where nothing was measured.
std::string border_error_text(const Comparison& comparison, const Cell& cell);
/// The same number for captions: "border within 0.13 px".
std::string short_border_error(const Comparison& comparison, const Cell& cell);

/// A part of the composite as it was drawn, linear.
Image<glm::vec4> linear_composite(const Cell& cell, const Window& window);
/// Input name as a heading: "machined part".
std::string heading(const std::string& name);
/// Value of a metric by name, the cell's or its model's; NaN where there is none.
double value_of(const Comparison& comparison, const Cell& cell, const std::string& name);
/// Build, trace and border together.
double time_ms_of(const Comparison& comparison, const Cell& cell);

/// The result in a few sentences with numbers, for someone who has never seen the program; plain text.
std::vector<std::string> summary_sentences(const Comparison& comparison);
/// What is not there and why, model by model and, where only a method is missing, method by method: "analytic: the cage has no field".
std::vector<std::string> skipped_sentences(const Comparison& comparison);
/// What failed where, in the methods' own words: "rim on the mesh: 3 of 3 visible faces flipped whole".
std::vector<std::string> note_sentences(const Comparison& comparison);

/// The rows as a study would write them.
Json rows_json(const Comparison& comparison);
/// What `limn compare --json` prints; `files` are those that were written.
Json comparison_json(const Comparison& comparison, const std::vector<std::filesystem::path>& files);

/// One picture of everything, with labels where a font is found (`has_labels`).
struct Sheet {
  Image<glm::u8vec4> picture;  ///< sRGB.
  bool has_labels = false;     ///< False where no font was found.
};
/// All cells of a drawn comparison, with their differences from the reference.
Sheet contact_sheet(const Comparison& comparison);

/// One HTML file that holds all it shows.
std::string report_page(const Comparison& comparison);

}  // namespace limn
