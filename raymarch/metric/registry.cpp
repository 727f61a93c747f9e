#include "raymarch/metric/registry.h"

#include "sdf/error.h"

namespace limn {

std::span<const Metric> metrics() {
  static const std::vector<Metric> all = {
      pixels_differ_metric(),
      overlap_metric(),
      boundary_iou_metric(),
      topology_metric(),
      normal_error_metric(),
      depth_error_metric(),
      silhouette_displacement_metric(),
      inner_displacement_metric(),
      hausdorff_metric(),
      mean_distance_metric(),
      width_metric(),
      prediction_metric(),
      flicker_metric(),
  };
  return all;
}

const Metric& find_metric(const std::string& name, const std::string& file, const std::string& field) {
  std::vector<std::string> names;
  for (const Metric& metric : metrics()) {
    if (metric.about.name == name) return metric;
    names.push_back(metric.about.name);
  }
  throw InputError({file, field, name, "unknown metric", known_names(name, names)});
}

}  // namespace limn
