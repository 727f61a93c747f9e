#include "samples/page/panels.h"

#include <algorithm>
#include <cmath>

#include "sdf/parallel.h"

namespace limn {
namespace {

struct Block {
  int x0, x1, y0, y1;
};

// Source pixels of one target pixel; at least one.
Block block_of(int x, int y, int width, int height, int source_width, int source_height) {
  const auto begin = [](int i, int n, int source) { return static_cast<int>(static_cast<std::int64_t>(i) * source / n); };
  Block block{begin(x, width, source_width), begin(x + 1, width, source_width), begin(y, height, source_height),
              begin(y + 1, height, source_height)};
  block.x1 = std::max(block.x1, block.x0 + 1);
  block.y1 = std::max(block.y1, block.y0 + 1);
  return block;
}

glm::ivec2 fitted_size(int width, int height, int most_width, int most_height) {
  double factor = std::min(static_cast<double>(most_width) / width, static_cast<double>(most_height) / height);
  if (factor > 1.0) factor = std::floor(factor);
  return {std::max(1, static_cast<int>(width * factor)), std::max(1, static_cast<int>(height * factor))};
}

}  // namespace

Image<glm::vec4> fitted(const Image<glm::vec4>& picture, int width, int height) {
  const glm::ivec2 size = fitted_size(picture.width, picture.height, width, height);
  Image<glm::vec4> out(size.x, size.y);
  parallel_for(0, size.y, [&](int y) {
    for (int x = 0; x < size.x; ++x) {
      const Block block = block_of(x, y, size.x, size.y, picture.width, picture.height);
      glm::vec4 sum(0.0f);
      for (int j = block.y0; j < block.y1; ++j) {
        for (int i = block.x0; i < block.x1; ++i) sum += picture.at(i, j);
      }
      out.at(x, y) = sum / static_cast<float>((block.x1 - block.x0) * (block.y1 - block.y0));
    }
  });
  return out;
}

Image<glm::vec4> fitted_difference(const Image<glm::vec4>& difference, const Image<float>& border, const Image<float>& reference, int width,
                                   int height) {
  Image<glm::vec4> out = fitted(difference, width, height);
  parallel_for(0, out.height, [&](int y) {
    for (int x = 0; x < out.width; ++x) {
      const Block block = block_of(x, y, out.width, out.height, difference.width, difference.height);
      float strongest = 0.0f;
      for (int j = block.y0; j < block.y1; ++j) {
        for (int i = block.x0; i < block.x1; ++i) {
          const float wrong = std::abs(border.at(i, j) - reference.at(i, j));
          if (wrong <= strongest) continue;
          strongest = wrong;
          out.at(x, y) = difference.at(i, j);
        }
      }
    }
  });
  return out;
}

namespace {

/// Pixels [x0, x1) x [y0, y1).
struct PixelBox {
  int x0, y0, x1, y1;
};

/// Sums of what differs over all rectangles from a corner on; beyond `box` nothing differs.
class DifferenceSums {
 public:
  DifferenceSums(const Image<float>& border, const Image<float>& reference, const PixelBox& box)
      : box_(box), stride_(static_cast<size_t>(box.x1 - box.x0 + 1)) {
    sums_.resize(stride_ * static_cast<size_t>(box.y1 - box.y0 + 1), 0.0);
    for (int y = box.y0; y < box.y1; ++y) {
      double* const above = &sums_[static_cast<size_t>(y - box.y0) * stride_];
      double* const here = above + stride_;
      for (int x = box.x0; x < box.x1; ++x) {
        const auto i = static_cast<size_t>(x - box.x0);
        here[i + 1] = here[i] + above[i + 1] - above[i] + std::abs(double{border.at(x, y)} - double{reference.at(x, y)});
      }
    }
  }
  /// Of the pixels [x, x + width) x [y, y + height).
  double of(int x, int y, int width, int height) const {
    const int right = std::min(x + width, box_.x1), bottom = std::min(y + height, box_.y1);
    x = std::max(x, box_.x0);
    y = std::max(y, box_.y0);
    if (x >= right || y >= bottom) return 0.0;
    return to(right, bottom) - to(x, bottom) - to(right, y) + to(x, y);
  }

