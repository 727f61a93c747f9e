#include "raymarch/metric/border_prediction.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "raymarch/border/contour_distance.h"
#include "raymarch/curves/border_width.h"
#include "raymarch/metric/solved_shift.h"

namespace limn {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
/// Larger displacements are not held against the theory place by place.
constexpr double kSmall_px = 2.0;
constexpr double kFloor_px = 0.01;

/// A truth curve at one of its samples.
struct TruthPoint {
  glm::dvec3 position{0.0}, normal{0.0};
  double n_dot_v = 0.0;  ///< Of the curve's own points, not of the chord between.
  double radial_curvature = 0.0;
};

TruthPoint truth_at(const BorderCurves& curves, const BorderSample& sample, const Camera& camera) {
  const BorderCurve& curve = curves.curves[sample.curve];
  const BorderPoint &a = curve.points[sample.segment], &b = curve.points[(sample.segment + 1) % curve.points.size()];
  const double s = sample.fraction;
  const auto cosine = [&](const BorderPoint& point) { return glm::dot(point.normal, view_vector(camera, point.position)); };
  return {a.position + s * (b.position - a.position), glm::normalize(a.normal + s * (b.normal - a.normal)),
          cosine(a) + s * (cosine(b) - cosine(a)), a.radial_curvature + s * (b.radial_curvature - a.radial_curvature)};
}

struct Pair {
  double weight = 0.0, predicted = 0.0, measured = 0.0;
};

struct Moments {
  double length = 0.0, predicted_mean = 0.0, measured_mean = 0.0, predicted_rms = 0.0, measured_rms = 0.0, error_rms = 0.0;
  double correlation = kNothing;
};

Moments moments(const std::vector<Pair>& pairs) {
  Moments sum;
  double product = 0.0;
  for (const Pair& pair : pairs) {
    const double error = pair.predicted - pair.measured;
    sum.length += pair.weight;
    sum.predicted_mean += pair.weight * pair.predicted;
    sum.measured_mean += pair.weight * pair.measured;
    sum.predicted_rms += pair.weight * pair.predicted * pair.predicted;
    sum.measured_rms += pair.weight * pair.measured * pair.measured;
    sum.error_rms += pair.weight * error * error;
    product += pair.weight * pair.predicted * pair.measured;
  }
  const double length = sum.length;
  if (!(length > 0.0)) return {0.0, kNothing, kNothing, kNothing, kNothing, kNothing, kNothing};
  Moments result{length,
                 sum.predicted_mean / length,
                 sum.measured_mean / length,
                 std::sqrt(sum.predicted_rms / length),
                 std::sqrt(sum.measured_rms / length),
                 std::sqrt(sum.error_rms / length),
                 kNothing};
  const double p = sum.predicted_rms / length - result.predicted_mean * result.predicted_mean;
  const double m = sum.measured_rms / length - result.measured_mean * result.measured_mean;
  if (p > 0.0 && m > 0.0) result.correlation = (product / length - result.predicted_mean * result.measured_mean) / std::sqrt(p * m);
  return result;
}

/// Of one kind of true border, within the picture.
std::vector<MatchedSample> matched_samples(const BorderMatch& match, CurveKind kind) {
  std::vector<MatchedSample> samples;
  std::copy_if(match.truth.begin(), match.truth.end(), std::back_inserter(samples),
               [&](const MatchedSample& sample) { return sample.inside && sample.at.kind == kind; });
  return samples;
}

double length_of(const std::vector<MatchedSample>& samples) {
  double length = 0.0;
  for (const MatchedSample& sample : samples) length += sample.at.weight_px;
  return length;
}

double share_within_quarter(const std::vector<Pair>& pairs) {
  double small = 0.0, good = 0.0;
  for (const Pair& pair : pairs) {
    if (std::abs(pair.measured) >= kSmall_px) continue;
    small += pair.weight;
    if (std::abs(pair.predicted - pair.measured) <= std::max(0.25 * std::abs(pair.measured), kFloor_px)) good += pair.weight;
  }
  return small > 0.0 ? good / small : kNothing;
}

/// A line for each sample whose curvature the truth knows, and which sample it is of.
struct Lines {
  std::vector<ShiftLine> lines{};
  std::vector<size_t> samples{};
};

Lines lines_across(const std::vector<MatchedSample>& samples, const BorderCurves& truth, const Camera& camera) {
  Lines found;
  for (size_t i = 0; i < samples.size(); ++i) {
    const BorderSample& sample = samples[i].at;
    const double px_per_radian = displacement_per_radian(camera, truth, sample);
    if (!std::isfinite(px_per_radian)) continue;
    const TruthPoint point = truth_at(truth, sample, camera);
    const double depth = -glm::dot(point.position - camera.eye, camera.world_from_camera[2]);
    found.lines.push_back({sample.px, sample.outward, point.position, pixels_per_unit_at(camera, depth), sample.object, point.n_dot_v,
                           px_per_radian, sample.curve});
    found.samples.push_back(i);
  }
  return found;
}

/// Root mean squares over what was predicted and measured.
struct ShiftSums {
  double length = 0.0, normal_error = 0.0, first_order = 0.0, low = 0.0, high = 0.0;

