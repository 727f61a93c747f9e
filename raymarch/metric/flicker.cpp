// Ink that comes and goes while the camera moves by parts of a pixel, beyond what the true border's does.

#include <limits>

#include "raymarch/metric.h"
#include "raymarch/metric/flips.h"
#include "sdf/error.h"

namespace limn {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

std::vector<MetricValue> measure(const MetricInput& input) {
  LIMN_CHECK(input.moved.size() == input.reference_moved.size());
  const Image<std::int32_t> at_rest;
  const auto before = [&](std::span<const Image<std::int32_t>> all, size_t frame) -> const Image<std::int32_t>& {
    LIMN_CHECK(all.empty() || all.size() + 1 == input.moved.size());
    return all.empty() || frame == 0 ? at_rest : all[frame - 1];
  };
  FlipHistory history;
  FrameFlips sum;
  for (size_t k = 0; k < input.moved.size(); ++k) {
    const FrameFlips frame = count_flips({input.moved[k], before(input.moved_before, k)},
                                         {input.reference_moved[k], before(input.reference_moved_before, k)}, history);
    sum.flips += frame.flips;
    sum.reference_flips += frame.reference_flips;
    sum.beyond += frame.beyond;
    sum.border += frame.border;
  }
  const auto share = [&](std::int64_t count) {
    return sum.border > 0 ? static_cast<double>(count) / static_cast<double>(sum.border) : kNothing;
  };
  return {{"flicker", share(sum.beyond), ""},
          {"flicker_flips", share(sum.flips), ""},
          {"flicker_reference_flips", share(sum.reference_flips), ""}};
}

}  // namespace

Metric flicker_metric() {
  return {{"flicker",
           "flips of ink on surface that stays in sight, from frame to frame of a camera that moves by parts of a pixel, which are not the "
           "reference's, for each pixel of the reference's border and frame; all of the model's flips; all of the reference's",
           "limn"},
          {"flicker", "flicker_flips", "flicker_reference_flips"},
          true,
          measure,
          MetricSubject::motion};
}

}  // namespace limn
