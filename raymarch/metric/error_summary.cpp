#include "raymarch/metric/error_summary.h"

#include <algorithm>
#include <cmath>

#include "sdf/quantile.h"

namespace limn {

std::vector<MetricValue> summarise_errors(std::vector<PixelError> errors, const std::string& name, const std::string& unit) {
  constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
  double mean = nothing, rms = nothing, p99 = nothing;
  PixelError worst{0, 0, nothing};
  double worst_x = nothing, worst_y = nothing;
  if (!errors.empty()) {
    double sum = 0.0, squares = 0.0;
    for (const PixelError& error : errors) {
      sum += error.value;
      squares += error.value * error.value;
    }
    mean = sum / static_cast<double>(errors.size());
    rms = std::sqrt(squares / static_cast<double>(errors.size()));
    worst = *std::max_element(errors.begin(), errors.end(), [](const PixelError& a, const PixelError& b) { return a.value < b.value; });
    worst_x = worst.x;
    worst_y = worst.y;
    std::vector<double> values;
    values.reserve(errors.size());
    for (const PixelError& error : errors) values.push_back(error.value);
    p99 = nearest_rank_quantile(std::move(values), 0.99);
  }
  return {{name + "_mean", mean, unit},       {name + "_rms", rms, unit},       {name + "_p99", p99, unit},
          {name + "_max", worst.value, unit}, {name + "_max_x", worst_x, "px"}, {name + "_max_y", worst_y, "px"}};
}

std::vector<std::string> summary_names(const std::string& name, const std::string& unit) {
  return {name + "_mean [" + unit + "]", name + "_rms [" + unit + "]", name + "_p99 [" + unit + "]",
          name + "_max [" + unit + "]",  name + "_max_x [px]",         name + "_max_y [px]"};
}

bool both_hit(const MetricInput& input, size_t pixel) {
  constexpr auto hit = static_cast<std::uint8_t>(HitStatus::hit);
  return input.picture.gbuffer.status.pixels[pixel] == hit && input.reference.gbuffer.status.pixels[pixel] == hit;
}

}  // namespace limn
