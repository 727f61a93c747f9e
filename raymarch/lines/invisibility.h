#pragma once
// Internal: curves cut where their quantitative invisibility may change, and what it is in between.

#include <optional>

#include "raymarch/lines/nearer_crossings.h"

namespace limn {

/// A place on a curve where an edge of the view graph ends.
struct CurveEvent {
  VertexKind kind = VertexKind::end;
  double at = 0.0;              ///< Index of the step plus the share of it.
  std::optional<int> layers{};  ///< Added to what lies in front, walking along; nothing where only rays tell.
  std::uint32_t nearer = 0;     ///< Of a crossing: the curve in front, and the place on it.
  double on_nearer = 0.0;
  double unclear_px = 0.0;  ///< Rays from so near to it say nothing.
};

/// A stretch of a curve between two events.
struct CurvePiece {
  std::uint32_t curve = 0;
  int begin = -1, end = -1;     ///< Into CutCurve::events; -1: the whole of a closed curve.
  double from = 0.0, to = 0.0;  ///< Places; `to` is beyond the last sample where a closed curve is walked past its first.
  double length_px = 0.0;
  int invisibility = 0;
  bool certain = true;
};

struct CutCurve {
  std::vector<CurveEvent> events{};  ///< In order.
  std::vector<CurvePiece> pieces{};  ///< Those within the picture.
};

struct CutCurves {
  std::vector<CutCurve> curves{};
  std::vector<LineConflict> conflicts{};
  /// Where rays tell of changes that no event explained at first, on the side from which they see more: there they go close by a fold.
  std::vector<CurveSample> grazing{};
  std::int64_t rays = 0;
};

/// What lies in front of a sample of a curve.
using LayersBefore = std::function<LayersSeen(const CurveSample& sample)>;

/// The steps at crossings and cusps say how the invisibility changes along a curve, rays at two places what it is: where these agree, and
/// the steps around a closed curve add up to nothing, the piece is certain. Elsewhere rays decide, and the conflict is recorded.
CutCurves cut_by_invisibility(const std::vector<SurfaceCurve>& curves, const Camera& camera, double extent,
                              const LayersBefore& layers_before, const ExecutionSettings& execution);

}  // namespace limn
