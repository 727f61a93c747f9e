#pragma once
// Linear light as 8-bit sRGB, the same bytes as from the formula, without its powers.

#include <array>
#include <cstddef>
#include <cstdint>

namespace limn {

/// From 0 to 1, rounded to the nearest of 255 parts; NaN is 0.
std::uint8_t to_byte(float value);

/// to_byte(srgb_from_linear(linear)) for every float, by a table: the code that a float's leading bits begin with, and where codes change.
class SrgbBytes {
 public:
  SrgbBytes();
  std::uint8_t operator()(float linear) const;

 private:
  static constexpr int kMantissaBits = 6, kFirstExponent = 127 - 13, kExponents = 13;  // 2^-13 and below is code 0
  std::array<float, 257> from_{};  // the smallest float of each code; the last is never reached
  std::array<std::uint8_t, static_cast<std::size_t>(kExponents) << kMantissaBits> first_{};
};

}  // namespace limn
