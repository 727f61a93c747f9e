// limn-filters.so: OpenCV's filters behind the functions of raymarch/border/filter_module.h, loaded when they are needed.

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "raymarch/border/filter_module.h"
#include "sdf/version.h"

namespace limn {
namespace {

/// A band's lines as OpenCV's matrices, in the same memory.
struct Matrices {
  explicit Matrices(const FilterBand& band)
      : source(band.rows + 2 * band.radius_px, band.width, CV_32F, const_cast<float*>(band.source)),
        // A part of a matrix: the filters see the true lines above and below it.
        middle(source.rowRange(band.radius_px, band.radius_px + band.rows)),
        blurred(band.rows, band.width, CV_32F, band.blurred) {}
  cv::Mat source, middle, blurred;
};

void blur_box(const FilterBand& band) {
  Matrices lines(band);
  const int taps = 2 * band.radius_px + 1;
  cv::boxFilter(lines.middle, lines.blurred, CV_32F, {taps, taps}, {-1, -1}, true, cv::BORDER_REPLICATE);
}

void blur_separably(const FilterBand& band, std::span<const float> weights) {
  Matrices lines(band);
  const std::vector<float> taps(weights.begin(), weights.end());
  cv::sepFilter2D(lines.middle, lines.blurred, CV_32F, taps, taps, {-1, -1}, 0.0, cv::BORDER_REPLICATE);
}

}  // namespace
}  // namespace limn

extern "C" __attribute__((visibility("default"))) void limn_filter_module(limn::FilterModule& module) {
  using namespace limn;
  module = {kVersion, blur_box, blur_separably};
}
