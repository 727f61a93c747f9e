#pragma once
// Where the silhouette crosses the lines between pixel centres, the two distance transforms of those crossings, and the outline they give.
//
//     inside | outside        A crossing lies on the segment between the centres of two neighbours of which one shows an object and
//        o---+-x---o          the other nothing; its place is kept in 1/32 px from the centre of the left (or upper) one.

#include <cstdint>

#include "raymarch/border.h"

namespace limn {

inline constexpr int kSubPixels = 32;
inline constexpr std::int8_t kNoCrossing = -1;
/// Distances beyond this many pixels are not asked for: 16 bits hold an offset of twice as many.
inline constexpr int kLargestReach_px = 500;
inline constexpr std::int32_t kFarSquared = 0x7fffffff;

struct Silhouette {
  Image<std::uint8_t> inside{};    ///< 1 where something is hit.
  Image<std::int8_t> to_right{};   ///< Crossing towards (x+1, y), 0..32, or kNoCrossing.
  Image<std::int8_t> downwards{};  ///< Crossing towards (x, y+1).
  std::int64_t crossings = 0;
  std::int64_t thin = 0;  ///< Inside pixels with nothing on both sides: what is thinner falls between the pixels.
};

/// Where the silhouette passes between the pixels i and i + step, of which the first or the second shows what is inside. `before` and
/// `after` say whether i - step and i + 2 step exist.
std::int8_t crossing_place(const GBuffer& gbuffer, size_t i, size_t step, bool first_inside, bool before, bool after, bool estimate);

/// Half-way crossings; with `estimate` where N.V says more. Near the contour of a smooth surface (N.V)^2 falls off linearly to 0 (to first
/// order 2 kr times the distance in the image), so that the last two pixels inside extrapolate to the crossing; edges where it does not
/// fall keep the half-way point.
Silhouette find_silhouette(const GBuffer& gbuffer, bool estimate);

/// Squared distance of every pixel centre to the nearest crossing, in (1/32 px)^2, exact; kFarSquared beyond `reach_px`.
/// Two lower envelopes of parabolas (Felzenszwalb and Huttenlocher 2012): crossings on lines lie exactly on those lines, so a scan along
/// them and an envelope across is exact for any sub-pixel place; crossings on columns alike; the smaller counts. Linear in the pixels.
Image<std::int32_t> exact_squares(const Silhouette& silhouette, int reach_px);

/// The same by jump flooding (Rong and Tan 2006): steps of half the reach, and so on down to 1, then `extra_passes` more (2 and 1, or 1).
/// Not exact.
Image<std::int32_t> jump_flood_squares(const Silhouette& silhouette, int reach_px, int extra_passes);

enum class OutlineSide { outside, inside, centered };

/// An outline of `width_px` on one side of the silhouette, or half on each; its edges fade over `softness_px` (a box filter as wide; 0 is
/// hard). An outer outline's edge at the object is as sharp as the object's own: it fades over a pixel at most.
struct OutlineBand {
  double width_px = 3.0, softness_px = 1.0;
  OutlineSide side = OutlineSide::outside;
  /// How far from the silhouette there is ink, rounded up.
  int reach_px() const;
  /// Ink at the signed distance, positive outside.
  float ink(float signed_distance_px) const;
  double softness_at_object_px() const { return side == OutlineSide::outside ? std::min(softness_px, 1.0) : softness_px; }
};
OutlineBand outline_band(const Parameters& parameters);
Image<float> ink_band(const Silhouette& silhouette, const Image<std::int32_t>& squares, const OutlineBand& band);
/// Sentences that both methods have.
void add_silhouette_notes(const std::string& name, const Silhouette& silhouette, std::vector<std::string>& notes);

}  // namespace limn
