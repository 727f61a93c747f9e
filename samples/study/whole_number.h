#pragma once
// Whole numbers of files that nobody vouches for.

#include <cstdint>
#include <optional>
#include <utility>

#include "samples/output/output.h"

namespace limn {

/// `value` where it is a whole number that an Integer holds. JSON's own conversion cuts off what does not fit, and reads digits beyond 64
/// bits as a real number, of which the language does not define the conversion.
template <class Integer>
std::optional<Integer> whole_number(const Json& value) {
  if (value.is_number_unsigned()) {
    const auto number = value.get<std::uint64_t>();
    return std::in_range<Integer>(number) ? std::optional(static_cast<Integer>(number)) : std::nullopt;
  }
  if (!value.is_number_integer()) return std::nullopt;
  const auto number = value.get<std::int64_t>();
  return std::in_range<Integer>(number) ? std::optional(static_cast<Integer>(number)) : std::nullopt;
}

}  // namespace limn
