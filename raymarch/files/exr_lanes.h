#pragma once
// Internal: what every byte of an EXR file goes through before it is compressed, with the widest SIMD of the machine.

#include <cstddef>
#include <cstdint>

namespace limn {

/// Floats as 16-bit ones, rounded to the nearest, ties to even; beyond 65,504 and a half step they are infinite. NaN keeps its leading
/// bits, as Imath's half has it.
void to_halves(const float* values, std::size_t count, std::uint16_t* halves);

/// Differences of the bytes at even and of those at odd places of a row from the ones before, about 128 (OpenEXR, "File Layout"): `pairs`
/// of them, whose first is left to the caller.
void split_differences(const std::uint8_t* row, std::size_t pairs, std::uint8_t* even, std::uint8_t* odd);

}  // namespace limn
