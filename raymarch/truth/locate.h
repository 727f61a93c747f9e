#pragma once
// Single points of the curves N.V = c on a field's surface, to rounding: roots, Newton's iteration where the surface is smooth, and
// bisection on the sign of N.V - c where N jumps.

#include <optional>

#include "sdf/camera.h"
#include "sdf/field.h"

namespace limn {

/// Who looks. `facing` is the camera turned by 1e-10, so that faces seen exactly edge-on face one way and not all ways at once.
struct Viewer {
  Camera facing{};
  glm::dvec3 toward_eye(const glm::dvec3& p) const { return view_vector(facing, p); }
};
Viewer make_viewer(const Camera& camera, const glm::dvec3& scene_center);

/// A point of the surface with its gradient.
struct SurfaceSample {
  glm::dvec3 p{0.0};
  glm::dvec3 gradient{0.0};
  double facing = 0.0;  ///< N.V
};
double facing_of(const Viewer& viewer, const glm::dvec3& p, const glm::dvec3& gradient);
SurfaceSample sample_surface(FieldEvaluator& evaluator, const Viewer& viewer, const glm::dvec3& p);

/// A point of a curve. On smooth surface `high` and `low` are both the unit normal; at a crease those of the sides above and below c.
struct CurvePoint {
  glm::dvec3 p{0.0};
  glm::dvec3 high{0.0}, low{0.0};
  double radial_curvature = std::numeric_limits<double>::quiet_NaN();
  bool crease = false;
  bool rough = false;      ///< On the curve to within a cell only.
  glm::dvec3 uphill{0.0};  ///< From lower to higher N.V, across the curve; any length.
};

/// The root of f between a and b, whose values have different signs (f < 0 being one of the two).
glm::dvec3 root_between(FieldEvaluator& evaluator, glm::dvec3 a, glm::dvec3 b, double fa, double fb);

/// Newton's iteration on (f, N.V - c) with the pseudo-inverse, from p; nothing where it does not converge or goes farther than `reach`. It
/// ends with a step shorter than the share `close` of that, before which normal and curvature are taken.
std::optional<CurvePoint> polish(FieldEvaluator& evaluator, const Viewer& viewer, double c, const glm::dvec3& p, double reach,
                                 double close = 1e-7);

/// Where both fields vanish, by Newton's iteration with the pseudo-inverse, from p; nothing where it does not converge, goes farther than
/// `reach`, or where the two surfaces touch along the way. Only `p` of the point is filled in.
std::optional<CurvePoint> polish_seam(FieldEvaluator& first, FieldEvaluator& second, const glm::dvec3& p, double reach);

/// A stretch of surface curve, as points over a parameter: bisects for the place where N.V crosses c.
struct Fan {
  glm::dvec3 apex, middle, side;  ///< Point(s) is the root of f on the segment from apex to middle + s * side,
                                  ///< or up to eight times as far.
  double apex_value = 0.0;
  std::optional<SurfaceSample> at(FieldEvaluator& evaluator, const Viewer& viewer, double s) const;
};
/// `a` at parameter `sa` and `b` at `sb` lie on different sides of c. Nothing where the fan leaves the surface on the way.
std::optional<CurvePoint> bisect(FieldEvaluator& evaluator, const Viewer& viewer, double c, const Fan& fan, double sa, double sb,
                                 SurfaceSample a, SurfaceSample b, double smooth_reach);

/// So many lengths of the step around it does point_between() evaluate the field.
inline constexpr double kFanReach = 18.0;
/// The curve's point in the plane through `middle` across the step from a to b: both lie on the curve, not far apart. No farther from the
/// middle than `reach` lengths of the step, 4 at most.
std::optional<CurvePoint> point_between(FieldEvaluator& evaluator, const Viewer& viewer, double c, const CurvePoint& a, const CurvePoint& b,
                                        const glm::dvec3& middle, double reach = 1.0);

/// Where a smooth stretch of the curve that holds one point meets the crease that holds the other, by their tangents, and a point of either
/// half way to there. Nothing where the tangents miss each other or the points are not found.
struct CornerSides {
  CurvePoint by_first{}, by_second{};
};
std::optional<CornerSides> close_in(FieldEvaluator& evaluator, const Viewer& viewer, double c, const CurvePoint& first,
                                    const CurvePoint& second);

}  // namespace limn
