#pragma once
// Which pixels an outline by offset may ink.

#include <optional>
#include <vector>

#include "raymarch/border/pixel_window.h"
#include "raymarch/gbuffer.h"

namespace limn {

/// How far each part of a picture sees.
class SeenDepths {
 public:
  /// `camera`: of the picture, in render space, with its size. Both must stay.
  SeenDepths(const GBuffer& seen, const Camera& camera);

  /// The pixels whose rays may come to a box (render space) before what they see, and `beside_px` around them; empty where there are none.
  PixelWindow pixels_before(const Box& box, double beside_px = 0.0) const;

 private:
  static constexpr int kBlock_px = 8;

  const GBuffer& seen_;
  const Camera& camera_;
  Image<float> farthest_{};  ///< Of each block of pixels.
};

/// 1 for the pixels of `window` that see to one of the boxes.
WindowImage<std::uint8_t> pixels_before(const std::vector<Box>& boxes, const SeenDepths& depths, const PixelWindow& window);

}  // namespace limn
