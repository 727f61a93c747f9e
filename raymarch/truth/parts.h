#pragma once
// The stages between a scene and its border, each usable with any surface that can answer what the stage asks for:
//   trace (fields: field_curves.h; limit surfaces) -> hide (visible_parts) -> thin and orient (border_of) -> coverage_of.
// All work in solver space: world axes, origin at the scene's centre.

#include <functional>
#include <span>

#include "raymarch/truth.h"

namespace limn {

/// A point of a curve on a surface, before anyone knows whether it is hidden.
struct TracedPoint {
  glm::dvec3 p{0.0};  ///< Solver space.
  glm::dvec2 px{0.0};
  double depth = 0.0;
  /// Unit normals of the sides of higher and lower N.V; the same where there is no crease.
  glm::dvec3 high{0.0}, low{0.0};
  double radial_curvature = std::numeric_limits<double>::quiet_NaN();
  bool crease = false;
  /// False on an inner crease whose lower side faces away: there the surface ends, which is the silhouette's business.
  bool shown = true;
  glm::dvec3 lift{0.0};     ///< Unit: the way off the surface on which a ray to the eye may start.
  glm::dvec2 outward{0.0};  ///< Image direction away from what the curve bounds, not unit; 0 where unknown.
};

/// A whole curve on one object's surface, hidden parts included.
struct TracedCurve {
  CurveKind kind = CurveKind::silhouette;
  int object = 1;  ///< From 1.
  bool closed = false;
  std::vector<TracedPoint> points{};
  /// On a surface that has an end or no outside: its back may be seen, so that a contour that bends towards the eye need not be hidden. The
  /// points run with what the curve bounds on its left.
  bool sheet = false;
};

/// Image direction of a step along `direction` from `p`; not unit.
glm::dvec2 image_direction(const Camera& camera, const glm::dvec3& p, const glm::dvec3& direction);

/// What visibility asks a scene. All are called from many threads at a time.
struct CurveScene {
  Camera camera{};  ///< Solver space.
  /// Something is between the point, lifted off, and the eye.
  std::function<bool(const TracedPoint& point, int object)> blocked{};
  double lift_px = 0.0;  ///< How far beside a curve `blocked` looks; 0: on it.
  /// The curve's point at the share `t` of the way from points[i] to its successor; empty: on the chord.
  std::function<TracedPoint(const TracedCurve& curve, size_t i, double t)> between{};
  /// The lesser of the other objects' signed distances (or any function of their signs); empty where objects cannot overlap.
  std::function<double(const glm::dvec3& p, int object)> others{};
};

struct VisibilitySettings {
  double split_px = 0.001;    ///< Ends of visible parts are bracketed to this.
  double spacing_px = 16.0;   ///< Visibility is tested at least this often along a curve.
  double shortest_px = 0.01;  ///< Visible parts shorter than this are dropped.
};

/// The visible parts within the picture, in order of the curves and along them. Visibility is tested between all places where it may
/// change (crossings with silhouettes in the image, cusps, ends of creases, other objects' surfaces, the picture's frame) and bisected
/// between tests that differ.
std::vector<TracedCurve> visible_parts(const std::vector<TracedCurve>& curves, const CurveScene& scene, const VisibilitySettings& settings,
                                       const ExecutionSettings& how);

/// Thinned to what `tolerance_px` needs (no step longer than 8 px, so that curvatures stay sampled) and turned so that what a curve bounds
/// lies on its left. `origin` (world) is solver space's.
BorderCurves border_of(const std::vector<TracedCurve>& parts, double tolerance_px, const glm::dvec3& origin);

/// What is seen at image points: `ink` 1 where the surface is hit and N.V is below the threshold.
using SeenInk = std::function<void(std::span<const glm::dvec2> points_px, std::span<std::uint8_t> ink)>;

struct Coverage {
  Image<float> share{};
  std::int64_t touched = 0;   ///< Pixels that a curve goes through.
  std::int64_t disputed = 0;  ///< Pairs of neighbours no curve touches, of different ink: a border that no curve accounts for.
};

/// The share of each pixel that is ink. Regions of pixels without a curve are what their pixels' centres are (looked at
/// on a lattice, all of them where those disagree); the others are cut into trapezoids at the curves,
/// each being what the middle of it is: exact for polylines, so the error is that of the curves, about their bound times their length.
Coverage coverage_of(const BorderCurves& border, int width_px, int height_px, const SeenInk& seen, const ExecutionSettings& how);

/// On the chord of a step, with what is known of its nearer end.
TracedPoint chord_point(const TracedCurve& curve, size_t i, double t, const Camera& camera);

/// Truth of scenes whose objects are fields and cages, and of all others.
BorderTruth solve_truth_traced(const Scene& scene, const Camera& camera, const TruthSettings& settings, const ExecutionSettings& how);
BorderTruth solve_truth_by_proxy(const Scene& scene, const Camera& camera, const TruthSettings& settings, const ExecutionSettings& how);

}  // namespace limn
