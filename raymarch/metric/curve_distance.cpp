// Distances between the model's border and the true one as sets of points: the largest (Hausdorff) and the mean.

#include <algorithm>
#include <cmath>

#include "raymarch/curves/curve_geometry.h"
#include "raymarch/metric/curve_findings.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
/// Of the samples along curves: the largest distance is found to half of this.
constexpr double kStep_px = 0.25;

/// Of both kinds together, of silhouettes, of inner borders.
constexpr size_t kSubjects = 3;
const char* const kSuffixes[kSubjects] = {"", "_silhouette", "_inner"};

void add(const BorderSample& sample, double distance_px, CurveDistances& to) {
  const double distance = std::isfinite(distance_px) ? distance_px : kNothing;
  to.largest = std::max(distance, to.largest);
  to.sum += sample.weight_px * distance;
  to.length += sample.weight_px;
}

std::array<CurveDistances, kSubjects> from_to(const BorderCurves& from, const BorderCurves& to, const Camera& camera) {
  const CurveIndex index(to, {});
  std::array<CurveDistances, kSubjects> result;
  const std::vector<BorderSample> samples = within_picture(resample(from, {}, kStep_px), camera);
  std::vector<NearestDistances> nearest(samples.size());
  parallel_parts(samples.size(), size_t{256}, [&](const IndexRange<size_t>& part) {
    for (size_t i = part.first; i < part.last; ++i) nearest[i] = index.nearest_distances(samples[i].px, samples[i].kind);
  });
  // One after the other, so that sums do not depend on threads.
  for (size_t i = 0; i < samples.size(); ++i) {
    add(samples[i], nearest[i].any_px, result[0]);
    add(samples[i], nearest[i].of_kind_px, result[samples[i].kind == CurveKind::silhouette ? 1 : 2]);
  }
  return result;
}

const BothWays& find_distances(const MetricInput& input, size_t subject, CurveFindings& findings) {
  std::optional<BothWays>& found = findings.distances[subject];
  if (!found) {
    const auto there = from_to(*input.curves, input.truth->curves, input.camera),
               back = from_to(input.truth->curves, *input.curves, input.camera);
    for (size_t k = 0; k < kSubjects; ++k) findings.distances[k] = {there[k], back[k]};
  }
  return *found;
}

template <class Combine>
std::vector<MetricValue> measure(const MetricInput& input, const std::string& name, const Combine& combine) {
  std::vector<MetricValue> values;
  CurveFindings own, &findings = findings_of(input, own);
  for (size_t k = 0; k < kSubjects; ++k) {
    double value = kNothing;
    if (input.curves != nullptr && input.truth != nullptr) {
      const auto& [there, back] = find_distances(input, k, findings);
      if (there.length > 0.0 && back.length > 0.0) value = combine(there, back);
    }
    values.push_back({name + kSuffixes[k], value, "px"});
  }
  return values;
}

std::vector<std::string> names_of(const std::string& name) {
  std::vector<std::string> names;
  for (const char* suffix : kSuffixes) names.push_back(name + suffix + " [px]");
  return names;
}

}  // namespace

Metric hausdorff_metric() {
  return {{"hausdorff",
           "largest distance from a point of the one border to the other border, both ways: all of it, silhouette alone, inner alone",
           "Hausdorff 1914; Huttenlocher, Klanderman, Rucklidge 1993"},
          names_of("hausdorff"),
          true,
          [](const MetricInput& input) {
            return measure(input, "hausdorff",
                           [](const CurveDistances& a, const CurveDistances& b) { return std::max(a.largest, b.largest); });
          },
          MetricSubject::curves};
}

Metric mean_distance_metric() {
  return {{"mean_distance", "mean distance from the points of the one border to the other border, both ways averaged",
           "Dubuisson and Jain 1994"},
          names_of("mean_distance"),
          true,
          [](const MetricInput& input) {
            return measure(input, "mean_distance",
                           [](const CurveDistances& a, const CurveDistances& b) { return 0.5 * (a.sum / a.length + b.sum / b.length); });
          },
          MetricSubject::curves};
}

}  // namespace limn
