// What theory expects: the position's error is a chord's, the border moves by s c eps / kr for an error eps of the normal's angle.

#include <algorithm>
#include <cmath>

#include "samples/plan/plan.h"
#include "sdf/quantile.h"

namespace limn {
namespace {

/// The 95th percentile; 0 of nothing.
double upper_part(std::vector<double> values) { return values.empty() ? 0.0 : lower_quantile(std::move(values), 0.95); }

// Where the surface has a crease its place is right to a part of an edge or voxel: the corner is cut.
constexpr double kCreaseShare = 0.25;

}  // namespace

BorderErrors predict_errors(const Ladder& ladder, size_t rung, const PlanView& view, double threshold) {
  const double size = ladder.size_at(rung);
  std::vector<double> silhouette, inner;
  for (const BorderCurve& curve : view.truth.curves.curves) {
    for (const BorderPoint& point : curve.points) {
      const double scale = pixels_per_unit_at(view.camera, point.depth);
      const double curvature = point.radial_curvature;
      const bool smooth = std::isfinite(curvature);
      // A mesh's vertices and a grid's values hold creases as well as their edges run along them: a mesh's do, a grid's do not.
      const double position = smooth            ? scale * std::abs(curvature) * size * size / 8.0
                              : ladder.by_level ? 0.0
                                                : scale * kCreaseShare * size;
      if (curve.kind == CurveKind::silhouette) {
        silhouette.push_back(position);
        continue;
      }
      if (!smooth) {
        inner.push_back(position);
        continue;
      }
      const double angle = ladder.normal_constant * std::pow(std::abs(curvature) * size, ladder.normal_order);
      const double shift = curvature != 0.0 ? scale * threshold * angle / std::abs(curvature) : 0.0;
      inner.push_back(position * std::sqrt(std::max(0.0, 1.0 - threshold * threshold)) + shift);
    }
  }
  return {upper_part(std::move(silhouette)), upper_part(std::move(inner))};
}

}  // namespace limn
