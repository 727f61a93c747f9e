#pragma once
// What cells are measured against: for each view the reference model's picture, and the truth of the border. Made when first asked for.

#include <optional>

#include "raymarch/frames.h"
#include "raymarch/metric.h"
#include "samples/study/cost.h"
#include "samples/study/record.h"
#include "sdf/error.h"

namespace limn {

/// One method's ink on one model, seen from one view.
struct Ink {
  Image<float> ink{};
  std::vector<Image<float>> moved{};  ///< Where flicker is measured: frame by frame, the first is `ink` again.
  double border_ms = 0.0;
  std::string refused{};  ///< Why there is none.
};

/// A model from one view, before any method.
struct Seen {
  GBuffer gbuffer{};
  std::vector<GBuffer> moved{};  ///< Frames after the first, which is `gbuffer`.
  std::vector<Camera> cameras{};
  std::vector<Image<std::int32_t>> before{};  ///< pixels_before() of them.
  double trace_ms = 0.0;
};
Seen look(const SceneModel& model, const Study& study, size_t view, const ExecutionSettings& how);
/// Whether methods know the frame before: the reference must not, its flips are those of the border itself.
enum class Frames { in_sequence, each_alone };
Ink draw(const Study& study, const SceneModel& model, size_t view, size_t method, const Seen& seen, Frames frames);

/// What is wrong and what was expected, for a row.
std::string reason_of(const InputError& error);

struct TruthOf {
  std::optional<BorderTruth> truth{};
  TruthRecord record{};
};

class StudyReference {
 public:
  StudyReference(const Study& study, const ExecutionSettings& how, CostLedger& ledger) : study_(study), how_(how), ledger_(ledger) {}

  /// Its border is left empty: swap a method's ink in.
  Picture& picture(size_t view);
  Ink& ink(size_t view, size_t method);
  std::span<const Image<std::int32_t>> before(size_t index) { return view(index).seen.before; }
  const TruthOf& truth(size_t view, double threshold);
  /// Forgets the pictures of all views; the model stays.
  void clear() { views_.clear(); }

  /// What holding one view takes, bytes.
  static double bytes_of_view(const Study& study);

 private:
  struct View {
    Seen seen{};
    Picture picture{};
    std::map<size_t, Ink> inks{};
    std::map<double, TruthOf> truths{};
  };
  View& view(size_t index);

  const Study& study_;
  ExecutionSettings how_;
  CostLedger& ledger_;
  std::optional<SceneModel> model_{};
  std::map<size_t, View> views_{};
};

}  // namespace limn
