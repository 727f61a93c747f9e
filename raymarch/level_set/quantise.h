#pragma once
// Internal: values of a level set as a brick's steps, several at a time.

#include <cstdint>
#include <span>

namespace limn {

/// Each as quantised() has it (bricks.h); what is no number becomes 0.
void quantise(std::span<const float> values, float steps_per_unit, std::int16_t* steps);

}  // namespace limn
