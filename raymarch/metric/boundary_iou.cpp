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

/// Of each pixel and its two neighbours in the row, the least; beyond the row there is none.
void erode_row(const std::uint8_t* from, std::uint8_t* to, int width) {
  for (int x = 0; x < width; ++x) to[x] = from[x];
  for (int x = 1; x < width; ++x) to[x] &= from[x - 1];
  for (int x = 0; x + 1 < width; ++x) to[x] &= from[x + 1];
}

/// Erosion with a 3 x 3 square: with a row of three, then with a column. Beyond the picture ink goes on: its sides are no boundary.
void erode(Image<std::uint8_t>& ink, Image<std::uint8_t>& rows) {
  const int width = ink.width;
  for (int y = 0; y < ink.height; ++y) erode_row(&ink.at(0, y), &rows.at(0, y), width);
  for (int y = 0; y < ink.height; ++y) {
    const std::uint8_t *own = &rows.at(0, y), *above = &rows.at(0, std::max(y - 1, 0)),
                       *below = &rows.at(0, std::min(y + 1, ink.height - 1));
    std::uint8_t* const to = &ink.at(0, y);
    for (int x = 0; x < width; ++x) to[x] = own[x] & above[x] & below[x];
  }
}

/// Ink that is no ink any more after `steps` erosions.
Image<std::uint8_t> strip(const Image<std::uint8_t>& ink, int steps) {
  Image<std::uint8_t> left = ink, rows(ink.width, ink.height);
  for (int step = 0; step < steps; ++step) erode(left, rows);
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
