// The angle between normals, over the pixels that both pictures hit.

#include <cmath>

#include "raymarch/metric.h"
#include "raymarch/metric/error_summary.h"

namespace limn {
namespace {

std::vector<MetricValue> measure(const MetricInput& input) {
  const Image<glm::vec3>&normal = input.picture.gbuffer.normal, &reference = input.reference.gbuffer.normal;
  return measure_pixels(input, "normal_error", "deg", [&](size_t i) {
    const glm::dvec3 a(normal.pixels[i]), b(reference.pixels[i]);
    // Exact for small angles, where the arc cosine of float normals is not.
    return glm::degrees(std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)));
  });
}

}  // namespace

Metric normal_error_metric() {
  return {{"normal_error",
           "angle between the normals where both pictures hit: mean, root mean square, 99th percentile, largest and its pixel", "limn"},
          summary_names("normal_error", "deg"),
          true,
          measure};
}

}  // namespace limn
