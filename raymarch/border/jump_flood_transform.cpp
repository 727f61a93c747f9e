// Jump flooding over the silhouette's crossings. A pixel holds the offset from its centre to the nearest crossing known so far, two
// 16-bit numbers of 1/32 px, so that one multiply-add makes the squared distance of a pixel, and four pixels fit a register.

#include <array>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>

#include "raymarch/border/picture_rows.h"
#include "raymarch/border/silhouette.h"

#if LIMN_SIMD && defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace limn {
namespace {

struct Offset {
  std::int16_t x, y;
};
/// Farther than any reach, even after all steps have been added to it.
constexpr Offset kUnknown{32767, 32767};
bool known(Offset offset) { return offset.x != kUnknown.x || offset.y != kUnknown.y; }

constexpr int kWideStep = 16;
constexpr std::array<glm::ivec2, 8> kDirections{{{-1, 0}, {1, 0}, {-1, -1}, {0, -1}, {1, -1}, {-1, 1}, {0, 1}, {1, 1}}};

/// A picture of offsets whose lines go on with unknown ones on both sides, so that no step has to look where the picture ends. In memory
/// of somebody else.
class OffsetLines {
 public:
  static size_t count(int width, int height, int margin) { return static_cast<size_t>(width + 2 * margin) * static_cast<size_t>(height); }
  OffsetLines(int width, int margin, Offset* offsets)
      : width_(static_cast<size_t>(width)), margin_(static_cast<size_t>(margin)), offsets_(offsets) {}
  Offset* line(int y) { return offsets_ + static_cast<size_t>(y) * (width_ + 2 * margin_) + margin_; }
  void clear_margins(int y) {
    std::fill_n(line(y) - margin_, margin_, kUnknown);
    std::fill_n(line(y) + width_, margin_, kUnknown);
  }

