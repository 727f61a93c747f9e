// The metrics by name. A new one is a file of this folder that defines NAME_metric(), and one line here.

#include "raymarch/metric.h"

#define LIMN_METRICS(X)      \
  X(pixels_differ)           \
  X(overlap)                 \
  X(boundary_iou)            \
  X(topology)                \
  X(normal_error)            \
  X(depth_error)             \
  X(border_error)            \
  X(silhouette_displacement) \
  X(inner_displacement)      \
  X(hausdorff)               \
  X(mean_distance)           \
  X(width)                   \
  X(prediction)              \
  X(flicker)

namespace limn {

#define LIMN_DECLARE(name) Metric name##_metric();
LIMN_METRICS(LIMN_DECLARE)
#undef LIMN_DECLARE

const Registry<Metric>& metrics() {
#define LIMN_ENTRY(name) name##_metric(),
  static const Registry<Metric> all("metric", {LIMN_METRICS(LIMN_ENTRY)});
#undef LIMN_ENTRY
  return all;
}

}  // namespace limn
