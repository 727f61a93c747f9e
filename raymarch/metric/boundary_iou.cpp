// Intersection over union of the strips of ink along its own boundary: what a wide band's middle would hide.

#include <algorithm>
#include <cmath>

#include "raymarch/metric.h"
#include "raymarch/metric/ink_mask.h"
#include "sdf/error.h"

namespace limn {
namespace {

/// Width of the strip, as a share of the picture's diagonal. Cheng et al. take 2 % for masks of whole objects; a border's ink would lie in
/// such a strip altogether, which makes it plain intersection over union.
constexpr double kStrip = 0.003;

/// Ink that is no ink any more after `steps` erosions with a 3 x 3 square. Beyond the picture ink goes on: its sides are no boundary.
Image<std::uint8_t> strip(const Image<std::uint8_t>& ink, int steps) {
  Image<std::uint8_t> left = ink, next = ink;
  for (int step = 0; step < steps; ++step) {
    for (int y = 0; y < ink.height; ++y) {
      for (int x = 0; x < ink.width; ++x) {
        std::uint8_t all = 1;
        for (int v = std::max(y - 1, 0); v <= std::min(y + 1, ink.height - 1); ++v) {
          for (int u = std::max(x - 1, 0); u <= std::min(x + 1, ink.width - 1); ++u) all = all && left.at(u, v);
        }
        next.at(x, y) = all;
      }
    }
    std::swap(left, next);
  }
  for (size_t i = 0; i < ink.size(); ++i) left.pixels[i] = ink.pixels[i] && !left.pixels[i];
  return left;
}

std::vector<MetricValue> measure(const MetricInput& input) {
  const Image<float>&ink = input.picture.border, &reference = input.reference.border;
  LIMN_CHECK(ink.width == reference.width && ink.height == reference.height);
  const int steps = std::max(1, static_cast<int>(std::lround(kStrip * std::hypot(ink.width, ink.height))));
  const Image<std::uint8_t> a = strip(ink_mask(ink), steps), b = strip(ink_mask(reference), steps);
  double common = 0.0, all = 0.0;
  for (size_t i = 0; i < a.size(); ++i) {
    common += a.pixels[i] && b.pixels[i];
    all += a.pixels[i] || b.pixels[i];
  }
  return {{"boundary_iou", all > 0.0 ? common / all : 1.0, ""}};
}

}  // namespace

Metric boundary_iou_metric() {
  return {{"boundary_iou",
           "intersection over union of the ink within 0.3 % of the picture's diagonal (at least 1 px) of its own boundary; 1 is the same "
           "border",
           "Cheng, Girshick, Dollar, Berg, Kirillov 2021"},
          {"boundary_iou"},
          false,
          measure,
          MetricSubject::ink};
}

}  // namespace limn
