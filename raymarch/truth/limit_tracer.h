#pragma once
// Internal to limit_segments.cpp and limit_creases.cpp: what tracing the lattice of one surface goes by.

#include <map>

#include "raymarch/truth/limit_segments.h"

namespace limn {

struct LimitTracer {
  const PlacedLimitSurface& placed;
  const LimitGrid& grid;
  const Camera& camera;
  LimitLevel level{};
  bool mirrored = false;         ///< Triangles run clockwise as seen from the side of their normals.
  std::vector<double> facing{};  ///< N.V of each side.
  std::vector<LimitSegment> segments{};
  std::map<LimitEndKey, double> roots{};  ///< Place of each root along its edge, from the smaller side to the greater.

  double h(std::uint32_t side) const { return facing[side] - level.threshold; }
};

/// The root on a triangle's edge between two of its corners: of N.V - threshold (kind 0) or N.V (kind 1). Found once, by whoever asks
/// first: all who share it then agree.
double root_on(LimitTracer& tracer, const LimitTriangle& triangle, int from, int to, int kind);
LimitEnd end_on(LimitTracer& tracer, const LimitTriangle& triangle, int from, int to, int kind);

/// What creases and open edges contribute.
void cross_seams(LimitTracer& tracer);

}  // namespace limn
