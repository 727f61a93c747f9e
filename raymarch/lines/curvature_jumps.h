#pragma once
// Internal: cusps where a contour goes over from one face to another of another curvature, without an edge between them.

#include <optional>

#include "raymarch/lines/surface_curves.h"

namespace limn {

/// Two samples of a contour between which its radial curvature changes sign; `after` may count on beyond the last sample of a closed one.
struct CurvatureChange {
  const SurfaceCurve& curve;
  size_t before = 0, after = 0;
  const Camera& camera;
};

struct CurvatureJump {
  /// How many more lie in front of the contour after the change than before it: 1 or -1. Nothing where the contour runs along the line
  /// that the faces share, or the line of sight does: then rounding would say which of them is in front.
  std::optional<int> layers{};
  double t = 0.0;  ///< Where between the two samples: where both arms lead.
};

/// Nothing where the curvature goes through zero, as at a common cusp.
///
/// Of the two faces one lies on the eye's side along the line of sight. Is it the one of positive curvature, that line comes out of the
/// surface there, and the contour on the other face lies behind that place; is it the other, the line goes in there, and the contour on the
/// face of positive curvature lies behind it. Where the faces meet follows from the contours: the shape operators S of two faces that share
/// their normals along a line differ by a multiple of w w^T, w across that line; with v the line of sight, the contour runs across S v.
std::optional<CurvatureJump> jump_at(const CurvatureChange& change);

}  // namespace limn
