// The exact Euclidean distance transform of the silhouette's crossings.

#include <algorithm>
#include <cmath>

#include "raymarch/border/silhouette.h"
#include "raymarch/gbuffer/picture_rows.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr std::int16_t kFar = 32700;  // beyond any reach, with room for one more pixel
constexpr int kColumns = 16;          // columns worked on together: a cache line of results
constexpr std::int64_t kUnit = kSubPixels, kUnitSquared = kUnit * kUnit;

/// Envelope of the parabolas height[i]^2 + (32 (x - i))^2 over one line or column, merged into `squares` by minimum.
class Envelope {
 public:
  Envelope(int length, int reach_px)
      : length_(length),
        reach_(reach_px * kSubPixels),
        reach_squared_(std::int64_t{reach_} * reach_),
        apex_(static_cast<size_t>(length)),
        start_(static_cast<size_t>(length)) {}

  void merge(const std::int16_t* heights, std::int32_t* squares) {
    int count = 0;
    for (int q = 0; q < length_; ++q) {
      if (heights[q] > reach_) continue;
      int from = 0;
      while (count > 0) {
        const int p = apex_[static_cast<size_t>(count - 1)];
        from = first_nearer(p, heights[p], q, heights[q]);
        if (from > start_[static_cast<size_t>(count - 1)]) break;
        --count;
        from = 0;
      }
      if (from >= length_) continue;
      apex_[static_cast<size_t>(count)] = q;
      start_[static_cast<size_t>(count)] = from;
      ++count;
    }
    for (int k = 0; k < count; ++k) {
      const int apex = apex_[static_cast<size_t>(k)];
      const int end = k + 1 < count ? start_[static_cast<size_t>(k + 1)] : length_;
      lay(apex, heights[apex], start_[static_cast<size_t>(k)], end, squares);
    }
  }

 private:
  /// The first place at which q's parabola lies below p's (p < q). All terms are whole and below 2^53: the quotient's floor is exact.
  static int first_nearer(int p, std::int64_t height_p, int q, std::int64_t height_q) {
    const std::int64_t numerator = height_q * height_q - height_p * height_p + kUnitSquared * (std::int64_t{q} * q - std::int64_t{p} * p);
    const double place = static_cast<double>(numerator) / static_cast<double>(2 * kUnitSquared * (q - p));
    return static_cast<int>(std::clamp(std::floor(place) + 1.0, 0.0, 1e6));
  }

  void lay(int apex, std::int64_t height, int from, int to, std::int32_t* squares) const {
    const std::int64_t left = reach_squared_ - height * height;
    if (left < 0) return;
    const auto half = static_cast<int>(std::sqrt(static_cast<double>(left)) / static_cast<double>(kUnit));
    const auto base = static_cast<std::int32_t>(height * height);
    const int end = std::min(to, apex + half + 1);
    for (int i = std::max(from, apex - half); i < end; ++i) {
      squares[i] = std::min(squares[i], base + static_cast<std::int32_t>(kUnitSquared) * (i - apex) * (i - apex));
    }
  }

  int length_, reach_;
  std::int64_t reach_squared_;
  std::vector<int> apex_, start_;
};

/// Distance along the line from every pixel centre to the nearest crossing on it, in 1/32 px; kFar or about that where it is beyond reach.
void scan_line(const std::int8_t* crossings, int width, std::int16_t* out) {
  const auto lay = [&](int from, int to, int previous, int next) {
    for (int x = from; x < to; ++x) {
      out[x] = static_cast<std::int16_t>(std::min(std::min(kSubPixels * x - previous, next - kSubPixels * x), int{kFar}));
    }
  };
  constexpr int nowhere = 1 << 24;
  int from = 0, previous = -nowhere;
  for (int x = 0; x + 1 < width; ++x) {
    if (crossings[x] == kNoCrossing) continue;
    const int next = kSubPixels * x + crossings[x];
    lay(from, x + 1, previous, next);
    from = x + 1;
    previous = next;
  }
  lay(from, width, previous, nowhere);
}

