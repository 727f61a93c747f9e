// Intersection over union of two borders.

#include <algorithm>

#include "raymarch/metric.h"
#include "raymarch/metric/inked_pixels.h"
#include "sdf/error.h"

namespace limn {
namespace {

std::vector<MetricValue> measure(const MetricInput& input) {
  const Image<float>&ink = input.picture.border, &reference = input.reference.border;
  LIMN_CHECK(ink.width == reference.width && ink.height == reference.height);
  double common = 0.0, all = 0.0;
  visit_inked(ink, reference, [&](size_t i) {
    common += double{std::min(ink.pixels[i], reference.pixels[i])};
    all += double{std::max(ink.pixels[i], reference.pixels[i])};
  });
  // Two empty borders are the same border.
  return {{"overlap", all > 0.0 ? common / all : 1.0, ""}};
}

}  // namespace

Metric overlap_metric() {
  return {
      {"overlap", "intersection over union of the inks (of partial coverage: least over largest); 1 is the same border", "Jaccard 1912"},
      {"overlap"},
      false,
      measure,
      MetricSubject::ink};
}

}  // namespace limn
