#include "raymarch/border/silhouette.h"

#include <fmt/core.h>

#include <atomic>
#include <cmath>
#include <cstring>

#include "raymarch/gbuffer/picture_rows.h"

namespace limn {
namespace {

/// From the centre of `inner` towards the empty neighbour, in 1/32 px; `deeper` is the pixel on the other side of `inner`.
int crossing_from(const GBuffer& seen, size_t inner, size_t deeper) {
  constexpr int half = kSubPixels / 2;
  if (seen.id.pixels[deeper] != seen.id.pixels[inner]) return half;
  const float c1 = seen.n_dot_v.pixels[inner], c2 = seen.n_dot_v.pixels[deeper];
  const float fall = c2 * c2 - c1 * c1;
  // Beyond the empty neighbour's centre by more than the extrapolation's own error: not a smooth contour.
  if (!(fall > 0.0f) || c1 * c1 > 1.25f * fall) return half;
  return static_cast<int>(std::min(1.0f, c1 * c1 / fall) * kSubPixels + 0.5f);
}

std::int8_t crossing(const GBuffer& seen, size_t i, size_t step, bool before, bool after, bool estimate) {
  return crossing_place(seen, i, step, seen.id.pixels[i] != 0, before, after, estimate);
}

bool same_eight(const std::uint8_t* a, const std::uint8_t* b) { return std::memcmp(a, b, 8) == 0; }

struct LineCounts {
  std::int64_t crossings = 0, thin = 0;
};

LineCounts find_line(const GBuffer& seen, int y, bool estimate, Silhouette& out) {
  LineCounts counts;
  const int width = seen.width, height = seen.height;
  const std::uint8_t* own = &out.inside.at(0, y);
  const std::uint8_t* below = y + 1 < height ? own + width : nullptr;
  const std::uint8_t* above = y > 0 ? own - width : nullptr;
  const size_t first = seen.id.index(0, y), step = static_cast<size_t>(width);
  for (int x = 0; x < width; ++x) {
    while (x + 8 < width && same_eight(own + x, own + x + 1) && (!below || same_eight(own + x, below + x))) x += 8;
    const size_t i = first + static_cast<size_t>(x);
    if (x + 1 < width && own[x] != own[x + 1]) {
      out.to_right.pixels[i] = crossing(seen, i, 1, x > 0, x + 2 < width, estimate);
      ++counts.crossings;
    }
    if (below && own[x] != below[x]) {
      out.downwards.pixels[i] = crossing(seen, i, step, y > 0, y + 2 < height, estimate);
      ++counts.crossings;
    }
    if (!own[x]) continue;
    const bool thin_across = x > 0 && x + 1 < width && !own[x - 1] && !own[x + 1];
    const bool thin_down = above && below && !above[x] && !below[x];
    counts.thin += thin_across || thin_down;
  }
  return counts;
}

}  // namespace

std::int8_t crossing_place(const GBuffer& gbuffer, size_t i, size_t step, bool first_inside, bool before, bool after, bool estimate) {
  if (!estimate) return static_cast<std::int8_t>(kSubPixels / 2);
  if (first_inside) return static_cast<std::int8_t>(before ? crossing_from(gbuffer, i, i - step) : kSubPixels / 2);
  return static_cast<std::int8_t>(kSubPixels - (after ? crossing_from(gbuffer, i + step, i + 2 * step) : kSubPixels / 2));
}

Silhouette find_silhouette(const GBuffer& gbuffer, bool estimate) {
  Silhouette out;
  out.inside = {gbuffer.width, gbuffer.height, 0};
  out.to_right = {gbuffer.width, gbuffer.height, kNoCrossing};
  out.downwards = {gbuffer.width, gbuffer.height, kNoCrossing};
  for_each_band(gbuffer.height, [&](int y0, int y1) {
    for (size_t i = gbuffer.id.index(0, y0); i < gbuffer.id.index(0, y1); ++i) out.inside.pixels[i] = gbuffer.id.pixels[i] != 0;
  });
  std::atomic<std::int64_t> crossings{0}, thin{0};
  for_each_band(gbuffer.height, [&](int y0, int y1) {
    for (int y = y0; y < y1; ++y) {
      const LineCounts counts = find_line(gbuffer, y, estimate, out);
      crossings += counts.crossings;
      thin += counts.thin;
    }
  });
  out.crossings = crossings;
  out.thin = thin;
  return out;
}

int OutlineBand::reach_px() const {
  const double far_side = side == OutlineSide::centered ? 0.5 * width_px : width_px;
  return static_cast<int>(std::ceil(far_side + 0.5 * softness_px)) + 1;
}

float OutlineBand::ink(float signed_distance_px) const {
  const auto width = static_cast<float>(width_px), soft = static_cast<float>(softness_px);
  const float low = side == OutlineSide::outside ? 0.0f : side == OutlineSide::inside ? -width : -0.5f * width;
  const float high = low + width;
  if (!(soft > 0.0f)) return signed_distance_px >= low && signed_distance_px <= high ? 1.0f : 0.0f;
  if (const auto inner = static_cast<float>(softness_at_object_px()); inner < soft) {
    const auto step = [signed_distance_px](float at, float fade) {
      return std::clamp((signed_distance_px - at) / fade + 0.5f, 0.0f, 1.0f);
    };
    return std::max(0.0f, step(low, inner) - step(high, soft));
  }
  const float overlap = std::min(signed_distance_px + 0.5f * soft, high) - std::max(signed_distance_px - 0.5f * soft, low);
  return std::min(1.0f, std::max(0.0f, overlap / soft));
}

OutlineBand outline_band(const Parameters& parameters) {
  const std::string& side = parameters.choice("side");
  return {parameters.number("width"), parameters.number("softness"),
          side == "outside"  ? OutlineSide::outside
          : side == "inside" ? OutlineSide::inside
                             : OutlineSide::centered};
}

namespace {

/// Squared distances full_from..full_to have full ink, those beyond none_beyond have none: most of a wide outline and of what lies on the
/// other side of the silhouette, and no root is needed for either.
struct PlainInk {
  double full_from, full_to, none_beyond;
};

PlainInk plain_ink(const OutlineBand& band, double sign) {
  const double half = 0.5 * band.softness_px;
  const double low = band.side == OutlineSide::outside ? 0.0 : band.side == OutlineSide::inside ? -band.width_px : -0.5 * band.width_px;
  const double high = low + band.width_px;
  const double at_object = band.side == OutlineSide::outside ? 0.5 * band.softness_at_object_px() : half;
  const double nearest = sign > 0.0 ? low + at_object : -high + half, farthest = sign > 0.0 ? high - half : -low - at_object;
  const auto squared = [](double distance_px) { return distance_px * distance_px * kSubPixels * kSubPixels; };
  // Farther than rounding to float can move a distance, so that what is passed over would have had no ink.
  constexpr double margin_px = 0.01;
  const double beyond = squared(std::max(0.0, sign > 0.0 ? high + half : -low + at_object) + margin_px);
  if (farthest < 0.0 || nearest > farthest) return {1.0, 0.0, beyond};
  return {nearest > 0.0 ? squared(nearest) : 0.0, squared(farthest), beyond};
}

}  // namespace

Image<float> ink_band(const Silhouette& silhouette, const Image<std::int32_t>& squares, const OutlineBand& band) {
  Image<float> ink(squares.width, squares.height, 0.0f);
  const PlainInk plain[2] = {plain_ink(band, 1.0), plain_ink(band, -1.0)};
  const bool soft = band.softness_px > 0.0;
  for_each_band(squares.height, [&](int y0, int y1) {
    for (size_t i = squares.index(0, y0); i < squares.index(0, y1); ++i) {
      const std::int32_t square = squares.pixels[i];
      if (square == kFarSquared) continue;
      const std::uint8_t inside = silhouette.inside.pixels[i];
      if (square > plain[inside].none_beyond) continue;
      if (soft && square >= plain[inside].full_from && square <= plain[inside].full_to) {
        ink.pixels[i] = 1.0f;
        continue;
      }
      const float distance_px = std::sqrt(static_cast<float>(square)) / kSubPixels;
      ink.pixels[i] = band.ink(inside ? -distance_px : distance_px);
    }
  });
  return ink;
}

void add_silhouette_notes(const std::string& name, const Silhouette& silhouette, std::vector<std::string>& notes) {
  if (silhouette.thin == 0) return;
  notes.push_back(fmt::format("{}: {} pixels of the silhouette are one pixel thin; what is thinner is lost", name, silhouette.thin));
}

}  // namespace limn