 private:
  size_t width_, margin_;
  Offset* offsets_;
};

/// The crossings about a pixel, in a fixed order: their offsets, and the pixels on their other sides.
struct Crossings {
  std::array<Offset, 4> offsets;
  std::array<glm::ivec2, 4> partners;
  int count = 0;
  int nearest = -1;
};

Crossings crossings_about(const Silhouette& silhouette, int x, int y) {
  Crossings found;
  const auto add = [&](int along, bool across, glm::ivec2 partner) {
    const auto k = static_cast<size_t>(found.count);
    found.offsets[k] = {static_cast<std::int16_t>(across ? along : 0), static_cast<std::int16_t>(across ? 0 : along)};
    found.partners[k] = partner;
    const auto length = [&](int i) {
      const Offset offset = found.offsets[static_cast<size_t>(i)];
      return std::abs(offset.x) + std::abs(offset.y);
    };
    if (found.nearest < 0 || length(found.count) < length(found.nearest)) found.nearest = found.count;
    ++found.count;
  };
  const auto& right = silhouette.to_right;
  const auto& down = silhouette.downwards;
  if (right.at(x, y) >= 0) add(right.at(x, y), true, {x + 1, y});
  if (x > 0 && right.at(x - 1, y) >= 0) add(right.at(x - 1, y) - kSubPixels, true, {x - 1, y});
  if (down.at(x, y) >= 0) add(down.at(x, y), false, {x, y + 1});
  if (y > 0 && down.at(x, y - 1) >= 0) add(down.at(x, y - 1) - kSubPixels, false, {x, y - 1});
  return found;
}

/// A pixel holds one crossing and has up to four. The outer pixels hold their nearest; the inner ones the nearest that its outer pixel
/// leaves out, so that few crossings are lost: the greater part of what jump flooding gets wrong otherwise.
Offset first_crossing(const Silhouette& silhouette, int x, int y) {
  const Crossings own = crossings_about(silhouette, x, y);
  if (own.count == 0) return kUnknown;
  const Offset nearest = own.offsets[static_cast<size_t>(own.nearest)];
  if (!silhouette.inside.at(x, y)) return nearest;
  Offset best = nearest;
  int best_length = std::numeric_limits<int>::max();
  for (size_t k = 0; k < static_cast<size_t>(own.count); ++k) {
    const glm::ivec2 partner = own.partners[k], step = partner - glm::ivec2(x, y);
    const Crossings theirs = crossings_about(silhouette, partner.x, partner.y);
    const Offset held = theirs.offsets[static_cast<size_t>(theirs.nearest)];
    const bool taken = held.x + kSubPixels * step.x == own.offsets[k].x && held.y + kSubPixels * step.y == own.offsets[k].y;
    const int length = std::abs(own.offsets[k].x) + std::abs(own.offsets[k].y);
    if (taken || length >= best_length) continue;
    best = own.offsets[k];
    best_length = length;
  }
  return best;
}

/// A pixel that knows a crossing.
struct Carrier {
  int x, y;
  Offset offset;
};

/// Most of a line is far from any crossing; eight pixels at a time are passed over.
void first_crossings(const Silhouette& silhouette, int y, Offset* out, std::vector<Carrier>& carriers) {
  const int width = silhouette.inside.width;
  const std::int8_t* right = &silhouette.to_right.at(0, y);
  const std::int8_t* down = &silhouette.downwards.at(0, y);
  const std::int8_t* up = y > 0 ? down - width : down;
  const auto none = [](const std::int8_t* eight) {
    std::uint64_t bits;
    std::memcpy(&bits, eight, 8);
    return bits == ~std::uint64_t{0};  // kNoCrossing is -1
  };
  for (int x = 0; x < width;) {
    if (x + 8 <= width && none(right + x) && none(down + x) && none(up + x) && (x == 0 || right[x - 1] == kNoCrossing)) {
      std::fill_n(out + x, 8, kUnknown);
      x += 8;
    } else {
      out[x] = first_crossing(silhouette, x, y);
      if (known(out[x])) carriers.push_back({x, y, out[x]});
      ++x;
    }
  }
}

std::int32_t square(Offset offset) { return std::int32_t{offset.x} * offset.x + std::int32_t{offset.y} * offset.y; }

std::int16_t add_saturated(std::int16_t a, int b) { return static_cast<std::int16_t>(std::clamp(a + b, -32768, 32767)); }

/// One line of one pass: the pixel's own offset and those of its eight neighbours at distance `step`, moved by it; the shortest stays.
/// Ties go to the first: the own, then the neighbours in order.
void flood_line(const std::array<const Offset*, 3>& lines, int width, int step, Offset* out) {
  std::array<const Offset*, 8> from;
  std::array<glm::ivec2, 8> move;
  for (size_t k = 0; k < 8; ++k) {
    from[k] = lines[static_cast<size_t>(kDirections[k].y + 1)] + kDirections[k].x * step;
    move[k] = kDirections[k] * step * kSubPixels;
  }
  int x = 0;
#if LIMN_SIMD && defined(__SSE2__)
  struct Packed {
    __m128i value;
  };
  std::array<Packed, 8> moves;
  for (size_t k = 0; k < 8; ++k) {
    moves[k].value =
        _mm_set1_epi32(static_cast<int>((static_cast<std::uint32_t>(move[k].x) & 0xffffu) | (static_cast<std::uint32_t>(move[k].y) << 16)));
  }
  for (; x + 4 <= width; x += 4) {
    __m128i best = _mm_loadu_si128(reinterpret_cast<const __m128i*>(lines[1] + x));
    __m128i best_square = _mm_madd_epi16(best, best);
    for (size_t k = 0; k < 8; ++k) {
      const __m128i offer = _mm_adds_epi16(_mm_loadu_si128(reinterpret_cast<const __m128i*>(from[k] + x)), moves[k].value);
      const __m128i offer_square = _mm_madd_epi16(offer, offer);
      const __m128i nearer = _mm_cmplt_epi32(offer_square, best_square);
      best_square = _mm_xor_si128(best_square, _mm_and_si128(nearer, _mm_xor_si128(best_square, offer_square)));
      best = _mm_xor_si128(best, _mm_and_si128(nearer, _mm_xor_si128(best, offer)));
    }
    _mm_storeu_si128(reinterpret_cast<__m128i*>(out + x), best);
  }
#endif
  for (; x < width; ++x) {
    Offset best = lines[1][x];
    for (size_t k = 0; k < 8; ++k) {
      const Offset offer{add_saturated(from[k][x].x, move[k].x), add_saturated(from[k][x].y, move[k].y)};
      if (square(offer) < square(best)) best = offer;
    }
    out[x] = best;
  }
}

/// A pass the other way round, from the pixels that know a crossing to their neighbours, in place: before the first of the wide steps
/// there are few of them. Wide outlines thus cost little more than narrow ones.
void scatter(int step, int width, int height, OffsetLines& offsets, std::vector<Carrier>& carriers) {
  std::vector<Carrier> reached;
  for (const Carrier& carrier : carriers) {
    for (const glm::ivec2& direction : kDirections) {
      const int x = carrier.x + direction.x * step, y = carrier.y + direction.y * step;
      if (x < 0 || x >= width || y < 0 || y >= height) continue;
      Offset& own = offsets.line(y)[x];
      const Offset offer{add_saturated(carrier.offset.x, -direction.x * step * kSubPixels),
                         add_saturated(carrier.offset.y, -direction.y * step * kSubPixels)};
      if (square(offer) >= square(own)) continue;
      if (!known(own)) reached.push_back({x, y, offer});
      own = offer;
    }
  }
  carriers.insert(carriers.end(), reached.begin(), reached.end());
  for (Carrier& carrier : carriers) carrier.offset = offsets.line(carrier.y)[carrier.x];
}

/// A pass in which every pixel looks at its neighbours.
void gather(int step, int width, int height, OffsetLines& from, OffsetLines& to) {
  const std::vector<Offset> beyond(static_cast<size_t>(width + 2 * step), kUnknown);
  const auto line = [&](int y) -> const Offset* { return y >= 0 && y < height ? from.line(y) : beyond.data() + step; };
  const auto flood = [&](int y) { flood_line({line(y - step), line(y), line(y + step)}, width, step, to.line(y)); };
  if (step < 8) {
    for_each_band(height, [&](int y0, int y1) {
      for (int y = y0; y < y1; ++y) flood(y);
    });
  } else {
    // Lines `step` apart share two of the three that they read: taken one after the other, each is fetched once.
    tbb::parallel_for(0, step, [&](int first) {
      for (int y = first; y < height; y += step) flood(y);
    });
  }
}

/// Every pixel's first offset; returns the pixels that have one, in order.
std::vector<Carrier> start(const Silhouette& silhouette, OffsetLines& from, OffsetLines& to) {
  const int height = silhouette.inside.height;
  std::vector<std::vector<Carrier>> of_bands(static_cast<size_t>(height / kBandRows + 1));
  for_each_band(height, [&](int y0, int y1) {
    for (int y = y0; y < y1; ++y) {
      from.clear_margins(y);
      to.clear_margins(y);
      first_crossings(silhouette, y, from.line(y), of_bands[static_cast<size_t>(y0 / kBandRows)]);
    }
  });
  std::vector<Carrier> carriers;
  for (const auto& band : of_bands) carriers.insert(carriers.end(), band.begin(), band.end());
  return carriers;
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
  const std::vector<int> steps = steps_for(reach_px, extra_passes);
  const int margin = steps.front();
  const size_t count = OffsetLines::count(width, height, margin);
  const std::unique_ptr<Offset[]> memory(new Offset[2 * count]);  // not initialised: every line is written before it is read
  OffsetLines from(width, margin, memory.get()), to(width, margin, memory.get() + count);
  std::vector<Carrier> carriers = start(silhouette, from, to);
  bool few = true;
  for (const int step : steps) {
    few = few && step >= kWideStep && carriers.size() < squares.size() / 128;
    if (few) {
      scatter(step, width, height, from, carriers);
      continue;
    }
    gather(step, width, height, from, to);
    std::swap(from, to);
  }
  const std::int32_t largest = reach_px * reach_px * kSubPixels * kSubPixels;
  for_each_band(height, [&](int y0, int y1) {
    for (int y = y0; y < y1; ++y) {
      const Offset* offsets = from.line(y);
      std::int32_t* out = &squares.at(0, y);
      for (int x = 0; x < width; ++x) {
        const std::int32_t distance = square(offsets[x]);
        out[x] = distance <= largest ? distance : kFarSquared;
      }
    }
  });
  return squares;
}

}  // namespace limn
