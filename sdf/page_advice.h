#pragma once
// Internal: what the system is told of memory that others took.

#include <cstddef>

namespace limn {

/// Asks for large pages under memory before its first touch: under as many of its bytes as fill such pages. A wish, no more: where it is
/// not granted everything works the same.
void ask_for_large_pages(void* memory, std::size_t bytes);

}  // namespace limn
