#pragma once
// Mean, 99th percentile, largest error and where it is.

#include <string>
#include <vector>

#include "raymarch/metric.h"

namespace limn {

struct PixelError {
  int x = 0, y = 0;
  double value = 0.0;
};

/// `<name>_mean`, `<name>_p99`, `<name>_max` in `unit`, then `<name>_max_x`, `<name>_max_y` in pixels (the first of equals in reading
/// order). All NaN where `errors` is empty. The percentile is the smallest value that at least 99 % of the pixels do not exceed.
std::vector<MetricValue> summarise_errors(std::vector<PixelError> errors, const std::string& name, const std::string& unit);
/// The names of those values, for Metric::values.
std::vector<std::string> summary_names(const std::string& name, const std::string& unit);

/// True where both pictures hit something.
bool both_hit(const MetricInput& input, size_t pixel);

}  // namespace limn
