#pragma once
// Pictures in memory.

#include <cstddef>
#include <vector>

#include "sdf/error.h"
#include "sdf/large_pages.h"

namespace limn {

/// Of an Image; like any other vector, but for where its memory comes from.
template <class T>
using Pixels = LargeVector<T>;

/// A plain picture: row-major, origin top left, pixel (x, y) covers [x, x+1) x [y, y+1), its centre is at +0.5.
///
///     (0,0) ------> x, width
///       |   +---+
///       |   | . |  centre of pixel (1,0) is (1.5, 0.5)
///       v   +---+
///       y, height
template <class T>
struct Image {
  int width = 0;       ///< Pixels.
  int height = 0;      ///< Pixels.
  Pixels<T> pixels{};  ///< width * height of them, row by row.

  /// No pixels.
  Image() = default;
  /// All pixels the same.
  Image(int width_px, int height_px, const T& fill = T{})
      : width(width_px), height(height_px), pixels(static_cast<size_t>(width_px) * static_cast<size_t>(height_px), fill) {}

  /// For who writes every pixel: none has a value yet, and threads that write parts of it touch its memory first.
  static Image unset(int width_px, int height_px) {
    Image image;
    image.width = width_px;
    image.height = height_px;
    image.pixels.resize(static_cast<size_t>(width_px) * static_cast<size_t>(height_px));
    return image;
  }

  /// Place of pixel (x, y) in `pixels`; not checked.
  size_t index(int x, int y) const { return static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x); }
  T& at(int x, int y) { return pixels[index(x, y)]; }                                      ///< Pixel (x, y); not checked.
  const T& at(int x, int y) const { return pixels[index(x, y)]; }                          ///< Pixel (x, y); not checked.
  bool inside(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }  ///< True where there is a pixel (x, y).
  size_t size() const { return pixels.size(); }                                            ///< Number of pixels.
};

}  // namespace limn
