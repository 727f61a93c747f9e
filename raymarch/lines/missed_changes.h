#pragma once
// Internal: where what lies in front of a curve changes and no event says so.

#include <optional>

#include "raymarch/lines/curve_walk.h"
#include "raymarch/lines/invisibility.h"

namespace limn {

/// A curve whose events have known steps between two places, and what rays say along it.
struct ChangeSearch {
  const CurveWalk& walk;
  /// What rays see at a place, less what the events before it add up to.
  std::function<LayersSeen(double place)> unexplained;
  std::function<double(double place)> unit_px;  ///< Pixels per world unit there.
};

/// Between two places where rays disagree: where they change their mind, and by how many layers.
struct MissedChange {
  double at = 0.0;
  int layers = 0;
  /// The line goes through that many sheets there, told by how the nearest sheet comes closer along the rays from both sides.
  bool piercing = false;
  double with_more = 0.0;  ///< A place beside it from which rays see the more layers.
};
std::optional<MissedChange> find_missed(const ChangeSearch& search, double from, double to);

}  // namespace limn
