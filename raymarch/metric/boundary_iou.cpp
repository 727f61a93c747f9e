// Intersection over union of the strips of ink along its own boundary: what a wide band's middle would hide.

#include <algorithm>
#include <bit>
#include <cmath>

#include "raymarch/metric.h"
#include "raymarch/metric/ink_mask.h"
#include "sdf/error.h"

namespace limn {
namespace {

/// Width of the strip, as a share of the picture's diagonal. Cheng et al. take 2 % for masks of whole objects; a border's ink would lie in
/// such a strip altogether, which makes it plain intersection over union.
constexpr double kStrip = 0.003;

/// Of each pixel and its two neighbours in the row, whether all are ink; beyond the row ink goes on.
void erode_row(const std::uint64_t* from, std::uint64_t* to, const InkBits& shape) {
  for (size_t w = 0; w < shape.stride; ++w) {
    const bool first = w == 0, last = w + 1 == shape.stride;
    const std::uint64_t before = from[w] << 1 | (first ? 1 : from[w - 1] >> 63);
    // The pixel behind the last one of the row.
    const std::uint64_t own = last ? from[w] | ~shape.last_word() : from[w], after = own >> 1 | (last ? 1 : from[w + 1]) << 63;
    to[w] = from[w] & before & after;
  }
}

/// Erosion with a 3 x 3 square: with a row of three, then with a column. Beyond the picture ink goes on: its sides are no boundary.
void erode(InkBits& ink, InkBits& rows) {
  for (int y = 0; y < ink.height; ++y) erode_row(ink.row(y), rows.row(y), ink);
  for (int y = 0; y < ink.height; ++y) {
    const std::uint64_t *own = rows.row(y), *above = rows.row(std::max(y - 1, 0)), *below = rows.row(std::min(y + 1, ink.height - 1));
    for (size_t w = 0; w < ink.stride; ++w) ink.row(y)[w] = own[w] & above[w] & below[w];
  }
}

/// Ink that is no ink any more after `steps` erosions.
InkBits strip(const InkBits& ink, int steps) {
  InkBits left = ink, rows = ink;
  for (int step = 0; step < steps; ++step) erode(left, rows);
  for (size_t i = 0; i < ink.words.size(); ++i) left.words[i] = ink.words[i] & ~left.words[i];
  return left;
}

std::vector<MetricValue> measure(const MetricInput& input) {
  const Image<float>&ink = input.picture.border, &reference = input.reference.border;
  LIMN_CHECK(ink.width == reference.width && ink.height == reference.height);
  const int steps = std::max(1, static_cast<int>(std::lround(kStrip * std::hypot(ink.width, ink.height))));
  const InkBits a = strip(ink_bits(ink), steps), b = strip(ink_bits(reference), steps);
  std::int64_t common = 0, all = 0;
  for (size_t i = 0; i < a.words.size(); ++i) {
    common += std::popcount(a.words[i] & b.words[i]);
    all += std::popcount(a.words[i] | b.words[i]);
  }
  return {{"boundary_iou", all > 0 ? static_cast<double>(common) / static_cast<double>(all) : 1.0, ""}};
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
