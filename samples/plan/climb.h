#pragma once
// What is known of one ladder while a plan climbs it, and what that lets expect of the rungs that were not built.

#include <optional>

#include "samples/plan/plan.h"

namespace limn {

/// A rung that was built and measured.
struct ClimbedRung {
  int rung = 0;
  double error_px = 0.0;  ///< Infinite: more of the border is missing than a tolerance overlooks.
  double build_ms = 0.0, trace_ms = 0.0;
};

struct Climb {
  const Ladder* ladder = nullptr;
  std::vector<double> theory_px{};     ///< The error that theory expects of each rung.
  double guess_ms = 0.0;               ///< To build rung 0, before anything was built; only to tell small from large.
  std::vector<ClimbedRung> climbed{};  ///< From coarse to fine.
  int limit = 0;                       ///< The first rung that cannot be built; one past the last where none is known.
  bool closed = false;                 ///< Given up.
  std::optional<size_t> limit_note{};  ///< Of the plan's notes, the one that says why that rung cannot be built.

  const ClimbedRung* coarsest_meeting(double tolerance_px) const;
  /// The finest that fails, of those coarser than all that meet the tolerance.
  const ClimbedRung* finest_failing(double tolerance_px) const;
  /// True where two neighbours stand on either side of the tolerance, or nothing is left to try.
  bool settled(double tolerance_px) const;
  void add(const ClimbedRung& rung);
};

/// The error of a rung: between two measured ones along the power of the size that joins them, beyond them along the order they showed
/// (one alone: along theory's). Theory's own where nothing was measured.
double expected_error(const Climb& climb, int rung, double tolerance_px);

/// To build and trace a rung: both sides of a surface halved, four times as much to build but for what is the same at every rung.
double expected_ms(const Climb& climb, int rung);

/// The rung to try next: the coarsest that is expected to meet the tolerance, between those known to fail and to meet it, and no farther
/// up than what is known of the ladder carries. The climb must not be settled.
int next_rung(const Climb& climb, double tolerance_px);

/// Why a ladder is not worth climbing on, in words; empty where it is. `best_ms`: the fastest so far that meets the tolerance.
std::string reason_to_stop(const Climb& climb, double tolerance_px, std::optional<double> best_ms);

}  // namespace limn
