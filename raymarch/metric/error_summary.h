#pragma once
// Errors of pixels that both pictures hit: mean, root mean square, 99th percentile, largest and where it is.

#include <string>
#include <vector>

#include "raymarch/metric.h"
#include "sdf/error.h"

namespace limn {

/// Errors of pixels, in reading order.
struct PixelErrors {
  std::vector<double> values{};
  std::vector<size_t> pixels{};  ///< Their numbers in a picture.
};

/// `<name>_mean`, `<name>_rms`, `<name>_p99`, `<name>_max` in `unit`, then `<name>_max_x`, `<name>_max_y` in pixels of a picture so wide
/// (the first of equals in reading order). All NaN where there are no errors. The percentile is the smallest value that at least 99 % of
/// the pixels do not exceed.
std::vector<MetricValue> summarise_errors(PixelErrors errors, int width_px, const std::string& name, const std::string& unit);
/// The names of those values, for Metric::values.
std::vector<std::string> summary_names(const std::string& name, const std::string& unit);

/// True where both pictures hit something.
bool both_hit(const MetricInput& input, size_t pixel);

/// The summary of `error(pixel index)` over the pixels that both pictures hit.
template <class Error>
std::vector<MetricValue> measure_pixels(const MetricInput& input, const std::string& name, const std::string& unit, const Error& error) {
  const GBuffer& seen = input.picture.gbuffer;
  LIMN_CHECK(seen.width == input.reference.gbuffer.width && seen.height == input.reference.gbuffer.height);
  PixelErrors errors;
  for (size_t i = 0; i < seen.id.size(); ++i) {
    if (!both_hit(input, i)) continue;
    errors.values.push_back(error(i));
    errors.pixels.push_back(i);
  }
  return summarise_errors(std::move(errors), seen.width, name, unit);
}

}  // namespace limn
