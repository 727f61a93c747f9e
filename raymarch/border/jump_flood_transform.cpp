// Jump flooding over the silhouette's crossings. A pixel holds the offset from its centre to the nearest crossing known so far, two
// 16-bit numbers of 1/32 px, so that one multiply-add makes the squared distance of a pixel, and four pixels fit a register.

#include <array>
#include <cstdlib>
#include <limits>

#include "raymarch/border/picture_rows.h"
#include "raymarch/border/silhouette.h"

#if LIMN_SIMD && defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace limn {
namespace {

struct Offset {
  std::int16_t x = 32767, y = 32767;  ///< Unknown: farther than any reach, even after all steps have been added to it.
};

/// The part of the picture within reach of any crossing; nothing outside it is looked at.
struct Region {
  int x0 = std::numeric_limits<int>::max(), y0 = x0, x1 = 0, y1 = 0;
};

Offset nearest_crossing(const Silhouette& silhouette, int x, int y) {
  Offset nearest;
  int distance = std::numeric_limits<int>::max();
  const auto offer = [&](int along, bool across) {
    if (std::abs(along) >= distance) return;
    distance = std::abs(along);
    nearest = {static_cast<std::int16_t>(across ? along : 0), static_cast<std::int16_t>(across ? 0 : along)};
  };
  const auto& right = silhouette.to_right;
  const auto& down = silhouette.downwards;
  if (right.at(x, y) >= 0) offer(right.at(x, y), true);
  if (x > 0 && right.at(x - 1, y) >= 0) offer(right.at(x - 1, y) - kSubPixels, true);
  if (down.at(x, y) >= 0) offer(down.at(x, y), false);
  if (y > 0 && down.at(x, y - 1) >= 0) offer(down.at(x, y - 1) - kSubPixels, false);
  return nearest;
}

std::int32_t square(Offset offset) { return std::int32_t{offset.x} * offset.x + std::int32_t{offset.y} * offset.y; }

std::int16_t add_saturated(std::int16_t a, std::int16_t b) {
  return static_cast<std::int16_t>(std::clamp(std::int32_t{a} + b, -32768, 32767));
}

/// Takes over each neighbour's offset, moved by `step`, where it leads to a nearer crossing.
void take_nearer(const Offset* from, Offset step, int count, Offset* best, std::int32_t* squares) {
  int i = 0;
#if LIMN_SIMD && defined(__SSE2__)
  const __m128i move = _mm_set1_epi32(static_cast<int>(static_cast<std::uint16_t>(step.x)) |
                                      static_cast<int>(static_cast<std::uint32_t>(static_cast<std::uint16_t>(step.y)) << 16));
  for (; i + 4 <= count; i += 4) {
    auto* to = reinterpret_cast<__m128i*>(best + i);
    auto* to_squares = reinterpret_cast<__m128i*>(squares + i);
    const __m128i offer = _mm_adds_epi16(_mm_loadu_si128(reinterpret_cast<const __m128i*>(from + i)), move);
    const __m128i offer_squares = _mm_madd_epi16(offer, offer);
    const __m128i own_squares = _mm_loadu_si128(to_squares);
    const __m128i nearer = _mm_cmplt_epi32(offer_squares, own_squares);
    _mm_storeu_si128(to_squares, _mm_or_si128(_mm_and_si128(nearer, offer_squares), _mm_andnot_si128(nearer, own_squares)));
    _mm_storeu_si128(to, _mm_or_si128(_mm_and_si128(nearer, offer), _mm_andnot_si128(nearer, _mm_loadu_si128(to))));
  }
#endif
  for (; i < count; ++i) {
    const Offset offer{add_saturated(from[i].x, step.x), add_saturated(from[i].y, step.y)};
    const std::int32_t offer_square = square(offer);
    if (offer_square >= squares[i]) continue;
    squares[i] = offer_square;
    best[i] = offer;
  }
}

/// One line of one pass with the given step.
void flood_line(const Image<Offset>& from, const Region& region, int y, int step, Image<Offset>& to, std::int32_t* squares) {
  const int width = region.x1 - region.x0;
  const Offset* own = &from.at(region.x0, y);
  Offset* best = &to.at(region.x0, y);
  for (int x = 0; x < width; ++x) {
    best[x] = own[x];
    squares[x] = square(own[x]);
  }
  for (int dy = -step; dy <= step; dy += step) {
    if (y + dy < region.y0 || y + dy >= region.y1) continue;
    const Offset* line = &from.at(region.x0, y + dy);
    for (int dx = -step; dx <= step; dx += step) {
      if (dx == 0 && dy == 0) continue;
      const int first = std::max(0, -dx), last = std::min(width, width - dx);
      const Offset move{static_cast<std::int16_t>(kSubPixels * dx), static_cast<std::int16_t>(kSubPixels * dy)};
      if (first < last) take_nearer(line + first + dx, move, last - first, best + first, squares + first);
    }
  }
}

Region reach_of(const Silhouette& silhouette, int reach_px) {
  Region region;
  const int width = silhouette.inside.width, height = silhouette.inside.height;
  for (int y = 0; y < height; ++y) {
    const std::int8_t *right = &silhouette.to_right.at(0, y), *down = &silhouette.downwards.at(0, y);
    const auto crosses = [&](int x) { return right[x] >= 0 || down[x] >= 0; };
    int x0 = 0, x1 = width;
    while (x0 < width && !crosses(x0)) ++x0;
    if (x0 == width) continue;
    while (!crosses(x1 - 1)) --x1;
    region.y0 = std::min(region.y0, y);
    region.y1 = std::max(region.y1, y + 2);
    region.x0 = std::min(region.x0, x0);
    region.x1 = std::max(region.x1, x1 + 1);
  }
  return {std::max(0, region.x0 - reach_px), std::max(0, region.y0 - reach_px), std::min(width, region.x1 + reach_px),
          std::min(height, region.y1 + reach_px)};
}

/// Calls `band(y0, y1)` over the region's lines.
template <class Band>
void for_each_band_of(const Region& region, const Band& band) {
  for_each_band(region.y1 - region.y0, [&](int y0, int y1) { band(region.y0 + y0, region.y0 + y1); });
}

std::vector<int> steps_for(int reach_px, int extra_passes) {
  int step = 1;
  while (2 * step - 1 < reach_px + 1) step *= 2;
  std::vector<int> steps;
  for (; step >= 1; step /= 2) steps.push_back(step);
  for (int extra = extra_passes; extra >= 1; --extra) steps.push_back(extra);
  return steps;
}

}  // namespace

