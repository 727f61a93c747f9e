#pragma once
// Which way a metric's values improve.

#include "raymarch/metric.h"

namespace limn {

/// Shares of what is right ("border_error_within_1") are better when higher, whatever the metric's other values are.
inline bool is_lower_better(const Metric& metric, const std::string& value) {
  return metric.lower_is_better && value.find("_within_") == std::string::npos;
}

}  // namespace limn