/// The same along columns, for the columns [x0, x1): one sweep down, one up. 16-bit arithmetic throughout, for the width of registers.
void scan_columns(const Image<std::int8_t>& crossings, int x0, int x1, Image<std::int16_t>& out) {
  const int height = crossings.height, count = x1 - x0;
  std::vector<std::int16_t> from_above(static_cast<size_t>(count), kFar);
  std::int16_t* __restrict past = from_above.data();
  const auto step = [&](const std::int8_t* __restrict crossing, int sign, int base) {
    for (int x = 0; x < count; ++x) {
      const auto older = static_cast<std::int16_t>(std::min(past[x], kFar) + kSubPixels);
      const auto fresh = static_cast<std::int16_t>(base + sign * crossing[x]);
      past[x] = crossing[x] >= 0 ? fresh : older;
    }
  };
  std::copy_n(past, count, &out.at(x0, 0));
  for (int y = 1; y < height; ++y) {
    step(&crossings.at(x0, y - 1), -1, kSubPixels);
    std::copy_n(past, count, &out.at(x0, y));
  }
  std::fill_n(past, count, kFar);
  for (int y = height - 1; y >= 0; --y) {
    step(&crossings.at(x0, y), 1, 0);
    std::int16_t* __restrict distances = &out.at(x0, y);
    for (int x = 0; x < count; ++x) distances[x] = std::min(distances[x], past[x]);
  }
}

template <class Columns>
void for_each_columns(int width, int together, const Columns& columns) {
  const int blocks = (width + together - 1) / together;
  parallel_each(blocks, [&](int b) { columns(b * together, std::min(width, (b + 1) * together)); });
}

/// Envelopes down the columns [x0, x1) of `heights`, through a transposed copy.
void merge_columns(const Image<std::int16_t>& heights, int x0, int x1, int reach_px, Image<std::int32_t>& squares) {
  const auto height = static_cast<size_t>(heights.height);
  Envelope envelope(heights.height, reach_px);
  std::vector<std::int16_t> columns(kColumns * height);
  std::vector<std::int32_t> results(kColumns * height);
  bool any[kColumns] = {};
  for (int y = 0; y < heights.height; ++y) {
    for (int x = x0; x < x1; ++x) {
      const size_t k = static_cast<size_t>(x - x0), at = k * height + static_cast<size_t>(y);
      columns[at] = heights.at(x, y);
      any[k] |= columns[at] <= reach_px * kSubPixels;
    }
  }
  if (std::find(any, any + kColumns, true) == any + kColumns) return;
  std::fill(results.begin(), results.end(), kFarSquared);
  for (int x = x0; x < x1; ++x) {
    const auto k = static_cast<size_t>(x - x0);
    if (any[k]) envelope.merge(columns.data() + k * height, results.data() + k * height);
  }
  for (int y = 0; y < heights.height; ++y) {
    std::int32_t* out = &squares.at(0, y);
    for (int x = x0; x < x1; ++x) out[x] = std::min(out[x], results[static_cast<size_t>(x - x0) * height + static_cast<size_t>(y)]);
  }
}

}  // namespace

Image<std::int32_t> exact_squares(const Silhouette& silhouette, int reach_px) {
  LIMN_CHECK(reach_px >= 0 && reach_px <= kLargestReach_px);
  const int width = silhouette.inside.width, height = silhouette.inside.height;
  Image<std::int32_t> squares(width, height, kFarSquared);
  if (silhouette.crossings == 0) return squares;
  Image<std::int16_t> along(width, height, kFar);
  for_each_columns(width, 256, [&](int x0, int x1) { scan_columns(silhouette.downwards, x0, x1, along); });
  for_each_band(height, [&](int y0, int y1) {
    Envelope envelope(width, reach_px);
    for (int y = y0; y < y1; ++y) {
      envelope.merge(&along.at(0, y), &squares.at(0, y));
      scan_line(&silhouette.to_right.at(0, y), width, &along.at(0, y));
    }
  });
  for_each_columns(width, kColumns, [&](int x0, int x1) { merge_columns(along, x0, x1, reach_px, squares); });
  return squares;
}

}  // namespace limn
