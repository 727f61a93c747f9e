#include "raymarch/border/blur_passes.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "raymarch/border/filter_module.h"
#include "raymarch/gbuffer/picture_rows.h"
#include "sdf/parallel.h"

namespace limn {

std::vector<float> blur_taps(BlurKernel kernel, int radius_px) {
  const double sigma = radius_px / 3.0;
  std::vector<double> taps;
  double sum = 0.0;
  for (int i = -radius_px; i <= radius_px; ++i) {
    taps.push_back(kernel == BlurKernel::box || radius_px == 0 ? 1.0 : std::exp(-0.5 * i * i / (sigma * sigma)));
    sum += taps.back();
  }
  std::vector<float> weights;
  weights.reserve(taps.size());
  for (const double tap : taps) weights.push_back(static_cast<float>(tap / sum));
  return weights;
}

void blur_lines(int width, int height, BlurKernel kernel, int radius_px, const std::function<void(int, float*)>& read,
                const std::function<void(int, const float*)>& write) {
  const int taps = 2 * radius_px + 1;
  // Twice the radius and more, or the lines that neighbouring bands both filter would be most of the work.
  const int band_rows = std::max(64, 2 * taps);
  const std::vector<float> weights = blur_taps(kernel, radius_px);
  const FilterModule& filters = filter_module();
  const auto line = static_cast<size_t>(width);
  parallel_for(0, (height + band_rows - 1) / band_rows, [&](int band) {
    const int y0 = band * band_rows, y1 = std::min(height, y0 + band_rows);
    const auto rows = static_cast<size_t>(y1 - y0), read_rows = rows + 2 * static_cast<size_t>(radius_px);
    const auto source = std::make_unique_for_overwrite<float[]>(read_rows * line),
               blurred = std::make_unique_for_overwrite<float[]>(rows * line);
    for (size_t row = 0; row < read_rows; ++row) {
      const int y = y0 - radius_px + static_cast<int>(row), inside = std::clamp(y, 0, height - 1);
      float* const to = source.get() + row * line;
      if (row > 0 && inside == std::clamp(y - 1, 0, height - 1)) {
        std::copy_n(to - line, line, to);
      } else {
        read(inside, to);
      }
    }
    const FilterBand lines{source.get(), blurred.get(), width, y1 - y0, radius_px};
    kernel == BlurKernel::box ? filters.blur_box(lines) : filters.blur_separably(lines, weights);
    for (size_t row = 0; row < rows; ++row) write(y0 + static_cast<int>(row), blurred.get() + row * line);
  });
}

Image<float> blur_separable(const Image<float>& source, BlurKernel kernel, int radius_px) {
  Image<float> blurred(source.width, source.height);
  const auto width = static_cast<size_t>(source.width);
  blur_lines(
      source.width, source.height, kernel, radius_px, [&](int y, float* line) { std::copy_n(&source.at(0, y), width, line); },
      [&](int y, const float* line) { std::copy_n(line, width, &blurred.at(0, y)); });
  return blurred;
}

Image<float> reduced(const Image<float>& source, int scale) {
  Image<float> small((source.width + scale - 1) / scale, (source.height + scale - 1) / scale);
  for_each_band(small.height, [&](int y0, int y1) {
    for (int y = y0; y < y1; ++y) {
      for (int x = 0; x < small.width; ++x) {
        const int right = std::min(source.width, (x + 1) * scale), bottom = std::min(source.height, (y + 1) * scale);
        float sum = 0.0f;
        for (int v = y * scale; v < bottom; ++v) {
          for (int u = x * scale; u < right; ++u) sum += source.at(u, v);
        }
        small.at(x, y) = sum / static_cast<float>((right - x * scale) * (bottom - y * scale));
      }
    }
  });
  return small;
}

Image<float> enlarged(const Image<float>& source, int scale, int width, int height) {
  struct Place {
    int low, high;
    float share;
  };
  const auto place_of = [scale](int pixel, int count) {
    const float at = std::clamp((static_cast<float>(pixel) + 0.5f) / static_cast<float>(scale) - 0.5f, 0.0f, static_cast<float>(count - 1));
    const int low = static_cast<int>(at);
    return Place{low, std::min(low + 1, count - 1), at - static_cast<float>(low)};
  };
  std::vector<Place> columns;
  columns.reserve(static_cast<size_t>(width));
  for (int x = 0; x < width; ++x) columns.push_back(place_of(x, source.width));
  Image<float> large(width, height);
  for_each_band(height, [&](int y0, int y1) {
    for (int y = y0; y < y1; ++y) {
      const Place row = place_of(y, source.height);
      const float *top = &source.at(0, row.low), *bottom = &source.at(0, row.high);
      for (int x = 0; x < width; ++x) {
        const Place& column = columns[static_cast<size_t>(x)];
        const float upper = top[column.low] + column.share * (top[column.high] - top[column.low]);
        const float lower = bottom[column.low] + column.share * (bottom[column.high] - bottom[column.low]);
        large.at(x, y) = upper + row.share * (lower - upper);
      }
    }
  });
  return large;
}

}  // namespace limn
