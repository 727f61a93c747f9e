#pragma once
// Internal: strokes that sway, and strokes in dashes.

#include <cstdint>

#include "raymarch/border/stroke_outline.h"

namespace limn {

/// How a stroke sways about its place.
struct Wobble {
  double px = 0.0;          ///< At most so far.
  double length_px = 60.0;  ///< Between two turns.
  std::uint64_t seed = 1;
};

/// The stroke with points as close as its swaying needs; `number` tells strokes of one seed apart. Closed strokes close.
std::vector<StrokePoint> wobbling(const std::vector<StrokePoint>& stroke, bool closed, const Wobble& wobble, std::uint64_t number);

/// Dashes of this length with gaps of 0.8 times that between them; a stroke begins and ends with a whole dash or is one, shortened or
/// lengthened to fit. A closed one has a gap after every dash.
std::vector<std::vector<StrokePoint>> dashes_of(const std::vector<StrokePoint>& stroke, bool closed, double dash_px);

}  // namespace limn
