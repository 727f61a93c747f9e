#pragma once
// Internal: where on a piece of a curve rays start that count what lies in front of it.

#include <optional>
#include <vector>

#include "raymarch/lines/curve_events.h"
#include "raymarch/lines/curve_walk.h"
#include "raymarch/lines/invisibility.h"

namespace limn {

inline constexpr double kNearEnd_px = 0.3;  ///< Rays start no nearer to a piece's ends, where it has room for that.

/// Of one curve. Places are the curve's parameter, shares those of a piece's length in the picture.
struct PieceRays {
  PieceRays(const SurfaceCurve& of, std::uint32_t its_number, const CurveWalk& its_walk, const Camera& seen_from,
            const NearerFolds& nearer_folds, const std::vector<CurveEvent>& its_events);

  /// The sample of a piece nearest to the share of its length, or a point on a chord where it holds none.
  double ray_at(const CurvePiece& piece, double share) const;
  /// The place at that share, or nothing where rays from so near to a piercing say nothing.
  std::optional<double> telling_ray_at(const CurvePiece& piece, double share) const;
  /// Near that share a place where no nearer line runs so close by that a ray from beside the curve may pass it on its wrong side. Nothing
  /// where one does all along.
  std::optional<double> clear_ray_at(const CurvePiece& piece, double share) const;
  /// A piece between two crossings of one nearer line, which runs so close beside it that no ray starts clear of it, and so far from it
  /// that the curves themselves tell that they cross twice: rays that pass so near to an edge know less.
  bool told_by_lines(const CurvePiece& piece) const;

  const SurfaceCurve& curve;
  std::uint32_t number = 0;
  const CurveWalk& walk;
  const Camera& camera;
  const NearerFolds& folds;
  const std::vector<CurveEvent>& events;        ///< Between the pieces.
  double clear_px = 0.0, least_clear_px = 0.0;  ///< How far off nearer lines have to run; at the least.

 private:
  double unclear_at(int event) const;
};

}  // namespace limn
