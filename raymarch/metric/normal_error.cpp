// The angle between normals, over the pixels that both pictures hit.

#include <cmath>

#include "raymarch/metric.h"
#include "raymarch/metric/error_summary.h"

namespace limn {
namespace {

/// As std::atan2(across, along) but for the last bit, of angles that most normals are apart by in a third of its time.
double angle_of(double across, double along) {
  if (!(along > 0.0 && across <= 0.1 * along)) return std::atan2(across, along);
  // Taylor's series; what is left out is below a hundredth of a bit.
  const double t = across / along, z = t * t;
  const double rest = 1.0 / 3 - z * (1.0 / 5 - z * (1.0 / 7 - z * (1.0 / 9 - z * (1.0 / 11 - z * (1.0 / 13 - z * (1.0 / 15 - z / 17))))));
  return t - t * z * rest;
}

std::vector<MetricValue> measure(const MetricInput& input) {
  const Image<glm::vec3>&normal = input.picture.gbuffer.normal, &reference = input.reference.gbuffer.normal;
  return measure_pixels(input, "normal_error", "deg", [&](size_t i) {
    const glm::dvec3 a(normal.pixels[i]), b(reference.pixels[i]);
    // Exact for small angles, where the arc cosine of float normals is not.
    return glm::degrees(angle_of(glm::length(glm::cross(a, b)), glm::dot(a, b)));
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
