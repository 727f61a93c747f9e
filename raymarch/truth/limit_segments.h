#pragma once
// Where a limit surface's lattice is crossed by the curve N.V = c: pieces of it, one in each triangle and each crease edge.

#include <tuple>

#include "raymarch/border_curves.h"
#include "raymarch/truth/limit_grid.h"

namespace limn {

/// What a segment's end is: a root on an edge between two sides, or a node. Roots of N.V = 0 on a crease are told from those of N.V = c.
struct LimitEndKey {
  std::uint32_t a = 0, b = 0;
  int kind = 0;  ///< 0: root of h, 1: root of N.V, 2: node a.
  bool operator<(const LimitEndKey& o) const { return std::tie(kind, a, b) < std::tie(o.kind, o.a, o.b); }
  bool operator==(const LimitEndKey& o) const { return kind == o.kind && a == o.a && b == o.b; }
};
inline LimitEndKey root_key(std::uint32_t a, std::uint32_t b, int kind) { return {std::min(a, b), std::max(a, b), kind}; }

struct LimitEnd {
  LimitEndKey key;
  std::uint32_t patch = 0;
  glm::dvec2 uv{0.0};
};

/// Between two ends, in one patch.
struct LimitSegment {
  LimitEnd ends[2];
  glm::dvec3 beside{0.0};  ///< World: a place on the side that is not bounded (inner), or that is (creases and open edges).
  bool beside_is_bounded = false;
  bool crease = false;
  glm::dvec3 high_normal{0.0}, low_normal{0.0};  ///< Of a crease's sides of higher and lower N.V.
  glm::dvec3 along{0.0};                         ///< World: from the one end of a crease or open edge to the other.
  bool left = true;                              ///< What it bounds lies to the left of the way from the first end to the second, as seen.
};

/// Which curve is traced.
struct LimitLevel {
  CurveKind kind = CurveKind::silhouette;
  double threshold = 0.0;
  LimitTurn turn = LimitTurn::none;
  bool seams = true;  ///< What creases and open edges contribute is wanted.
};

/// N.V at a place of a patch.
double facing_at(const PlacedLimitSurface& placed, const Camera& camera, std::uint32_t patch, const glm::dvec2& uv);
/// How far from uv0 to uv1 (0..1) N.V crosses `level`; h0 and h1 are N.V - level at the ends and differ in sign.
double root_between(const PlacedLimitSurface& placed, const Camera& camera, std::uint32_t patch, const glm::dvec2& uv0,
                    const glm::dvec2& uv1, double h0, double h1, double level);

std::vector<LimitSegment> limit_segments(const PlacedLimitSurface& placed, const LimitGrid& grid, const Camera& camera,
                                         const LimitLevel& level);

}  // namespace limn
