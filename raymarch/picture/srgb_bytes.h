#pragma once
// Linear light as 8-bit sRGB, the same bytes as from the formula, without its powers.

#include <array>
#include <cstddef>
#include <cstdint>

namespace limn {

/// From 0 to 1, rounded to the nearest of 255 parts; NaN is 0.
std::uint8_t to_byte(float value);

/// to_byte(srgb_from_linear(linear)) for every float, by tables: a float's leading bits, its key, tell its code up to one.
class SrgbBytes {
 public:
  SrgbBytes();
  std::uint8_t operator()(float linear) const;

  static constexpr int kMantissaBits = 7, kFirstExponent = 127 - 13, kExponents = 13;  // below 2^-13 is code 0, from 1 on it is 255
  static constexpr std::size_t kKeys = static_cast<std::size_t>(kExponents) << kMantissaBits;
  /// The code of the least float of each key.
  const std::array<std::int32_t, kKeys>& first() const { return first_; }
  /// From where on the code is one more. No key holds two such places.
  const std::array<float, kKeys>& next() const { return next_; }

 private:
  std::array<std::int32_t, kKeys> first_{};
  std::array<float, kKeys> next_{};
};

/// The tables, made once.
const SrgbBytes& srgb_bytes();

}  // namespace limn
