#pragma once
// A study before anything of it is built: which models, views and methods, the cells that they make, and what each is expected to cost.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "raymarch/frames.h"
#include "raymarch/picture.h"
#include "samples/experiment/cost.h"
#include "samples/input/input.h"
#include "samples/study/row.h"

namespace limn {

/// Of the rows and their metrics, and of how a cell is measured: a change of it makes other cells.
inline constexpr int kStudyFormat = 2;

/// Pictures traced for the time of one.
inline constexpr int kStudyRepeats = 3;

/// How the camera moves for flicker.
inline constexpr FramePath kFlickerPath{.frames = 5, .step_px = 0.25};

/// One way to model the scene.
struct StudyModel {
  std::string surface{};                            ///< A name in surface_kinds().
  std::map<std::string, std::string> parameters{};  ///< As in the rows: what the representation reads and the study varies.
  SurfaceSettings settings{};                       ///< As it is built.
  std::optional<double> local_px{};                 ///< Of a local mesh: its tolerance in the study's views.
  std::string refused{};                            ///< Why it cannot be built, where that is known beforehand.
  ExpectedCost cost{};                              ///< See ExpectedCost.
};

/// One way to draw it.
struct StudyMethod {
  MethodCall call{};                                ///< The method with all parameters.
  std::map<std::string, std::string> parameters{};  ///< As in the rows: all of them, by name.
  /// The rim's, whose border truth knows; empty for other methods.
  std::optional<double> truth_threshold{};
};

/// One model, one view, one method, as indices.
struct StudyCell {
  std::string key{};  ///< StudyRow::key.
  size_t model = 0,   ///< Index into Study::models.
      view = 0,       ///< Index into Study::cameras.
      method = 0;     ///< Index into Study::methods.
};

/// A study, planned.
struct Study {
  Scene scene{};                                           ///< Objects' own levels taken away: the models say them.
  SurfaceSettings reference{};                             ///< The model that pictures are held against.
  std::string reference_words{};                           ///< `reference` in words: "the analytic surface itself".
  TruthReference truth_reference = TruthReference::given;  ///< What the true border of meshes and volumes is asked of.
  ExpectedCost reference_cost{};                           ///< See ExpectedCost.
  std::string input_hash{};                                ///< Of the scene's objects and of all files that they came from.
  std::vector<Camera> cameras{};                           ///< One a view.
  std::vector<StudyMethod> methods{};                      ///< In the order of the call.
  std::vector<StudyModel> models{};                        ///< In the order in which they are built.
  std::vector<StudyCell> cells{};                          ///< In the order of work: models, their views, methods.
  bool flicker = false;                                    ///< Flicker is measured, too.
  double waiting_bytes = 128e6;                            ///< See Experiment. 0 where memory is limited.
  StudyHead head{};                                        ///< What the folder says of it.
  ObjectMeshCache meshes{};                                ///< What meshes start from, found to tell what they take.
  double longest_side = 0.0;                               ///< World, of the scene.
  double border_faces = 0.0;                               ///< See border_faces(): what truths and measurements take grows with it.

  double looks() const { return flicker ? double{kFlickerPath.frames} : 1.0; }  ///< Pictures traced of each model in each view.
  double measure_ms() const;                                                    ///< Expected for one cell: ink, curves and metrics.
  double truth_ms() const;                                                      ///< Expected for one view and threshold.
  /// Of one picture.
  double pixels() const { return double(cameras.front().width_px) * cameras.front().height_px; }
};

/// Of all cells, on the machine that the constants were measured on.
double expected_ms(const Study& study);

/// What a study of so many views holds beside its models, and writes.
double bytes_beside_models(const Study& study, double views);

/// What the specification leaves open is chosen so that the study is expected to end within a minute. Throws InputError for a call that
/// makes no study.
Study plan_study(const StudySpec& spec, SceneInput input);

/// A row of the cell that says who it is and nothing yet of what was measured.
StudyRow row_of(const Study& study, const StudyCell& cell);
/// "mesh, vertex normals, level 3, view 2, rim threshold=0.4".
std::string cell_text(const Study& study, const StudyCell& cell);
/// "3 min 20 s", "45 s".
std::string duration_text(double milliseconds);

}  // namespace limn
