#pragma once
// What a metric's value says, by its name: "border_error_p95" is one of border_error's.

#include "raymarch/metric.h"

namespace limn {

/// The metric with the longest name that the value's begins with; nothing for values that no metric yields.
const Metric* metric_of_value(const std::string& value);

/// Shares of what is right ("border_error_within_1") and correlations are better when higher, whatever the metric's other values are. True
/// for what no metric yields.
bool is_lower_better(const std::string& value);

/// What its metric measures, for people; empty for what no metric yields.
std::string definition_of(const std::string& value);

}  // namespace limn
