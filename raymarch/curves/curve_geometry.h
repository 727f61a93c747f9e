#pragma once
// Geometry of border curves that metrics share: equally spaced samples, nearest points, meetings with a normal.

#include <limits>
#include <optional>

#include "raymarch/border_curves.h"
#include "raymarch/curves/segment_grid.h"
#include "sdf/camera.h"

namespace limn {

/// A point of a curve. `outward` is unit, px, y down: away from what the curve bounds.
struct BorderSample {
  glm::dvec2 px{0.0}, outward{0.0};
  double weight_px = 0.0;  ///< Length of curve it stands for.
  CurveKind kind = CurveKind::silhouette;
  int object = 0;
  size_t curve = 0;       ///< Index into BorderCurves::curves.
  size_t segment = 0;     ///< From its point of this index to the next.
  double fraction = 0.0;  ///< Along the segment, 0..1.
};

/// Samples in the middles of pieces of equal length, about `step_px`, at least one a curve. `kind` empty: both kinds.
std::vector<BorderSample> resample(const BorderCurves& curves, std::optional<CurveKind> kind, double step_px);

/// False nearer than `margin_px` to the picture's sides or beyond them: there a measured border, which knows pixel centres only, has no
/// partner for truth.
bool is_within_picture(const glm::dvec2& px, const Camera& camera, double margin_px = 1.0);

/// Drops the samples that are not.
std::vector<BorderSample> within_picture(std::vector<BorderSample> samples, const Camera& camera, double margin_px = 1.0);

struct NearestPoint {
  double distance_px = 0.0;
  glm::dvec2 px{0.0};
  bool open_end = false;  ///< The end of an open curve.
};

/// Infinite where there is none.
struct NearestDistances {
  double any_px = std::numeric_limits<double>::infinity(), of_kind_px = std::numeric_limits<double>::infinity();
};

/// Where a straight line through a curve's sample, along its outward normal, meets other curves.
struct CurveMeeting {
  double along_px = 0.0;  ///< Positive outwards.
};

/// The segments of curves in a uniform grid. Answers do not depend on the order of curves but for exact ties.
class CurveIndex {
 public:
  /// `kind` empty: both. Open ends are continued straight by `continue_px`: a measured curve stops up to a pixel short of where it ends.
  CurveIndex(const BorderCurves& curves, std::optional<CurveKind> kind, double continue_px = 0.0);

  bool empty() const { return segments_.empty(); }

  /// The nearest point of curves of `object` (0: any), within `reach_px`; with `facing` (unit) only of segments whose own outward normal
  /// points that way.
  std::optional<NearestPoint> nearest(const glm::dvec2& px, int object, double reach_px, std::optional<glm::dvec2> facing = {}) const;

  /// To the nearest points of all curves and of those of one kind, in one search.
  NearestDistances nearest_distances(const glm::dvec2& px, CurveKind kind) const;

  /// The nearest meeting within `reach_px` of the line through `px` along `direction` (unit) with curves of `object` (0: any) whose own
  /// outward normal does not point against `direction`.
  std::optional<CurveMeeting> meeting(const glm::dvec2& px, const glm::dvec2& direction, int object, double reach_px) const;

 private:
  struct Segment {
    glm::dvec2 a{0.0}, b{0.0};
    int object = 0;
    CurveKind kind = CurveKind::silhouette;
    bool starts = false, ends = false;  ///< Its first, its last point is the end of an open curve.
  };
  template <class Visit>
  void visit_cell(int column, int row, const Visit& visit) const;
  /// From `px` outwards, as long as anything may be within `reach_px`, which `visit` may lower.
  template <class Visit>
  void visit_outwards(const glm::dvec2& px, const double& reach_px, const Visit& visit) const;

  std::vector<Segment> segments_{};
  bool has_silhouette_ = false, has_inner_ = false;
  SegmentGrid grid_{};
};

/// How far a partner is looked for: 16 px, or 2 % of the picture's diagonal where that is more.
double search_reach_px(const Camera& camera);

/// By how much the inner border is continued where widths are measured.
inline constexpr double kContinue_px = 1.5;

}  // namespace limn
