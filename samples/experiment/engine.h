#pragma once
// The engine that comparisons, studies and plans run on: models x views x methods x metrics against a reference, giving measurements and
// pictures. It knows nothing of command lines, files or pages: who runs it says what is to be measured and is told of each step.

#include <deque>
#include <future>
#include <map>
#include <memory>
#include <utility>

#include "raymarch/local_model.h"
#include "raymarch/metric.h"
#include "samples/experiment/observe.h"

namespace limn {

/// One way to model a scene.
struct ExperimentModel {
  std::string title{};                           ///< For progress: "level set".
  Scene scene{};                                 ///< What is modelled: the experiment's, with levels as this model needs them.
  SurfaceSettings settings{};                    ///< How.
  std::string refused{};                         ///< Why it cannot be built, where that is known beforehand.
  std::shared_ptr<const LocalSettings> local{};  ///< Of a local model; null: as fine everywhere.
};

/// One way to draw it: a method, or several whose ink makes one picture.
struct ExperimentMethod {
  std::string title{};                      ///< For progress: "rim".
  std::vector<MethodCall> calls{};          ///< One; with finished pictures any number, the last on top.
  std::optional<double> truth_threshold{};  ///< Where its ink ends (BorderMethod::truth_threshold); unset: only the silhouette has a truth.
};

/// What is to be done: models x views x methods x metrics.
struct Experiment {
  Scene scene{};                             ///< What the true border is solved on.
  std::vector<Camera> cameras{};             ///< The views.
  std::vector<ExperimentMethod> methods{};   ///< What draws.
  std::vector<ExperimentModel> models{};     ///< The first is the reference that pictures are held against.
  std::vector<const Metric*> metrics{};      ///< Measured in this order. Not owned: of the registry, or static.
  std::optional<FramePath> path{};           ///< How the camera moves for metrics of motion.
  std::optional<PictureSettings> picture{};  ///< Samples and background of finished pictures; unset: ink at the pixel centres alone.
  bool silhouette_of_all = false;            ///< Methods without a threshold are measured, too, by the metrics that need none.
  bool share_meshes = false;                 ///< One model's mesh is the next one's start; times to build count what that was spared.
  ObjectMeshCache meshes{};                  ///< What such meshes start from, where somebody found it before. Of the same scene.
  bool adds_models = false;                  ///< More models are added while it runs: what is shared is kept for them.
  TruthReference reference = TruthReference::given;  ///< What the true border of meshes and volumes is asked of.
  bool measures_floor = true;                        ///< What the reference scores is measured, too (MeasuredCell::floor).
  int repeats = 1;  ///< Builds and pictures for the time of one, as long as they take less than kMostRepeat_ms.
  /// What models may take, with their views, that wait until others are built and traced, too: those are measured side by side. 0: views of
  /// one model alone are.
  double waiting_bytes = 128e6;
};

/// What has taken longer is not repeated: builds of one model with the first, and repeated pictures of it in one view without. One
/// time of so long a build is within a few percent of the median, and three were a quarter of all work of a study.
inline constexpr double kMostRepeat_ms = 100.0;

/// One model in one view by one method.
struct ExperimentCell {
  size_t model = 0;   ///< Index into Experiment::models.
  size_t view = 0;    ///< Index into Experiment::cameras.
  size_t method = 0;  ///< Index into Experiment::methods.
  size_t id = 0;      ///< The caller's own number for it.
};

/// The true border of one view.
struct ExperimentTruth {
  double threshold = 0.0;              ///< N.V where the ink ends.
  std::optional<BorderTruth> truth{};  ///< Unset where it could not be solved.
  std::string failed{};                ///< Why there is none.
};

/// One number.
struct Measurement {
  const Metric* metric = nullptr;  ///< Whose it is.
  MetricValue value{};             ///< Name, value and unit; NaN where there was nothing to measure.
};

/// A cell when it is done. References are good during the call.
struct MeasuredCell {
  ExperimentCell cell{};                    ///< Which.
  const SceneModel& model;                  ///< As it was built.
  const Seen& seen;                         ///< What methods drew from.
  Drawing& drawing;                         ///< May be taken, but not the reference's own. Refused: nothing was measured.
  const Drawing& reference;                 ///< The same method on the reference; may be refused, empty where no metric needs it.
  const ExperimentTruth* truth;             ///< Null: the method has none.
  std::vector<Measurement> measurements{};  ///< In the order of Experiment::metrics. Of the reference: of its curves alone.
  /// What the reference scores against the truth by the metrics of curves: less than this cannot be told of any model. Empty without truth.
  std::span<const Measurement> floor{};
  double measure_ms = 0.0;  ///< To draw and to measure, without solving the truth.
};

/// Who is told. Empty functions are not called.
struct ExperimentObserver {
  /// Progress of one step, from 0 to 1: "building level set".
  std::function<std::function<void(double)>(const std::string& what)> stage{};
  /// Before each cell: may throw Cancelled.
  std::function<void()> cell_begins{};
  /// A model is there, after `ms`; `build` is its surfaces' own time, of several builds where these are quick.
  std::function<void(size_t model, const SceneModel& built, double ms, const Timing& build)> built{};
  /// Nothing of these cells will come.
  std::function<void(std::span<const ExperimentCell> cells, const std::string& reason)> refused{};
  /// Traced; where finished pictures were asked for all methods have drawn. While the future that is returned is not ready (an empty one
  /// is), nothing of it changes or goes: it may be written meanwhile.
  std::function<std::future<void>(size_t model, size_t view, const SceneModel& built, Seen& seen, std::span<Drawing> drawings)> seen{};
  /// A truth is there, or why there is none.
  std::function<void(size_t view, const ExperimentTruth& truth, double ms)> solved{};
  /// What a cell drew, and the same method on the reference (MeasuredCell::reference). Before `measured`, from several threads at once, not
  /// where the method refused.
  std::function<void(const ExperimentCell& cell, const Drawing& drawing, const Drawing& reference)> drawn{};
  /// A cell is done.
  std::function<void(MeasuredCell& cell)> measured{};
};

struct ViewWork;      // samples/experiment/engine_views.h: one model in one view
struct WaitingModel;  // there, too: a model whose views wait to be measured

/// An experiment under way: what several cells share (the reference, its pictures, truths) is made once and kept. Used from one thread, all
/// of whose work runs on the threads of the surrounding task arena.
class ExperimentRun {
 public:
  /// `how` is for every picture; what `observer` holds must live as long as the run.
  ExperimentRun(Experiment experiment, const ExecutionSettings& how, ExperimentObserver observer);
  ~ExperimentRun();