Image<std::int32_t> jump_flood_squares(const Silhouette& silhouette, int reach_px, int extra_passes) {
  LIMN_CHECK(reach_px >= 0 && reach_px <= kLargestReach_px && extra_passes >= 0 && extra_passes <= 2);
  const int width = silhouette.inside.width, height = silhouette.inside.height;
  Image<std::int32_t> squares(width, height, kFarSquared);
  if (silhouette.crossings == 0) return squares;
  const Region region = reach_of(silhouette, reach_px);
  Image<Offset> from(width, height), to(width, height);
  for_each_band_of(region, [&](int y0, int y1) {
    for (int y = y0; y < y1; ++y) {
      for (int x = region.x0; x < region.x1; ++x) from.at(x, y) = nearest_crossing(silhouette, x, y);
    }
  });
  for (const int step : steps_for(reach_px, extra_passes)) {
    for_each_band_of(region, [&](int y0, int y1) {
      std::vector<std::int32_t> line(static_cast<size_t>(region.x1 - region.x0));
      for (int y = y0; y < y1; ++y) flood_line(from, region, y, step, to, line.data());
    });
    std::swap(from, to);
  }
  const std::int32_t largest = reach_px * reach_px * kSubPixels * kSubPixels;
  for_each_band_of(region, [&](int y0, int y1) {
    for (int y = y0; y < y1; ++y) {
      for (int x = region.x0; x < region.x1; ++x) {
        const std::int32_t distance = square(from.at(x, y));
        if (distance <= largest) squares.at(x, y) = distance;
      }
    }
  });
  return squares;
}

}  // namespace limn
