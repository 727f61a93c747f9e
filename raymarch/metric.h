#pragma once
// Numbers that say how far a picture is from a reference. One file in raymarch/metric/ and one line in its registry.

#include "raymarch/picture.h"

namespace limn {

struct MetricInput {
  const Picture& picture;
  const Picture& reference;  ///< Same camera and size.
  const Camera& camera;
};

struct MetricValue {
  std::string name{};  ///< "normal_error_mean"
  double value = 0.0;  ///< NaN where there is nothing to measure.
  std::string unit{};  ///< "px", "deg", ""
};

struct Metric {
  Description about{};
  std::vector<std::string> values{};  ///< Names of the values it yields, with units: "normal_error_mean [deg]".
  bool lower_is_better = true;
  std::vector<MetricValue> (*measure)(const MetricInput& input);
  bool of_border = false;  ///< It reads the ink; else the G-buffer alone, and is the same for every method.
};

std::span<const Metric> metrics();
const Metric& find_metric(const std::string& name, const std::string& file = {}, const std::string& field = {});

/// Where two borders differ: missing in blue, false in red, common in grey, on white; linear RGBA.
Image<glm::vec4> difference_picture(const Image<float>& border, const Image<float>& reference);

}  // namespace limn
