#pragma once
// The list of metrics. A new one is a file in this folder and a line in registry.cpp.

#include "raymarch/metric.h"

namespace limn {

Metric pixels_differ_metric();
Metric overlap_metric();
Metric normal_error_metric();
Metric depth_error_metric();
Metric silhouette_displacement_metric();
Metric inner_displacement_metric();
Metric hausdorff_metric();
Metric mean_distance_metric();
Metric boundary_iou_metric();
Metric width_metric();
Metric topology_metric();
Metric flicker_metric();
Metric prediction_metric();

}  // namespace limn
