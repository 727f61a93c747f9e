// A metric, for the test of this folder: how much ink there is.

#include <numeric>

#include "raymarch/metric.h"

namespace limn {
namespace {

std::vector<MetricValue> measure(const MetricInput& input) {
  const auto& ink = input.picture.border.pixels;
  return {{"trial_ink", std::accumulate(ink.begin(), ink.end(), 0.0), "px"}};
}

}  // namespace

Metric trial_metric() { return {{"trial", "pixels of ink, on trial", "limn"}, {"trial_ink [px]"}, true, measure, MetricSubject::ink}; }

}  // namespace limn
