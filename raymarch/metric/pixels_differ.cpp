// How many pixels of the border are wrong, and which way.

#include <algorithm>
#include <cmath>

#include "raymarch/metric.h"
#include "raymarch/metric/inked_pixels.h"
#include "sdf/error.h"

namespace limn {
namespace {

std::vector<MetricValue> measure(const MetricInput& input) {
  const Image<float>&ink = input.picture.border, &reference = input.reference.border;
  LIMN_CHECK(ink.width == reference.width && ink.height == reference.height);
  double differ = 0.0, missing = 0.0, false_ink = 0.0;
  visit_inked(ink, reference, [&](size_t i) {
    const double difference = double{ink.pixels[i]} - double{reference.pixels[i]};
    differ += std::abs(difference) > 1.0 / 510.0;  // half a step of eight bits
    missing += std::max(-difference, 0.0);
    false_ink += std::max(difference, 0.0);
  });
  return {{"pixels_differ", differ, "px"}, {"pixels_missing", missing, "px"}, {"pixels_false", false_ink, "px"}};
}

}  // namespace

Metric pixels_differ_metric() {
  return {{"pixels_differ", "pixels whose ink differs visibly (by 1/510); area of ink that is missing, and of ink that is false", "limn"},
          {"pixels_differ [px]", "pixels_missing [px]", "pixels_false [px]"},
          true,
          measure,
          MetricSubject::ink};
}

}  // namespace limn
