#pragma once
// Internal: one model in one view, while the engine traces, draws and measures it.

#include <map>

#include "raymarch/metric/curve_findings.h"
#include "samples/experiment/engine.h"

namespace limn {

/// Stays where it is: parts of it point to others.
struct ViewWork {
  const SceneModel* built = nullptr;
  std::span<const ExperimentCell> cells{};  ///< Of one model and view; not empty.
  DrawnView drawn{};                        ///< Empty of the reference, whose views are kept.
  Seen* seen = nullptr;                     ///< In `drawn`, or the reference's.
  Drawing none{};
  // One a cell:
  std::vector<Drawing*> drawings{};
  std::vector<const Drawing*> against{};  ///< The reference's, empty where no metric needs it.
  std::vector<const ExperimentTruth*> truths{};
  std::vector<std::vector<Measurement>> of_curves{}, of_ink{};
  std::vector<double> curves_ms{}, ink_ms{};  ///< What measuring them took.
  std::vector<Measurement> of_gbuffer{};      ///< The same for all cells.
  std::future<void> under_way{};              ///< The observer's, of what was seen; the last member, so that it is waited for first.

  size_t model() const { return cells.front().model; }
  size_t view() const { return cells.front().view; }
};

/// What it keeps of pictures, about.
double bytes_of(const ViewWork& work);

/// Stays where it is: its views point to it.
struct WaitingModel {
  SceneModel built{};
  std::deque<ViewWork> views{};
};

}  // namespace limn
