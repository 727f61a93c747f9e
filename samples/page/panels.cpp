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

Window worst_window(const Image<float>& border, const Image<float>& reference, int width, int height) {
  Window best{0, 0, std::min(width, border.width), std::min(height, border.height), -1.0};
  // Sums over all rectangles from the top left corner.
  std::vector<double> sums(static_cast<size_t>(border.width + 1) * static_cast<size_t>(border.height + 1), 0.0);
  const auto at = [&](int x, int y) -> double& {
    return sums[static_cast<size_t>(y) * static_cast<size_t>(border.width + 1) + static_cast<size_t>(x)];
  };
  for (int y = 0; y < border.height; ++y) {
    for (int x = 0; x < border.width; ++x) {
      at(x + 1, y + 1) = at(x, y + 1) + at(x + 1, y) - at(x, y) + std::abs(double{border.at(x, y)} - double{reference.at(x, y)});
    }
  }
  const glm::ivec2 middle((border.width - best.width) / 2, (border.height - best.height) / 2);
  best.x = middle.x;
  best.y = middle.y;
  for (int y = 0; y + best.height <= border.height; ++y) {
    for (int x = 0; x + best.width <= border.width; ++x) {
      const double wrong = at(x + best.width, y + best.height) - at(x, y + best.height) - at(x + best.width, y) + at(x, y);
      if (wrong <= best.wrong_px + 1e-9) continue;
      best.x = x;
      best.y = y;
      best.wrong_px = wrong;
    }
  }
  if (best.wrong_px <= 1e-9) {
    best = {middle.x, middle.y, best.width, best.height, 0.0};
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
