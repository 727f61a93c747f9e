#include "raymarch/border/stroke_forms.h"

#include <algorithm>
#include <cmath>

namespace limn {
namespace {

constexpr double kGap = 0.8;  // of a dash
constexpr int kPointsASway = 8;

std::vector<StrokePoint> with_end(std::vector<StrokePoint> stroke, bool closed) {
  if (closed && !stroke.empty()) stroke.push_back(stroke.front());
  return stroke;
}

/// The way from the beginning to each point.
std::vector<double> lengths_of(const std::vector<StrokePoint>& stroke) {
  std::vector<double> lengths{0.0};
  for (size_t i = 1; i < stroke.size(); ++i) lengths.push_back(lengths.back() + glm::distance(stroke[i - 1].px, stroke[i].px));
  return lengths;
}

/// Splitmix64 (Steele et al. 2014), as a number from -1 to 1.
double hashed(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ull;
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ x >> 27) * 0x94d049bb133111ebull;
  return static_cast<double>((x ^ x >> 31) >> 11) * 0x1p-52 - 1.0;
}

/// Numbers at whole places, joined by cubics without a corner (Catmull and Rom 1974), scaled to stay within -1 to 1. `period` places make a
/// round; 0: none.
double sway(double place, std::uint64_t key, std::int64_t period) {
  const auto whole = static_cast<std::int64_t>(std::floor(place));
  const double t = place - static_cast<double>(whole);
  const auto at = [&](std::int64_t i) {
    if (period > 0) i = ((i % period) + period) % period;
    return hashed(key ^ static_cast<std::uint64_t>(i) * 0xd1342543de82ef95ull);
  };
  const double a = at(whole - 1), b = at(whole), c = at(whole + 1), d = at(whole + 2);
  return 0.8 * (b + 0.5 * t * (c - a + t * (2.0 * a - 5.0 * b + 4.0 * c - d + t * (3.0 * (b - c) + d - a))));
}

StrokePoint between(const StrokePoint& a, const StrokePoint& b, double t) {
  return {glm::mix(a.px, b.px, t), a.width_px + t * (b.width_px - a.width_px)};
}

/// The stretch from one length to another.
std::vector<StrokePoint> stretch(const std::vector<StrokePoint>& stroke, const std::vector<double>& lengths, double from, double to) {
  std::vector<StrokePoint> part;
  const auto at = [&](double length) {
    const auto next = static_cast<size_t>(std::upper_bound(lengths.begin() + 1, lengths.end() - 1, length) - lengths.begin());
    const double step = lengths[next] - lengths[next - 1];
    return between(stroke[next - 1], stroke[next], step > 0.0 ? std::clamp((length - lengths[next - 1]) / step, 0.0, 1.0) : 0.0);
  };
  part.push_back(at(from));
  for (size_t i = 0; i < stroke.size(); ++i)
    if (lengths[i] > from && lengths[i] < to) part.push_back(stroke[i]);
  part.push_back(at(to));
  return part;
}

}  // namespace

std::vector<StrokePoint> wobbling(const std::vector<StrokePoint>& given, bool closed, const Wobble& wobble, std::uint64_t number) {
  if (given.size() < 2) return given;
  const std::vector<StrokePoint> stroke = with_end(given, closed);
  const std::vector<double> lengths = lengths_of(stroke);
  const double whole = lengths.back();
  if (!(whole > 0.0)) return given;
  // A round of a closed stroke holds a whole number of sways.
  const auto period = closed ? std::max<std::int64_t>(3, std::llround(whole / wobble.length_px)) : std::int64_t{0};
  const double per_px = closed ? static_cast<double>(period) / whole : 1.0 / wobble.length_px;
  const std::uint64_t key = (wobble.seed * 0x9e3779b97f4a7c15ull + number) * 2;
  const auto steps = std::max<std::int64_t>(1, std::llround(std::ceil(whole * per_px * kPointsASway)));
  std::vector<double> places = lengths;
  for (std::int64_t i = 1; i < steps; ++i) places.push_back(whole * static_cast<double>(i) / static_cast<double>(steps));
  std::sort(places.begin(), places.end());
  std::vector<StrokePoint> swayed;
  size_t next = 1;
  for (const double place : places) {
    while (next + 1 < lengths.size() && lengths[next] < place) ++next;
    const double step = lengths[next] - lengths[next - 1];
    StrokePoint point =
        between(stroke[next - 1], stroke[next], step > 0.0 ? std::clamp((place - lengths[next - 1]) / step, 0.0, 1.0) : 0.0);
    const glm::dvec2 offset(sway(place * per_px, key, period), sway(place * per_px, key + 1, period));
    // Of both at once, not farther than said.
    point.px += wobble.px * offset / std::max(1.0, glm::length(offset));
    swayed.push_back(point);
  }
  if (closed) swayed.pop_back();
  return swayed;
}

std::vector<std::vector<StrokePoint>> dashes_of(const std::vector<StrokePoint>& given, bool closed, double dash_px) {
  const std::vector<StrokePoint> stroke = with_end(given, closed);
  if (stroke.size() < 2) return {stroke};
  const std::vector<double> lengths = lengths_of(stroke);
  const double whole = lengths.back(), period_px = dash_px * (1.0 + kGap);
  if (!(whole > 0.0)) return {stroke};
  // An open stroke ends with a dash, a closed one with a gap.
  const double tail_px = closed ? 0.0 : kGap * dash_px;
  const auto count = std::max<std::int64_t>(1, std::llround((whole + tail_px) / period_px));
  const double scale = whole / (static_cast<double>(count) * period_px - tail_px);
  std::vector<std::vector<StrokePoint>> dashes;
  for (std::int64_t i = 0; i < count; ++i) {
    const double from = scale * period_px * static_cast<double>(i);
    dashes.push_back(stretch(stroke, lengths, from, std::min(whole, from + scale * dash_px)));
  }
  return dashes;
}

}  // namespace limn
