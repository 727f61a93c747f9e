#include "raymarch/border/blur_passes.h"

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "raymarch/border/picture_rows.h"

namespace limn {
namespace {

/// A plane as OpenCV sees it, without a copy. OpenCV has no header for const pixels; sources are never written.
cv::Mat as_matrix(const Image<float>& image) { return {image.height, image.width, CV_32F, const_cast<float*>(image.pixels.data())}; }

/// Runs `filter(from, to)` on bands of lines. A band is part of the whole matrix, so a filter sees the true lines beyond it.
template <class Filter>
void filter_bands(const Image<float>& source, Image<float>& target, const Filter& filter) {
  const cv::Mat from = as_matrix(source), to = as_matrix(target);
  for_each_band(source.height, [&](int y0, int y1) {
    cv::Mat part = to.rowRange(y0, y1);
    filter(from.rowRange(y0, y1), part);
    LIMN_CHECK(part.data == to.ptr(y0));  // OpenCV would have allocated anew for another size or type
  });
}

}  // namespace

std::vector<float> blur_taps(BlurKernel kernel, int radius_px) {
  const double sigma = radius_px / 3.0;
  std::vector<double> taps;
  double sum = 0.0;
  for (int i = -radius_px; i <= radius_px; ++i) {
    taps.push_back(kernel == BlurKernel::box || radius_px == 0 ? 1.0 : std::exp(-0.5 * i * i / (sigma * sigma)));
    sum += taps.back();
  }
  std::vector<float> weights;
  for (const double tap : taps) weights.push_back(static_cast<float>(tap / sum));
  return weights;
}

Image<float> blur_separable(const Image<float>& source, BlurKernel kernel, int radius_px) {
  Image<float> across(source.width, source.height), both(source.width, source.height);
  const int taps = 2 * radius_px + 1;
  const cv::Point middle(-1, -1);
  if (kernel == BlurKernel::box) {
    filter_bands(source, across, [&](const cv::Mat& from, cv::Mat& to) {
      cv::boxFilter(from, to, CV_32F, {taps, 1}, middle, true, cv::BORDER_REPLICATE);
    });
    filter_bands(across, both, [&](const cv::Mat& from, cv::Mat& to) {
      cv::boxFilter(from, to, CV_32F, {1, taps}, middle, true, cv::BORDER_REPLICATE);
    });
    return both;
  }
  const std::vector<float> weights = blur_taps(kernel, radius_px), one{1.0f};
  filter_bands(source, across, [&](const cv::Mat& from, cv::Mat& to) {
    cv::sepFilter2D(from, to, CV_32F, weights, one, middle, 0.0, cv::BORDER_REPLICATE);
  });
  filter_bands(across, both, [&](const cv::Mat& from, cv::Mat& to) {
    cv::sepFilter2D(from, to, CV_32F, one, weights, middle, 0.0, cv::BORDER_REPLICATE);
  });
  return both;
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
