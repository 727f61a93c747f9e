#pragma once
// Errors of pixels that both pictures hit: mean, root mean square, 99th percentile, largest and where it is.

#include <string>
#include <vector>

#include "raymarch/metric.h"
#include "sdf/error.h"

namespace limn {

struct PixelError {
  int x = 0, y = 0;
  double value = 0.0;
};

/// `<name>_mean`, `<name>_rms`, `<name>_p99`, `<name>_max` in `unit`, then `<name>_max_x`, `<name>_max_y` in pixels (the first of equals in
/// reading order). All NaN where `errors` is empty. The percentile is the smallest value that at least 99 % of the pixels do not exceed.
std::vector<MetricValue> summarise_errors(std::vector<PixelError> errors, const std::string& name, const std::string& unit);
/// The names of those values, for Metric::values.
std::vector<std::string> summary_names(const std::string& name, const std::string& unit);

/// True where both pictures hit something.
bool both_hit(const MetricInput& input, size_t pixel);

/// The summary of `error(pixel index)` over the pixels that both pictures hit.
template <class Error>
std::vector<MetricValue> measure_pixels(const MetricInput& input, const std::string& name, const std::string& unit, const Error& error) {
  const GBuffer& seen = input.picture.gbuffer;
  LIMN_CHECK(seen.width == input.reference.gbuffer.width && seen.height == input.reference.gbuffer.height);
  std::vector<PixelError> errors;
  for (int y = 0; y < seen.height; ++y) {
    for (int x = 0; x < seen.width; ++x) {
      const size_t i = seen.id.index(x, y);
      if (both_hit(input, i)) errors.push_back({x, y, error(i)});
    }
  }
  return summarise_errors(std::move(errors), name, unit);
}

}  // namespace limn
