#pragma once

#include <cstddef>
#include <vector>

#include "sdf/error.h"

namespace limn {

/// A plain picture: row-major, origin top left, pixel (x, y) covers [x, x+1) x [y, y+1), its centre is at +0.5.
///
///     (0,0) ------> x, width
///       |   +---+
///       |   | . |  centre of pixel (1,0) is (1.5, 0.5)
///       v   +---+
///       y, height
template <class T>
struct Image {
  int width = 0;
  int height = 0;
  std::vector<T> pixels{};

  Image() = default;
  Image(int width_px, int height_px, const T& fill = T{})
      : width(width_px), height(height_px), pixels(static_cast<size_t>(width_px) * static_cast<size_t>(height_px), fill) {}

  size_t index(int x, int y) const { return static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x); }
  T& at(int x, int y) { return pixels[index(x, y)]; }
  const T& at(int x, int y) const { return pixels[index(x, y)]; }
  bool inside(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
  size_t size() const { return pixels.size(); }
};

}  // namespace limn
