#pragma once
// Internal to limit_segments.cpp and limit_creases.cpp: what tracing the lattice of one surface goes by.

#include <map>
#include <memory>

#include "raymarch/truth/limit_segments.h"

namespace limn {

/// An edge on which N.V crosses a level, from the smaller side to the greater.
struct PendingRoot {
  LimitEndKey key{};
  std::uint32_t patch = 0;
  glm::dvec2 uv0{0.0}, uv1{0.0};
  double h0 = 0.0, h1 = 0.0, level = 0.0;
};

struct LimitTracer {
  const PlacedLimitSurface& placed;
  const LimitGrid& grid;
  const Camera& camera;
  LimitLevel level{};
  bool mirrored = false;               ///< Triangles run clockwise as seen from the side of their normals.
  std::unique_ptr<double[]> facing{};  ///< N.V of each side that matters; most memory of large grids is never touched.
  std::vector<LimitSegment> segments{};
  std::map<LimitEndKey, double> roots{};  ///< Place of each root along its edge, from the smaller side to the greater.
  std::vector<PendingRoot> pending{};     ///< Roots of `roots` that are still to be found.

  double h(std::uint32_t side) const { return facing[side] - level.threshold; }
};

/// The root on a triangle's edge between two of its corners: of N.V - threshold (kind 0) or N.V (kind 1). Found once, by whoever asks
/// first: all who share it then agree.
double root_on(LimitTracer& tracer, const LimitTriangle& triangle, int from, int to, int kind);
LimitEnd end_on(LimitTracer& tracer, const LimitTriangle& triangle, int from, int to, int kind);

/// What creases and open edges contribute.
void cross_seams(LimitTracer& tracer);

}  // namespace limn
