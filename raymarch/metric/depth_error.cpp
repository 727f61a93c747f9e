// The difference of depth along the view axis, over the pixels that both pictures hit.

#include <cmath>

#include "raymarch/metric/error_summary.h"
#include "raymarch/metric/registry.h"
#include "sdf/error.h"

namespace limn {
namespace {

std::vector<MetricValue> measure(const MetricInput& input) {
  const GBuffer& seen = input.picture.gbuffer;
  LIMN_CHECK(seen.width == input.reference.gbuffer.width && seen.height == input.reference.gbuffer.height);
  std::vector<PixelError> errors;
  for (int y = 0; y < seen.height; ++y) {
    for (int x = 0; x < seen.width; ++x) {
      const size_t i = seen.id.index(x, y);
      if (both_hit(input, i))
        errors.push_back({x, y, std::abs(double{seen.depth.pixels[i]} - double{input.reference.gbuffer.depth.pixels[i]})});
    }
  }
  return summarise_errors(std::move(errors), "depth_error", "world");
}

}  // namespace

Metric depth_error_metric() {
  return {{"depth_error", "difference of depth where both pictures hit: mean, 99th percentile, largest and its pixel", "limn"},
          summary_names("depth_error", "world"),
          true,
          measure};
}

}  // namespace limn
