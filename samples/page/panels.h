#pragma once
// Pictures made small or large for people to look at.

#include "raymarch/picture.h"

namespace limn {

/// Fits into width x height by averaging; never enlarged beyond a whole factor. Keeps the aspect ratio.
Image<glm::vec4> fitted(const Image<glm::vec4>& picture, int width, int height);

/// A difference picture made small so that a single wrong pixel still shows: the strongest difference of a block counts, not the mean.
Image<glm::vec4> fitted_difference(const Image<glm::vec4>& difference, const Image<float>& border, const Image<float>& reference, int width,
                                   int height);

/// A rectangle of a picture.
struct Window {
  int x = 0,              ///< Of the left pixel.
      y = 0,              ///< Of the top pixel.
      width = 0,          ///< Pixels.
      height = 0;         ///< Pixels.
  double wrong_px = 0.0;  ///< Ink that differs in it.
};
/// The window of that size (cut to the picture's) with the most ink that differs; in the middle where nothing differs.
Window worst_window(const Image<float>& border, const Image<float>& reference, int width, int height);

/// The pixels of a picture inside a window.
template <class T>
Image<T> cropped(const Image<T>& picture, const Window& window) {
  Image<T> out(window.width, window.height);
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) out.at(x, y) = picture.at(window.x + x, window.y + y);
  }
  return out;
}

/// The window around all hits, grown by 3 % of the picture's height; the whole picture where nothing is hit.
Window hit_window(const GBuffer& gbuffer);
/// The smallest window around both.
Window merge(const Window& a, const Window& b);

/// A window enlarged by a whole factor, its pixels as squares.
Image<glm::vec4> enlarged(const Image<glm::vec4>& picture, const Window& window, int factor);

/// Ink on white.
Image<glm::vec4> ink_on_paper(const Image<float>& border);

}  // namespace limn
