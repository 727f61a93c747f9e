#pragma once
// Internal: inks of pixel-wise methods that depend on N.V alone, several pixels at a time.

#include <cstdint>
#include <span>

namespace limn {

/// 1 - smoothstep(edge - half, edge + half, N.V) where something is hit, as float; in double precision as that function is.
void rim_ink(double edge, double half, std::span<const float> n_dot_v, std::span<const std::int32_t> id, std::span<float> coverage);

}  // namespace limn
