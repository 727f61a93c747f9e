#include "raymarch/picture/srgb_bytes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "sdf/color.h"
#include "sdf/error.h"

namespace limn {
namespace {

constexpr int kShift = 23;

std::uint8_t by_formula(float linear) { return to_byte(srgb_from_linear(linear)); }

/// The least of a key.
float float_of(size_t key) {
  constexpr int kKeyShift = kShift - SrgbBytes::kMantissaBits;
  return std::bit_cast<float>((static_cast<std::uint32_t>(key) << kKeyShift) + (std::uint32_t{SrgbBytes::kFirstExponent} << kShift));
}

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
  std::array<float, 257> from{};  // the least float of each code
  for (size_t code = 1; code < 256; ++code) from[code] = smallest_with(static_cast<std::uint8_t>(code));
  from[256] = std::numeric_limits<float>::infinity();
  size_t code = 0;
  for (size_t key = 0; key < kKeys; ++key) {
    const float least = float_of(key), after = float_of(key + 1);
    while (least >= from[code + 1]) ++code;
    first_[key] = static_cast<std::int32_t>(code);
    next_[key] = from[code + 1];
    LIMN_CHECK(code == 255 || from[code + 2] >= after);
  }
}

std::uint8_t SrgbBytes::operator()(float linear) const {
  if (!(linear >= 0x1p-13f)) return 0;
  if (linear >= 1.0f) return 255;
  const std::uint32_t key = (std::bit_cast<std::uint32_t>(linear) - (std::uint32_t{kFirstExponent} << kShift)) >> (kShift - kMantissaBits);
  return static_cast<std::uint8_t>(first_[key] + (linear >= next_[key] ? 1 : 0));
}

const SrgbBytes& srgb_bytes() {
  static const SrgbBytes bytes;
  return bytes;
}

}  // namespace limn
