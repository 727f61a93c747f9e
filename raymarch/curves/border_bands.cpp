#include "raymarch/curves/border_bands.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace limn {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

double BorderBands::ink_px(const BorderSample& sample, double reach_px) const {
  if (sample.kind == CurveKind::silhouette) return kInfinity;
  const std::optional<NearestPoint> nearest = silhouettes_.nearest(sample.px, 0, reach_px);
  return std::min(nearest ? nearest->distance_px : kInfinity, across(sample, reach_px, 1.0));
}

double BorderBands::clear_px(const BorderSample& sample, double reach_px) const {
  return sample.kind == CurveKind::silhouette ? kInfinity : across(sample, reach_px, -1.0);
}

double BorderBands::fold_px(const BorderSample& sample, double reach_px) const {
  if (sample.kind != CurveKind::silhouette) return kInfinity;
  const std::optional<NearestPoint> nearest = silhouettes_.nearest(sample.px, sample.object, reach_px, sample.outward);
  return nearest ? nearest->distance_px : kInfinity;
}

double BorderBands::across(const BorderSample& sample, double reach_px, double inward) const {
  const std::optional<CurveMeeting> opposite = all_.meeting(sample.px, -sample.outward, 0, reach_px);
  return opposite && inward * opposite->along_px >= 0.0 ? std::abs(opposite->along_px) : kInfinity;
}

}  // namespace limn
