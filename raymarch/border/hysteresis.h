#pragma once
// Thresholds that hold on to what they decided the frame before (Schmitt 1938), so that ink does not toggle where a camera trembles.

#include "raymarch/border.h"

namespace limn {

/// Moves a method's threshold by `amount` in favour of what was there.
struct Hysteresis {
  double amount = 0.0;
  const BorderBefore* before = nullptr;

  /// False where no pixel's threshold moves.
  bool holds() const { return before != nullptr && amount != 0.0; }

  /// What to add to the threshold of pixel i, ink being below it: `amount` where its piece of surface had ink, -`amount` where it had none,
  /// 0 where it was not seen.
  double shift(size_t i) const {
    if (!holds()) return 0.0;
    const std::int32_t was = before->pixels.pixels[i];
    if (was < 0) return 0.0;
    return before->coverage.pixels[static_cast<size_t>(was)] >= 0.5f ? amount : -amount;
  }
};

inline Hysteresis hysteresis_of(const BorderInput& input, const Parameters& parameters) {
  return {parameters.number("hysteresis"), input.before};
}

}  // namespace limn
