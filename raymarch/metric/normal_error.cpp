// The angle between normals, over the pixels that both pictures hit.

#include <cmath>

#include "raymarch/metric/error_summary.h"
#include "raymarch/metric/registry.h"
#include "sdf/error.h"

namespace limn {
namespace {

std::vector<MetricValue> measure(const MetricInput& input) {
  const GBuffer& seen = input.picture.gbuffer;
  LIMN_CHECK(seen.width == input.reference.gbuffer.width && seen.height == input.reference.gbuffer.height);
  std::vector<PixelError> errors;
  for (int y = 0; y < seen.height; ++y) {
    for (int x = 0; x < seen.width; ++x) {
      const size_t i = seen.id.index(x, y);
      if (!both_hit(input, i)) continue;
      const glm::dvec3 a(seen.normal.pixels[i]), b(input.reference.gbuffer.normal.pixels[i]);
      // Exact for small angles, where the arc cosine of float normals is not.
      errors.push_back({x, y, glm::degrees(std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)))});
    }
  }
  return summarise_errors(std::move(errors), "normal_error", "deg");
}

}  // namespace

Metric normal_error_metric() {
  return {{"normal_error", "angle between the normals where both pictures hit: mean, 99th percentile, largest and its pixel", "limn"},
          summary_names("normal_error", "deg"),
          true,
          measure};
}

}  // namespace limn