  /// Does the cells: those of one model one after the other are built once, those of one view of it traced once. Several models that are
  /// small are built and traced one after the other, then measured side by side. Throws InputError where the reference cannot be built, and
  /// Cancelled.
  void run(std::span<const ExperimentCell> cells);

  /// Another way to model the scene; returns its index.
  size_t add_model(ExperimentModel model);
  /// Solved when first asked for. Where it cannot be solved it says why.
  const ExperimentTruth& truth(size_t view, double threshold);
  /// A truth that is known already.
  void give_truth(size_t view, ExperimentTruth truth);
  /// The reference in a view, built and traced when first asked for.
  Seen& reference(size_t view);
  /// Forgets what was seen of the reference and its truths; the model stays.
  void forget_views() { views_.clear(); }
  /// With the models that were added.
  const Experiment& experiment() const { return experiment_; }
  /// What models share, and may be shared with those made elsewhere.
  const ObjectMeshCache& meshes() const { return meshes_; }

 private:
  /// The truth's threshold, and whether the method has one of its own: all that what the reference scores depends on.
  using FloorKey = std::pair<double, bool>;
  struct ReferenceView {
    std::optional<Seen> seen{};
    std::map<size_t, Drawing> drawings{};
    std::map<double, ExperimentTruth> truths{};
    std::map<FloorKey, std::vector<Measurement>> floors{};
    LinesOfView lines{};
  };
  using Cells = std::span<const ExperimentCell>;

  SceneModel build(size_t model);
  void run_model(Cells cells, std::deque<WaitingModel>& waiting);
  void run_reference(Cells cells);
  /// What needs all threads, or whose time counts: traces, draws, and solves the truths.
  void look_at_view(const SceneModel& built, Cells cells, ViewWork& work);
  void look_at_reference(Cells cells, ViewWork& work);
  void prepare_cells(ViewWork& work);
  /// Measures the cells of several views side by side, and tells of them in their order.
  void finish(std::span<ViewWork* const> works);
  void finish(std::deque<WaitingModel>& waiting);  ///< Their views are done and gone then; the models stay.
  void measure_all(std::span<ViewWork* const> works);
  void measure_curves(ViewWork& work, std::span<const size_t> cells);
  void measure_ink(ViewWork& work, size_t cell);
  void measure_gbuffer(ViewWork& work);
  std::vector<Measurement> measure_floor(size_t view, const ExperimentTruth& truth, bool has_threshold) const;
  void tell(ViewWork& work);
  GBuffer take_spare();
  bool has_threshold(size_t method) const { return experiment_.methods[method].truth_threshold.has_value(); }
  bool measures_floor_of(const ExperimentCell& cell, const ExperimentTruth* truth) const;
  void add_curve_metrics(const MetricInput& input, bool has_threshold, std::vector<Measurement>& to) const;
  DrawnView draw_view(size_t model, size_t view, const SceneModel& built);
  const Drawing& reference_drawing(size_t view, size_t method);
  const ExperimentTruth* truth_for(size_t view, size_t method);
  std::function<void(double)> stage(const std::string& what) const;
  ExecutionSettings with_progress(const std::string& what) const;
  bool needs_reference() const;
  bool needs_ink() const;

  Experiment experiment_;
  ExecutionSettings how_;
  ExperimentObserver observer_;
  std::optional<SceneModel> reference_{};
  std::map<size_t, ReferenceView> views_{};
  ObjectMeshCache meshes_{};
  TruthCache truth_cache_{};
  std::vector<GBuffer> spare_{};  ///< Of views that are done: memory for the next ones.
};

}  // namespace limn
