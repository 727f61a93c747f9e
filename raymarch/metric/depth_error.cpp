// The difference of depth along the view axis, over the pixels that both pictures hit.

#include <cmath>

#include "raymarch/metric.h"
#include "raymarch/metric/error_summary.h"

namespace limn {
namespace {

std::vector<MetricValue> measure(const MetricInput& input) {
  const Image<float>&depth = input.picture.gbuffer.depth, &reference = input.reference.gbuffer.depth;
  return measure_pixels(input, "depth_error", "world",
                        [&](size_t i) { return std::abs(double{depth.pixels[i]} - double{reference.pixels[i]}); });
}

}  // namespace

Metric depth_error_metric() {
  return {{"depth_error", "difference of depth where both pictures hit: mean, root mean square, 99th percentile, largest and its pixel",
           "limn"},
          summary_names("depth_error", "world"),
          true,
          measure};
}

}  // namespace limn
