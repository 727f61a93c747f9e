#pragma once
// Internal: which of the crossings of polylines are crossings of the curves that they stand for.

#include "raymarch/lines/invisibility.h"
#include "raymarch/lines/sign_changes.h"

namespace limn {

/// What the curves have in common. Keeps references to what it is made of.
struct EventSearch {
  EventSearch(const std::vector<SurfaceCurve>& curves, const Camera& camera, double extent);

  const std::vector<SurfaceCurve>& curves;
  const Camera& camera;
  double extent;
  std::vector<char> have_ends;  ///< Of each curve 1 where it has ends, or joints.
};

inline constexpr double kLongestNarrow_px = 20.0;
inline constexpr double kTangency_px = 3.0;  ///< Along one curve, from a cusp.
/// Arms of a curve that lie closer together lie on each other: those of a curve that is known between its samples cross where their
/// polylines do.
double arms_apart_px(const SurfaceCurve& curve);

struct TrueCrossings {
  std::vector<NearerCrossing> kept{};    ///< In order along the curve.
  std::vector<NearerCrossing> undone{};  ///< Of the curve with itself: two and two, which cancel out.
};
/// Of the crossings of the curve of that number those that are not the work of polylines alone, as where curves touch or run along each
/// other.
TrueCrossings true_crossings(const EventSearch& search, std::uint32_t number, const CurveWalk& walk, const SignChanges& changes,
                             const std::vector<NearerCrossing>& crossings);

}  // namespace limn
