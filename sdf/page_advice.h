#pragma once
// Internal: what the system is told of memory.

#include <cstddef>

namespace limn {

inline constexpr std::size_t kLargePageBytes = std::size_t{2} << 20;

/// Asks for large pages under memory before its first touch: under as many of its bytes as fill such pages. A wish, no more: where it is
/// not granted everything works the same.
void ask_for_large_pages(void* memory, std::size_t bytes);

}  // namespace limn
