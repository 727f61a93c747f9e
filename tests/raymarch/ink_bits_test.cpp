// Ink by bits and in stretches, against the same by single pixels.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "raymarch/metric.h"
#include "raymarch/metric/ink_mask.h"
#include "tests/random_seed.h"

namespace limn {
namespace {

/// Blank but for a few blobs, of whose pixels some have just half of the ink.
Image<float> blobs(std::mt19937& random, int width, int height) {
  Image<float> ink(width, height, 0.0f);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  for (int blob = below(5); blob >= 0; --blob) {
    const int x0 = below(width), y0 = below(height), side = 1 + below(40);
    for (int y = y0; y < std::min(y0 + side, height); ++y)
      for (int x = x0; x < std::min(x0 + side, width); ++x) {
        const int kind = below(12);
        ink.at(x, y) = kind == 0   ? 0.5f
                       : kind == 1 ? std::nextafter(0.5f, 0.0f)
                       : kind == 2 ? 0.001f * static_cast<float>(below(1000))
                                   : 1.0f;
      }
  }
  return ink;
}

double measured(const std::string& metric, const std::string& value, const Image<float>& ink, const Image<float>& reference) {
  Picture own, other;
  own.border = ink, other.border = reference;
  for (const MetricValue& one : find_metric(metric).measure({own, other, Camera{}}))
    if (one.name == value) return one.value;
  return std::nan("");
}

struct Inks {
  Image<float> a, b;
};
Inks random_inks(std::mt19937& random) {
  const int width = 1 + static_cast<int>(random() % 200), height = 1 + static_cast<int>(random() % 60);
  return {blobs(random, width, height), blobs(random, width, height)};
}

TEST(InkBits, AreTheMaskOfEveryPixel) {
  std::mt19937 random(random_seed());
  for (int round = 0; round < 100; ++round) {
    const Image<float> ink = random_inks(random).a;
    const InkBits bits = ink_bits(ink);
    const Image<std::uint8_t> mask = ink_mask(ink);
    ASSERT_EQ(bits.stride, (static_cast<size_t>(ink.width) + 63) / 64);
    for (int y = 0; y < ink.height; ++y)
      for (int x = 0; x < 64 * static_cast<int>(bits.stride); ++x)
        ASSERT_EQ(bits.row(y)[x / 64] >> (x % 64) & 1, x < ink.width && mask.at(x, y) ? 1u : 0u) << x << "," << y;
  }
}

/// Ink with paper within `steps` of it, along rows, columns and diagonals; beyond the picture there is none.
Image<std::uint8_t> near_paper(const Image<float>& ink, int steps) {
  Image<std::uint8_t> near(ink.width, ink.height, 0);
  for (int y = 0; y < ink.height; ++y)
    for (int x = 0; x < ink.width; ++x)
      for (int v = y - steps; v <= y + steps && is_ink(ink.at(x, y)); ++v)
        for (int u = x - steps; u <= x + steps; ++u)
          if (ink.inside(u, v) && !is_ink(ink.at(u, v))) near.at(x, y) = 1;
  return near;
}

TEST(InkBits, StripsAreInkNearPaper) {
  std::mt19937 random(random_seed());
  for (int round = 0; round < 60; ++round) {
    // So wide that strips have a width of 2 and 3 px, too.
    Inks inks = random_inks(random);
    if (round % 3 == 0) {
      const int width = 500 + static_cast<int>(random() % 600);
      inks = {blobs(random, width, 20), blobs(random, width, 20)};
    }
    const int steps = std::max(1, static_cast<int>(std::lround(0.003 * std::hypot(inks.a.width, inks.a.height))));
    const Image<std::uint8_t> a = near_paper(inks.a, steps), b = near_paper(inks.b, steps);
    double common = 0.0, all = 0.0;
    for (size_t i = 0; i < a.size(); ++i) common += a.pixels[i] && b.pixels[i], all += a.pixels[i] || b.pixels[i];
    ASSERT_EQ(measured("boundary_iou", "boundary_iou", inks.a, inks.b), all > 0.0 ? common / all : 1.0)
        << inks.a.width << "x" << inks.a.height << ", " << steps << " px";
  }
}

/// Pieces of what `of` says: over sides, or over corners, too. Within a frame of one pixel of paper.
int pieces(const Image<float>& ink, bool of, bool over_corners) {
  Image<std::uint8_t> left(ink.width + 2, ink.height + 2, 0);
  for (int y = -1; y <= ink.height; ++y)
    for (int x = -1; x <= ink.width; ++x) left.at(x + 1, y + 1) = (ink.inside(x, y) && is_ink(ink.at(x, y))) == of;
  int count = 0;
  for (size_t i = 0; i < left.size(); ++i) {
    if (!left.pixels[i]) continue;
    ++count;
    std::vector<glm::ivec2> stack{{static_cast<int>(i) % left.width, static_cast<int>(i) / left.width}};
    while (!stack.empty()) {
      const glm::ivec2 p = stack.back();
      stack.pop_back();
      if (!left.inside(p.x, p.y) || !left.at(p.x, p.y)) continue;
      left.at(p.x, p.y) = 0;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
          if (over_corners || dx == 0 || dy == 0) stack.emplace_back(p.x + dx, p.y + dy);
    }
  }
  return count;
}

TEST(InkBits, PiecesAndHolesAreThoseOfAFloodFill) {
  std::mt19937 random(random_seed());
  for (int round = 0; round < 60; ++round) {
    Image<float> ink = random_inks(random).a;
    // From single pixels far apart to ink with single holes.
    const unsigned share = 5 + 90 * static_cast<unsigned>(round) / 60;
    for (float& coverage : ink.pixels) coverage = random() % 100 < share ? 1.0f : 0.0f;
    ASSERT_EQ(measured("topology", "topology_components", ink, ink), pieces(ink, true, true)) << ink.width << "x" << ink.height;
    ASSERT_EQ(measured("topology", "topology_holes", ink, ink), pieces(ink, false, false) - 1) << ink.width << "x" << ink.height;
  }
}

TEST(InkBits, BlankStretchesChangeNoSum) {
  std::mt19937 random(random_seed());
  for (int round = 0; round < 100; ++round) {
    const Inks inks = random_inks(random);
    double common = 0.0, all = 0.0, differ = 0.0, missing = 0.0, wrong = 0.0;
    for (size_t i = 0; i < inks.a.size(); ++i) {
      const double own = inks.a.pixels[i], other = inks.b.pixels[i];
      common += std::min(own, other), all += std::max(own, other);
      differ += std::abs(own - other) > 1.0 / 510.0;
      missing += std::max(other - own, 0.0), wrong += std::max(own - other, 0.0);
    }
    ASSERT_EQ(measured("overlap", "overlap", inks.a, inks.b), all > 0.0 ? common / all : 1.0);
    ASSERT_EQ(measured("pixels_differ", "pixels_differ", inks.a, inks.b), differ);
    ASSERT_EQ(measured("pixels_differ", "pixels_missing", inks.a, inks.b), missing);
    ASSERT_EQ(measured("pixels_differ", "pixels_false", inks.a, inks.b), wrong);
  }
}

}  // namespace
}  // namespace limn
