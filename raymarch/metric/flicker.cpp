// Ink that comes and goes while the camera moves by parts of a pixel, beyond what the true border's does.

#include <limits>

#include "raymarch/metric/ink_mask.h"
#include "raymarch/metric/registry.h"
#include "sdf/error.h"

namespace limn {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

/// Pixels of ink with paper on one of their four sides.
double border_pixels(const Image<std::uint8_t>& ink) {
  double count = 0.0;
  for (int y = 0; y < ink.height; ++y) {
    for (int x = 0; x < ink.width; ++x) {
      const auto paper = [&](int u, int v) { return ink.inside(u, v) && !ink.at(u, v); };
      count += ink.at(x, y) && (paper(x - 1, y) || paper(x + 1, y) || paper(x, y - 1) || paper(x, y + 1));
    }
  }
  return count;
}

std::vector<MetricValue> measure(const MetricInput& input) {
  LIMN_CHECK(input.moved.size() == input.reference_moved.size());
  double flips = 0.0, reference_flips = 0.0, beyond = 0.0, pixels = 0.0;
  Image<std::uint8_t> own, wanted;
  for (size_t k = 0; k < input.moved.size(); ++k) {
    LIMN_CHECK(input.moved[k].size() == input.reference_moved[k].size());
    const Image<std::uint8_t> own_before = std::move(own), wanted_before = std::move(wanted);
    own = ink_mask(input.moved[k]);
    wanted = ink_mask(input.reference_moved[k]);
    if (k == 0) continue;
    pixels += border_pixels(wanted);
    for (size_t i = 0; i < own.size(); ++i) {
      const bool flip = own.pixels[i] != own_before.pixels[i], reference = wanted.pixels[i] != wanted_before.pixels[i];
      flips += flip;
      reference_flips += reference;
      beyond += flip && !reference;
    }
  }
  const bool any = pixels > 0.0;
  return {{"flicker", any ? beyond / pixels : kNothing, ""},
          {"flicker_flips", any ? flips / pixels : kNothing, ""},
          {"flicker_reference_flips", any ? reference_flips / pixels : kNothing, ""}};
}

}  // namespace

Metric flicker_metric() {
  return {{"flicker",
           "pixels whose ink crosses one half from one moved picture to the next where the reference's does not, for each pixel of the "
           "reference's border and move; all of the model's flips; all of the reference's",
           "limn"},
          {"flicker", "flicker_flips", "flicker_reference_flips"},
          true,
          measure,
          MetricSubject::motion};
}

}  // namespace limn