 private:
  double to(int x, int y) const { return sums_[static_cast<size_t>(y - box_.y0) * stride_ + static_cast<size_t>(x - box_.x0)]; }

  PixelBox box_;
  size_t stride_;
  std::vector<double> sums_{};
};

PixelBox box_of_differences(const Image<float>& border, const Image<float>& reference) {
  PixelBox box{border.width, border.height, 0, 0};
  for (int y = 0; y < border.height; ++y) {
    const float *const a = &border.at(0, y), *const b = &reference.at(0, y);
    const auto differs = [&](int x) { return !(a[x] == b[x]); };
    int first = 0, last = border.width;
    while (first < last && !differs(first)) ++first;
    if (first == last) continue;
    while (!differs(last - 1)) --last;
    box = {std::min(box.x0, first), std::min(box.y0, y), std::max(box.x1, last), y + 1};
  }
  return box;
}

}  // namespace

Window worst_window(const Image<float>& border, const Image<float>& reference, int width, int height) {
  Window best{0, 0, std::min(width, border.width), std::min(height, border.height), 0.0};
  best.x = (border.width - best.width) / 2;
  best.y = (border.height - best.height) / 2;
  const PixelBox box = box_of_differences(border, reference);
  if (box.x0 >= box.x1) return best;
  const DifferenceSums sums(border, reference, box);
  const int last_x = std::min(box.x1 - 1, border.width - best.width), last_y = std::min(box.y1 - 1, border.height - best.height);
  for (int y = std::max(0, box.y0 - best.height + 1); y <= last_y; ++y) {
    for (int x = std::max(0, box.x0 - best.width + 1); x <= last_x; ++x) {
      const double wrong = sums.of(x, y, best.width, best.height);
      if (wrong <= best.wrong_px + 1e-9) continue;
      best.x = x;
      best.y = y;
      best.wrong_px = wrong;
    }
  }
  return best;
}

Window hit_window(const GBuffer& gbuffer) {
  int x0 = gbuffer.width, x1 = -1, y0 = gbuffer.height, y1 = -1;
  for (int y = 0; y < gbuffer.height; ++y) {
    for (int x = 0; x < gbuffer.width; ++x) {
      if (gbuffer.id.at(x, y) == 0) continue;
      x0 = std::min(x0, x);
      x1 = std::max(x1, x);
      y0 = std::min(y0, y);
      y1 = std::max(y1, y);
    }
  }
  if (x1 < 0) return {0, 0, gbuffer.width, gbuffer.height, 0.0};
  const int margin = 1 + gbuffer.height * 3 / 100;
  x0 = std::max(x0 - margin, 0);
  y0 = std::max(y0 - margin, 0);
  x1 = std::min(x1 + margin, gbuffer.width - 1);
  y1 = std::min(y1 + margin, gbuffer.height - 1);
  return {x0, y0, x1 - x0 + 1, y1 - y0 + 1, 0.0};
}

Window merge(const Window& a, const Window& b) {
  const int x = std::min(a.x, b.x), y = std::min(a.y, b.y);
  return {x, y, std::max(a.x + a.width, b.x + b.width) - x, std::max(a.y + a.height, b.y + b.height) - y, a.wrong_px + b.wrong_px};
}

Image<glm::vec4> enlarged(const Image<glm::vec4>& picture, const Window& window, int factor) {
  Image<glm::vec4> out(window.width * factor, window.height * factor);
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) out.at(x, y) = picture.at(window.x + x / factor, window.y + y / factor);
  }
  return out;
}

Image<glm::vec4> ink_on_paper(const Image<float>& border) {
  constexpr float kInk = 0.4f;  // the grey that difference pictures have for common ink
  Image<glm::vec4> out(border.width, border.height);
  for (size_t i = 0; i < border.size(); ++i) out.pixels[i] = glm::vec4(glm::vec3(1.0f - border.pixels[i] * (1.0f - kInk)), 1.0f);
  return out;
}

}  // namespace limn
