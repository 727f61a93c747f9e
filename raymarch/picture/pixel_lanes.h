#pragma once
// Internal: what becomes of pixels that are seen, several at a time: the headlight's shading, inks, sums over samples, sRGB.

#include <cstdint>
#include <span>
#include <vector>

#include "raymarch/picture/compose.h"

namespace limn {

/// Colours by id; 0, where nothing is hit, is black.
struct ColorsById {
  std::vector<float> red{}, green{}, blue{};
};
ColorsById colors_by_id(std::span<const glm::vec3> colors);

/// What all pixels of a sample share.
struct PixelStage {
  const ColorsById* colors = nullptr;
  std::span<const glm::vec3> inks{};  ///< Of each method, the last on top.
  bool first = true;                  ///< Of the samples: else it is added to the sums.
  const Finish* finish = nullptr;     ///< Of the last sample, as compose() takes it.
};

/// Pixels side by side.
struct PixelRun {
  size_t count = 0;
  const float* n_dot_v = nullptr;
  const std::int32_t* id = nullptr;
  std::span<const float* const> coverage{};  ///< Of each method.
  float* border = nullptr;                   ///< Sums of the inks together; null where nobody reads them.
  glm::vec4* composite = nullptr;            ///< Sums; null where nobody reads them, or `planes` has them.
  float* planes = nullptr;                   ///< Sums of red; those of green, blue and alpha follow, `plane` apart.
  size_t plane = 0;
  glm::u8vec4* bytes = nullptr;  ///< Of the last sample, written in place of sums; null: those are.
};
void compose_pixels(const PixelStage& stage, const PixelRun& run);

/// As PNG holds them: sRGB, alpha apart. Sizes equal.
void encode_pixels(std::span<const glm::vec4> colors, std::span<glm::u8vec4> bytes);
/// The same by all threads.
Image<glm::u8vec4> encoded(const Image<glm::vec4>& picture);

}  // namespace limn
