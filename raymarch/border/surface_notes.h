#pragma once
// Where methods fail, found in the picture itself: flat faces, normals that point away, and objects that meet without a line.

#include <algorithm>

#include "raymarch/border.h"

namespace limn {

// What a plane's normals differ by in a level set of single precision; a sphere turns more from pixel to pixel unless its radius is
// beyond 30 000 px.
inline constexpr float kSameNormal = 3e-5f;
inline constexpr std::int64_t kFlatPixels = 16;  ///< Of a face that is called flat, at least.

inline bool have_same_normal(const GBuffer& gbuffer, size_t a, size_t b) {
  if (gbuffer.id.pixels[a] != gbuffer.id.pixels[b]) return false;
  const glm::vec3 difference = gbuffer.normal.pixels[a] - gbuffer.normal.pixels[b];
  return !(glm::dot(difference, difference) > kSameNormal * kSameNormal);
}

/// A connected region of one object whose normal does not change from pixel to pixel.
struct FlatFace {
  std::int32_t id = 0;  ///< Object, from 1.
  std::int64_t pixels = 0;
  std::int64_t inked = 0;  ///< Of them, with coverage above 1/2.
};

/// Regions of at least `min_pixels` pixels (4-connected, normals equal to 3e-5 between neighbours), largest first.
std::vector<FlatFace> flat_faces(const GBuffer& gbuffer, const Image<float>& coverage, std::int64_t min_pixels = kFlatPixels);

/// The sentences, with their numbers, for a method called `name`; empty where nothing failed.
std::vector<std::string> surface_notes(const std::string& name, const GBuffer& gbuffer, const Image<float>& coverage);

/// "roberts: 3 of 40 places where one object meets another have no line: `reason`", places being pairs of neighbouring pixels; empty where
/// all have one, on one side at least.
std::string meetings_note(const std::string& name, const BorderInput& input, const Image<float>& coverage, const std::string& reason);

/// Hermite step from 0 at `edge0` to 1 at `edge1`; a hard step (x >= edge1) where they coincide.
inline double smoothstep(double edge0, double edge1, double x) {
  if (!(edge1 > edge0)) return x >= edge1 ? 1.0 : 0.0;
  const double t = std::clamp((x - edge0) / (edge1 - edge0), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

}  // namespace limn
