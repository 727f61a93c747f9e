// The translation that explains the displacements best.

#include <algorithm>
#include <cmath>

#include "samples/judge/matching.h"
#include "sdf/quantile.h"

namespace limn {
namespace {

/// Displacements within so many pixels of a line count as one observation: neighbours err alike.
constexpr double kCluster_px = 10.0;
constexpr double kStandardErrors = 4.0;

/// A matched sample: how far it lies off across the line, whose normal is `normal`.
struct Observation {
  glm::dvec2 normal{0.0};
  double across_px = 0.0;
  double weight = 0.0;
  std::int64_t cluster = 0;
};

std::vector<Observation> observations(const Tracks& visible, const std::vector<TrackMatch>& matches, const std::vector<bool>& crowded) {
  std::vector<Observation> all;
  std::int64_t base = 0;
  for (const Track& track : visible.tracks) {
    for (int k = 0; k < track.count; ++k) {
      const auto i = static_cast<size_t>(track.first) + static_cast<size_t>(k);
      // Where it looks past an end, the distance is not one across the line.
      if (!matches[i].found || crowded[i] || std::fabs(matches[i].along_px) > 0.05) continue;
      const TrackSample& sample = visible.samples[i];
      all.push_back({{-sample.tangent.y, sample.tangent.x},
                     matches[i].across_px,
                     sample.length_px,
                     base + static_cast<std::int64_t>(k * track.step() / kCluster_px)});
    }
    base += 1 + static_cast<std::int64_t>(track.length() / kCluster_px);
  }
  return all;
}

/// Of a symmetric 2 x 2 matrix; directions that no line tells anything about stay 0.
glm::dmat2 pseudo_inverse(const glm::dmat2& m) {
  const double mean = 0.5 * (m[0].x + m[1].y), half = 0.5 * (m[0].x - m[1].y), r = std::hypot(half, m[0].y);
  const double angle = 0.5 * std::atan2(m[0].y, half);
  const glm::dvec2 axis(std::cos(angle), std::sin(angle)), other(-axis.y, axis.x);
  glm::dmat2 result(0.0);
  constexpr double kLeastShare = 1e-3;
  if (mean + r > 0.0) result += glm::outerProduct(axis, axis) / (mean + r);
  if (mean - r > kLeastShare * (mean + r)) result += glm::outerProduct(other, other) / (mean - r);
  return result;
}

/// Weights of Huber (1964), "Robust estimation of a location parameter", with the scale from the median residual.
std::vector<double> robust_weights(const std::vector<Observation>& all, const glm::dvec2& shift) {
  std::vector<double> residuals;
  residuals.reserve(all.size());
  for (const Observation& one : all) residuals.push_back(std::fabs(one.across_px - glm::dot(one.normal, shift)));
  const double limit = 1.345 * std::max(1e-3, 1.4826 * upper_median(residuals));
  std::vector<double> weights;
  weights.reserve(all.size());
  for (size_t i = 0; i < all.size(); ++i) weights.push_back(all[i].weight * (residuals[i] > limit ? limit / residuals[i] : 1.0));
  return weights;
}

}  // namespace

DrawingShift fit_shift(const Tracks& visible, const std::vector<TrackMatch>& matches, const std::vector<bool>& crowded,
                       double precision_px) {
  const std::vector<Observation> all = observations(visible, matches, crowded);
  DrawingShift shift;
  if (all.empty()) return shift;
  std::vector<double> weights;
  glm::dmat2 inverse(0.0);
  constexpr int kRounds = 10;
  for (int round = 0; round < kRounds; ++round) {
    weights = robust_weights(all, shift.px);
    glm::dmat2 normal_matrix(0.0);
    glm::dvec2 right(0.0);
    for (size_t i = 0; i < all.size(); ++i) {
      normal_matrix += weights[i] * glm::outerProduct(all[i].normal, all[i].normal);
      right += weights[i] * all[i].across_px * all[i].normal;
    }
    inverse = pseudo_inverse(normal_matrix);
    shift.px = inverse * right;
  }
  // Standard errors of clustered observations (Liang and Zeger 1986, "Longitudinal data analysis using generalized linear models").
  glm::dmat2 spread(0.0);
  glm::dvec2 sum(0.0);
  for (size_t i = 0; i < all.size(); ++i) {
    sum += weights[i] * (all[i].across_px - glm::dot(all[i].normal, shift.px)) * all[i].normal;
    if (i + 1 < all.size() && all[i + 1].cluster == all[i].cluster) continue;
    spread += glm::outerProduct(sum, sum);
    sum = glm::dvec2(0.0);
  }
  const glm::dmat2 covariance = inverse * spread * inverse;
  shift.size_px = glm::length(shift.px);
  const glm::dvec2 direction = shift.size_px > 0.0 ? shift.px / shift.size_px : glm::dvec2(1.0, 0.0);
  shift.error_px = std::sqrt(std::max(0.0, glm::dot(direction, covariance * direction)));
  shift.significant = shift.size_px > std::max(precision_px, kStandardErrors * shift.error_px);
  return shift;
}

}  // namespace limn
