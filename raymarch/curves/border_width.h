#pragma once
// How wide the ink is along a silhouette.

#include "raymarch/curves/curve_geometry.h"

namespace limn {

/// From a silhouette's point to the nearest inner border of the same object, inwards within 45 degrees of the normal and within `reach_px`;
/// empty where there is none, or where another silhouette of the object lies nearer to that inner point.
std::optional<double> border_width_px(const BorderSample& at, const CurveIndex& inner, const CurveIndex& silhouettes, double reach_px);

/// An eighth of the picture's diagonal: wider borders are none.
double width_reach_px(const Camera& camera);

struct WidthSample {
  BorderSample at{};
  double width_px = 0.0;
};

struct BorderWidths {
  std::vector<WidthSample> samples{};
  double missing = 0.0;  ///< Share of the silhouette that has no inner border before it.
};

/// Widths at samples each px of the silhouettes.
BorderWidths border_widths(const BorderCurves& curves, const Camera& camera);

}  // namespace limn
