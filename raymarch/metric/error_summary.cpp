#include "raymarch/metric/error_summary.h"

#include <algorithm>
#include <cmath>

#include "sdf/quantile.h"

namespace limn {

std::vector<MetricValue> summarise_errors(PixelErrors errors, int width_px, const std::string& name, const std::string& unit) {
  constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
  double mean = nothing, rms = nothing, p99 = nothing, worst = nothing, worst_x = nothing, worst_y = nothing;
  if (const std::vector<double>& values = errors.values; !values.empty()) {
    double sum = 0.0, squares = 0.0;
    for (const double value : values) {
      sum += value;
      squares += value * value;
    }
    mean = sum / static_cast<double>(values.size());
    rms = std::sqrt(squares / static_cast<double>(values.size()));
    const auto largest = std::max_element(values.begin(), values.end());
    worst = *largest;
    const auto pixel = static_cast<int>(errors.pixels[static_cast<size_t>(largest - values.begin())]), row = pixel / width_px;
    worst_x = pixel - row * width_px;
    worst_y = row;
    p99 = nearest_rank_quantile(std::move(errors.values), 0.99);
  }
  return {{name + "_mean", mean, unit}, {name + "_rms", rms, unit},       {name + "_p99", p99, unit},
          {name + "_max", worst, unit}, {name + "_max_x", worst_x, "px"}, {name + "_max_y", worst_y, "px"}};
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
