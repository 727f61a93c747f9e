// What theory expects: the position's error is a chord's, and the inner border lies where the wrong N.V meets the threshold.

#include "samples/plan/predict.h"

#include <algorithm>
#include <cmath>

#include "raymarch/curves/border_bands.h"
#include "raymarch/metric/border_prediction.h"
#include "sdf/quantile.h"

namespace limn {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kStep_px = 1.0;
// Where the surface has a crease its place is right to a part of an edge or voxel: the corner is cut.
constexpr double kCreaseShare = 0.25;
// Normals are not wrong by more than this.
constexpr double kMostAngle = 0.5;
// Constants of series hold to this factor, both ways, over the scenes and cages that were tried (docs/accuracy.md).
constexpr double kNormalSpread = 3.0;

/// The distance that 95 % of the length keep to; 0 of nothing.
double upper_part(std::vector<WeightedValue> values) { return values.empty() ? 0.0 : nearest_rank_quantile_of(std::move(values), 0.95); }

/// How fast the radial curvature changes along the border, 1 / world unit squared; 0 where that is not known.
double curvature_change(const BorderPoint& a, const BorderPoint& b) {
  const double length = glm::distance(a.position, b.position), change = std::abs(b.radial_curvature - a.radial_curvature);
  return length > 0.0 && std::isfinite(change) ? change / length : 0.0;
}

/// Of a border that has no slope any error moves it as far as it can go.
double first_order_px(const BorderPlace& place, double angle) { return angle > 0.0 ? angle * place.px_per_radian : 0.0; }

/// Outwards, where N.V rises: linearly, or, before another border that faces this one, as the parabola that comes back to the threshold
/// there. Where it does not rise far enough the gap closes and all of it is wrong.
double outward_shift(const BorderPlace& place, double angle) {
  const double first_order = first_order_px(place, angle), gap = place.clear_px;
  if (!std::isfinite(gap)) return std::min(first_order, place.reach_px);
  const double left = 1.0 - 4.0 * first_order / gap;
  return left > 0.0 ? 0.5 * gap * (1.0 - std::sqrt(left)) : gap;
}

/// Inwards, to the silhouette: the square of N.V falls to 0 linearly. A border that gets there is lost with its band of ink.
double inward_shift(const BorderPlace& place, double angle, double threshold) {
  const double first_order = first_order_px(place, angle), band = place.ink_px;
  const double sine = std::sqrt(1.0 - threshold * threshold), left = 1.0 - sine * angle / threshold;
  if (left <= 0.0) return std::isfinite(band) ? band : std::min(first_order, place.reach_px);
  const double to_silhouette = first_order * (1.0 + left) / 2.0;
  return std::min({to_silhouette, band, place.reach_px});
}

/// A candidate, and N.V at the inner border.
struct Expectation {
  const ResolutionSeries& series;
  double size = 0.0, threshold = 0.0;
};

/// A chord's distance from its arc. Where the surface bends within an edge or voxel a mesh has vertices on the bend, and is off by no more
/// than its radius; a grid cuts the corner, as at a crease. A mesh's edges run along creases, a grid's do not.
double position_error(const Expectation& of, const BorderPlace& place, double factor) {
  const double cut = of.series.by_level ? 0.0 : kCreaseShare * of.size;
  if (!std::isfinite(place.curvature)) return factor * place.px_per_unit * cut;
  const double chord = place.curvature * of.size * of.size / 8.0, most = of.series.by_level ? 1.0 / place.curvature : cut;
  return factor * place.px_per_unit * std::min(chord, most);
}

/// Of the normal, radians. Where the radial curvature passes through 0 its change along the border says how the surface bends.
double normal_error(const Expectation& of, const BorderPlace& place, double factor) {
  const double bend = std::max(place.curvature, std::sqrt(place.curvature_change));
  return std::min(kMostAngle, factor * of.series.normal_constant * std::pow(bend * of.size, of.series.normal_order));
}

BorderErrors errors_for(const Expectation& of, const std::vector<BorderPlace>& places, double factor) {
  std::vector<WeightedValue> silhouette, inner;
  const double sine = std::sqrt(std::max(0.0, 1.0 - of.threshold * of.threshold));
  for (const BorderPlace& place : places) {
    const double position = position_error(of, place, factor);
    if (place.kind == CurveKind::silhouette) {
      silhouette.push_back({position, place.weight_px});
    } else if (!std::isfinite(place.curvature)) {
      inner.push_back({position, place.weight_px});
    } else {
      const double angle = normal_error(of, place, factor);
      inner.push_back({std::min(place.clear_px, position * sine + outward_shift(place, angle)), 0.5 * place.weight_px});
      inner.push_back({std::min(place.ink_px, position * sine + inward_shift(place, angle, of.threshold)), 0.5 * place.weight_px});
    }
  }
  std::vector<WeightedValue> both = silhouette;
  both.insert(both.end(), inner.begin(), inner.end());
  return {upper_part(std::move(silhouette)), upper_part(std::move(inner)), upper_part(std::move(both))};
}

}  // namespace

std::vector<BorderPlace> border_places(const PlanView& view) {
  const BorderCurves& curves = view.truth.curves;
  const BorderBands bands(curves);
  const double reach_px = search_reach_px(view.camera);
  std::vector<BorderPlace> places;
  for (const BorderSample& sample : resample(curves, {}, kStep_px)) {
    const BorderCurve& curve = curves.curves[sample.curve];
    const BorderPoint &a = curve.points[sample.segment], &b = curve.points[(sample.segment + 1) % curve.points.size()];
    BorderPlace place;
    place.kind = sample.kind;
    place.weight_px = sample.weight_px;
    place.reach_px = reach_px;
    place.px_per_unit = pixels_per_unit_at(view.camera, sample.fraction < 0.5 ? a.depth : b.depth);
    place.curvature = std::abs(a.radial_curvature + sample.fraction * (b.radial_curvature - a.radial_curvature));
    place.curvature_change = curvature_change(a, b);
    if (sample.kind == CurveKind::inner) {
      const double slope = displacement_per_radian(view.camera, curves, sample);
      place.px_per_radian = std::isfinite(slope) && slope > 0.0 ? slope : kInfinity;
      place.ink_px = bands.ink_px(sample, reach_px);
      place.clear_px = bands.clear_px(sample, reach_px);
    }
    places.push_back(place);
  }
  return places;
}

BorderErrors expected_errors(const ResolutionSeries& series, size_t candidate, const std::vector<BorderPlace>& places, double threshold) {
  return errors_for({series, series.size_at(candidate), threshold}, places, 1.0);
}

PredictedErrors predict_errors(const ResolutionSeries& series, size_t candidate, const std::vector<BorderPlace>& places, double threshold) {
  const Expectation of{series, series.size_at(candidate), threshold};
  return {errors_for(of, places, 1.0), errors_for(of, places, 1.0 / kNormalSpread), errors_for(of, places, kNormalSpread)};
}

}  // namespace limn
