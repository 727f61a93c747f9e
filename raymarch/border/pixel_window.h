#pragma once
// A part of the picture: what belongs to one object is drawn and looked at in its own window, however large the picture is.

#include <algorithm>

#include "sdf/image.h"

namespace limn {

/// Pixels [x0, x1) x [y0, y1) of a picture.
struct PixelWindow {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  bool empty() const { return x0 >= x1 || y0 >= y1; }
  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
};

/// Larger by `by` pixels on each side, as far as the picture goes; corners on multiples of `step` where that is possible.
PixelWindow grown(const PixelWindow& window, int by, int width, int height, int step = 1);

/// Values of a window's pixels.
template <class T>
struct WindowImage {
  PixelWindow window{};
  Image<T> values{};  ///< The window's size.

  /// (x, y) of the picture, which must lie in the window.
  T& at(int x, int y) { return values.at(x - window.x0, y - window.y0); }
  const T& at(int x, int y) const { return values.at(x - window.x0, y - window.y0); }
  bool inside(int x, int y) const { return x >= window.x0 && x < window.x1 && y >= window.y0 && y < window.y1; }
};

template <class T>
WindowImage<T> window_image(const PixelWindow& window, const T& value) {
  return {window, Image<T>(std::max(0, window.width()), std::max(0, window.height()), value)};
}

}  // namespace limn
