// Distances between the model's border and the true one as sets of points: the largest (Hausdorff) and the mean.

#include <algorithm>
#include <cmath>

#include "raymarch/curves/curve_geometry.h"
#include "raymarch/metric/curve_findings.h"

namespace limn {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
/// Of the samples along curves: the largest distance is found to half of this.
constexpr double kStep_px = 0.25;

CurveDistances from_to(const BorderCurves& from, const BorderCurves& to, std::optional<CurveKind> kind, const Camera& camera) {
  const CurveIndex index(to, kind);
  CurveDistances result;
  for (const CurveSample& sample : within_picture(resample(from, kind, kStep_px), camera)) {
    const std::optional<NearestPoint> nearest = index.nearest(sample.px, 0, std::numeric_limits<double>::infinity());
    const double distance = nearest ? nearest->distance_px : kNothing;
    result.largest = std::max(distance, result.largest);
    result.sum += sample.weight_px * distance;
    result.length += sample.weight_px;
  }
  return result;
}

struct Subject {
  const char* suffix;
  std::optional<CurveKind> kind;
};
const Subject kSubjects[] = {{"", std::nullopt}, {"_silhouette", CurveKind::silhouette}, {"_inner", CurveKind::inner}};

const BothWays& find_distances(const MetricInput& input, size_t subject, CurveFindings& findings) {
  std::optional<BothWays>& found = findings.distances[subject];
  const std::optional<CurveKind> kind = kSubjects[subject].kind;
  if (!found)
    found = {from_to(*input.curves, input.truth->curves, kind, input.camera),
             from_to(input.truth->curves, *input.curves, kind, input.camera)};
  return *found;
}

template <class Combine>
std::vector<MetricValue> measure(const MetricInput& input, const std::string& name, const Combine& combine) {
  std::vector<MetricValue> values;
  CurveFindings own, &findings = findings_of(input, own);
  for (size_t k = 0; k < std::size(kSubjects); ++k) {
    double value = kNothing;
    if (input.curves != nullptr && input.truth != nullptr) {
      const auto& [there, back] = find_distances(input, k, findings);
      if (there.length > 0.0 && back.length > 0.0) value = combine(there, back);
    }
    values.push_back({name + kSubjects[k].suffix, value, "px"});
  }
  return values;
}

std::vector<std::string> names_of(const std::string& name) {
  std::vector<std::string> names;
  for (const Subject& subject : kSubjects) names.push_back(name + subject.suffix + " [px]");
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
