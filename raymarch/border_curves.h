#pragma once
// The border as curves in the image at sub-pixel precision: what truth is solved as, and what a model's border is measured as.

#include <glm/glm.hpp>
#include <limits>
#include <vector>

namespace limn {

/// silhouette: the nearer sheet of surface ends (its contour generator, or a crease on which it turns away). inner: N.V crosses the rim's
/// threshold on a sheet that goes on, or jumps across it at a crease.
enum class CurveKind { silhouette, inner };

/// A point of a border curve. What the maker does not know stays NaN; a measured border knows image points and depth only.
struct BorderPoint {
  glm::dvec2 px{0.0};                                             ///< Image point (sdf/image.h).
  double depth = std::numeric_limits<double>::quiet_NaN();        ///< Z of the nearer sheet, world units.
  glm::dvec3 position{std::numeric_limits<double>::quiet_NaN()};  ///< World.
  glm::dvec3 normal{std::numeric_limits<double>::quiet_NaN()};    ///< World, unit; at a crease that of the covered side.
  /// Normal curvature along w = V - (N.V) N, 1 / world unit, positive on a sphere. NaN at creases.
  double radial_curvature = std::numeric_limits<double>::quiet_NaN();
};

/// A polyline. Walking along it, what it bounds lies to the left as seen on the screen: the object's nearer sheet for a silhouette, the ink
/// (N.V below the threshold) for an inner border. So the outward normal of a step (dx, dy), y down, is (-dy, dx).
struct BorderCurve {
  CurveKind kind = CurveKind::silhouette;  ///< See CurveKind.
  int object = 0;                          ///< Index from 1, of the nearer sheet.
  bool closed = false;                     ///< The last point joins the first, which is not repeated.
  std::vector<BorderPoint> points{};       ///< At least two, in order along the curve.
};

/// All visible parts of a border.
struct BorderCurves {
  std::vector<BorderCurve> curves{};  ///< In the same order for equal calls.
};

/// Image length, px.
double length_px(const BorderCurve& curve);

}  // namespace limn
