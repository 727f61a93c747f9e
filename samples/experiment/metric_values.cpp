#include "samples/experiment/metric_values.h"

namespace limn {

const Metric* metric_of_value(const std::string& value) {
  const Metric* best = nullptr;
  for (const Metric& metric : metrics()) {
    const std::string& name = metric.about.name;
    if (value.starts_with(name) && (best == nullptr || name.size() > best->about.name.size())) best = &metric;
  }
  return best;
}

bool is_lower_better(const std::string& value) {
  const Metric* metric = metric_of_value(value);
  if (metric == nullptr) return true;
  const bool share_of_right = value.find("_within_") != std::string::npos || value.ends_with("_correlation") || value.ends_with("_covered");
  return metric->lower_is_better && !share_of_right;
}

std::string definition_of(const std::string& value) {
  const Metric* metric = metric_of_value(value);
  return metric == nullptr ? "" : metric->about.name + ": " + metric->about.help;
}

}  // namespace limn
