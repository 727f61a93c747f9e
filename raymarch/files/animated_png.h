#pragma once
// Several PNG files as one that plays them (APNG 1.0; PNG third edition): their compressed rows are kept as they are.

#include <cstddef>
#include <span>
#include <vector>

namespace limn {

/// Whole PNG files of one size and kind, at least one, as png_file() makes them; played round and round. Programs that know no APNG show
/// the first. 0 < frames_per_second <= 100.
std::vector<std::byte> animated_png(std::span<const std::vector<std::byte>> frames, double frames_per_second);

}  // namespace limn
