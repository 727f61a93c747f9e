#pragma once
// Which piece of a measured border is which piece of the true one: one to one along both, and in order.

#include "raymarch/curves/curve_geometry.h"

namespace limn {

/// Why a place of the true border says nothing of a model, whatever the model: each follows from the truth and the camera alone.
enum class IllReason {
  none,
  flat,   ///< N.V hardly changes across an inner border: the error of one float moves it by more than kIllShift_px.
  thin,   ///< Of a band of ink, a gap or a sheet that is thinner there than kThin_px: rays a pixel apart need not find it.
  brief,  ///< Of a piece of the true border shorter than kBrief_px: likewise.
};

inline constexpr double kIllShift_px = 0.05, kThin_px = 0.3, kBrief_px = 1.0;

/// A sample of the true border, and what was measured of it.
struct MatchedSample {
  BorderSample at{};
  bool inside = false;                      ///< Of the picture, by a pixel: what metrics count.
  std::optional<double> displacement_px{};  ///< Along its outward normal, positive outwards; empty: missing.
  size_t curve = 0;                         ///< Its partner: index of the measured curve,
  double along_px = 0.0;                    ///< and the arc length from its first point.
  IllReason ill = IllReason::none;
};

/// A sample of the measured border.
struct MeasuredSample {
  BorderSample at{};
  bool inside = false;
  bool matched = false;  ///< Some true sample's partner, or between two neighbours' partners; else false border.
};

struct BorderMatch {
  std::vector<MatchedSample> truth{};      ///< About each px, by curve, along each.
  std::vector<MeasuredSample> measured{};  ///< Likewise.
};

/// `kind` empty: both kinds, each with its own. Partners have the same kind and object and face the same way. Along each true curve the
/// cheapest sequence of partners is taken (Viterbi 1967): far ones cost, and what costs most is to leave a curve for another one that does
/// not continue it, or to go back along it. Where two stretches of truth claim one measured stretch, the one that would lose more by
/// its next best choice keeps it, and the other is matched again without it. Partners lie within search_reach_px().
BorderMatch match_borders(const BorderCurves& truth, const BorderCurves& measured, std::optional<CurveKind> kind, const Camera& camera);

}  // namespace limn
