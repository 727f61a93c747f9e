#include "raymarch/files/srgb_bytes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "sdf/color.h"

namespace limn {
namespace {

constexpr int kShift = 23;

std::uint8_t by_formula(float linear) { return to_byte(srgb_from_linear(linear)); }

/// Floats above 0 are in the order of their bits.
float smallest_with(std::uint8_t code) {
  std::uint32_t below = 0, at = std::bit_cast<std::uint32_t>(1.0f);
  while (at - below > 1) {
    const std::uint32_t middle = below + (at - below) / 2;
    (by_formula(std::bit_cast<float>(middle)) >= code ? at : below) = middle;
  }
  return std::bit_cast<float>(at);
}

}  // namespace

std::uint8_t to_byte(float value) {
  // The comparison is false for NaN, which becomes 0.
  return static_cast<std::uint8_t>(value > 0.0f ? std::lround(255.0f * std::min(value, 1.0f)) : 0);
}

SrgbBytes::SrgbBytes() {
  for (size_t code = 1; code < 256; ++code) from_[code] = smallest_with(static_cast<std::uint8_t>(code));
  from_[256] = std::numeric_limits<float>::infinity();
  for (size_t key = 0; key < first_.size(); ++key) {
    const std::uint32_t bits = (static_cast<std::uint32_t>(key) << (kShift - kMantissaBits)) + (std::uint32_t{kFirstExponent} << kShift);
    first_[key] = by_formula(std::bit_cast<float>(bits));
  }
}

std::uint8_t SrgbBytes::operator()(float linear) const {
  if (!(linear >= 0x1p-13f)) return 0;
  if (linear >= 1.0f) return 255;
  const std::uint32_t key = (std::bit_cast<std::uint32_t>(linear) - (std::uint32_t{kFirstExponent} << kShift)) >> (kShift - kMantissaBits);
  size_t code = first_[key];
  while (linear >= from_[code + 1]) ++code;
  return static_cast<std::uint8_t>(code);
}

}  // namespace limn
