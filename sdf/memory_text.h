#pragma once
// Internal: amounts of memory in words.

#include <string>

namespace limn {

/// "640 B", "12.3 kB", "45.6 MB", "1.25 GB": powers of 1000.
std::string memory_text(double bytes);

}  // namespace limn