  /// `bound_px`: how far the true border itself may be off.
  void add(double length_px, const SolvedShift& shift, double bound_px) {
    const auto square = [](double x) { return x * x; };
    const double moved = std::abs(shift.shift_px), uncertainty = shift.uncertainty_px + bound_px;
    length += length_px;
    normal_error += length_px * square(shift.normal_error);
    first_order += length_px * square(shift.first_order_px);
    low += length_px * square(std::max(0.0, moved - uncertainty));
    high += length_px * square(moved + uncertainty);
  }
  double root_mean(double sum) const { return length > 0.0 ? std::sqrt(sum / length) : kNothing; }
};

/// The share of the border where each assumption fails.
void count_faults(const std::vector<MatchedSample>& samples, const Lines& across, const std::vector<SolvedShift>& shifts,
                  DisplacementPrediction& result) {
  const double length = length_of(samples);
  if (!(length > 0.0)) return;
  result.outside = result.ends = result.turns_back = 0.0;
  for (size_t k = 0; k < shifts.size(); ++k) {
    const double share = samples[across.samples[k]].at.weight_px / length;
    if (shifts[k].fault == ShiftFault::outside) result.outside += share;
    if (shifts[k].fault == ShiftFault::covered) result.ends += share;
    if (shifts[k].fault == ShiftFault::turns_back) result.turns_back += share;
  }
}

DisplacementPrediction predict_displacement(const SceneModel& model, const Camera& camera, const BorderTruth& truth,
                                            const BorderMatch& match) {
  const std::vector<MatchedSample> samples = matched_samples(match, CurveKind::inner);
  const Lines across = lines_across(samples, truth.curves, camera);
  const std::vector<SolvedShift> shifts = solve_shifts(model, camera, across.lines, search_reach_px(camera));
  std::vector<Pair> pairs;
  ShiftSums sums;
  for (size_t k = 0; k < shifts.size(); ++k) {
    const MatchedSample& sample = samples[across.samples[k]];
    // What a model's error is not measured at (raymarch/curves/border_match.h) says nothing of a prediction either.
    if (shifts[k].fault != ShiftFault::none || !sample.displacement_px || sample.ill != IllReason::none) continue;
    pairs.push_back({sample.at.weight_px, shifts[k].shift_px, *sample.displacement_px});
    sums.add(sample.at.weight_px, shifts[k], truth.bound_px);
  }
  const Moments all = moments(pairs);
  DisplacementPrediction result;
  result.samples = static_cast<int>(pairs.size());
  if (!samples.empty()) result.covered = all.length / length_of(samples);
  count_faults(samples, across, shifts, result);
  result.normal_error_rms = sums.root_mean(sums.normal_error);
  result.first_order_rms_px = sums.root_mean(sums.first_order);
  result.low_px = sums.root_mean(sums.low);
  result.high_px = sums.root_mean(sums.high);
  result.predicted_mean_px = all.predicted_mean;
  result.measured_mean_px = all.measured_mean;
  result.predicted_rms_px = all.predicted_rms;
  result.measured_rms_px = all.measured_rms;
  result.error_rms_px = all.error_rms;
  result.correlation = all.correlation;
  result.within_quarter = share_within_quarter(pairs);
  return result;
}

/// Pixels for each radian about the eye, at an image point and in a direction of the image.
double pixels_per_radian(const Camera& camera, const glm::dvec2& px, const glm::dvec2& direction) {
  const glm::dvec2 offset = px - 0.5 * glm::dvec2(camera.width_px, camera.height_px);
  const double cosine = camera.focal_px / std::hypot(camera.focal_px, glm::length(offset));
  const double off = glm::length(offset), radial = off > 0.0 ? glm::dot(direction, offset) / off : 0.0;
  return camera.focal_px / (cosine * std::sqrt(std::max(0.0, 1.0 - radial * radial) + radial * radial * cosine * cosine));
}

struct Width {
  double plain_px = kNothing, exact_px = kNothing;
};

Width predicted_width(const Camera& camera, const BorderSample& sample, const TruthPoint& point, double threshold) {
  const double k = point.radial_curvature, sine = std::sqrt(1.0 - threshold * threshold);
  if (!(k > 0.0)) return {};
  const double plain = 0.5 * threshold * threshold / k;
  if (camera.projection == Projection::orthographic) {
    return {camera.pixels_per_unit * plain, camera.pixels_per_unit * threshold * threshold / (1.0 + sine) / k};
  }
  const double distance = glm::length(point.position - camera.eye), scale = pixels_per_radian(camera, sample.px, sample.outward);
  const double slope = k * distance;
  const double angle = std::acos(std::min(1.0, sine / std::hypot(1.0, slope))) - std::atan(slope);
  return {scale * plain / distance, scale * angle};
}

/// Of the level curves: what they were solved for.
double threshold_of(const BorderTruth& truth, const Camera& camera) {
  for (const BorderCurve& curve : truth.curves.curves) {
    if (curve.kind != CurveKind::inner) continue;
    for (const BorderPoint& point : curve.points) {
      if (std::isfinite(point.radial_curvature)) return glm::dot(point.normal, view_vector(camera, point.position));
    }
  }
  return kNothing;
}

WidthPrediction predict_width(const Camera& camera, const BorderTruth& truth, const BorderCurves& curves, const BorderMatch& match) {
  const std::vector<MatchedSample> samples = matched_samples(match, CurveKind::silhouette);
  const CurveIndex inner(curves, CurveKind::inner, kContinue_px), silhouettes(curves, CurveKind::silhouette);
  const double threshold = threshold_of(truth, camera);
  std::vector<Pair> pairs;
  double plain = 0.0;
  for (const MatchedSample& sample : samples) {
    const Width predicted = predicted_width(camera, sample.at, truth_at(truth.curves, sample.at, camera), threshold);
    if (!std::isfinite(predicted.exact_px) || !sample.displacement_px) continue;
    BorderSample own = sample.at;
    own.px += *sample.displacement_px * own.outward;
    const std::optional<double> width = border_width_px(own, inner, silhouettes, width_reach_px(camera));
    if (!width) continue;
    pairs.push_back({own.weight_px, predicted.exact_px, *width});
    plain += own.weight_px * predicted.plain_px;
  }
  const Moments all = moments(pairs);
  return {static_cast<int>(pairs.size()),
          samples.empty() ? kNothing : all.length / length_of(samples),
          all.length > 0.0 ? plain / all.length : kNothing,
          all.predicted_mean,
          all.measured_mean,
          all.error_rms,
          all.correlation};
}

}  // namespace

double displacement_per_radian(const Camera& camera, const BorderCurves& truth, const BorderSample& sample) {
  const TruthPoint point = truth_at(truth, sample, camera);
  const double z = -glm::dot(point.position - camera.eye, camera.world_from_camera[2]);
  const SeenPoint seen = seen_point(camera, sample.px.x, sample.px.y, z, point.normal);
  const glm::dvec2 motion = image_motion(camera, seen);
  const double turn = point.radial_curvature + point.n_dot_v / seen.distance;
  return glm::dot(glm::dvec2(motion.x, -motion.y), sample.outward) / turn;
}

BorderPrediction predict_border(const SceneModel& model, const Camera& camera, const BorderTruth& truth, const BorderCurves& curves) {
  return predict_border(model, camera, truth, curves, match_borders(truth.curves, curves, {}, camera));
}

BorderPrediction predict_border(const SceneModel& model, const Camera& camera, const BorderTruth& truth, const BorderCurves& curves,
                                const BorderMatch& match) {
  return {predict_displacement(model, camera, truth, match), predict_width(camera, truth, curves, match)};
}

}  // namespace limn
