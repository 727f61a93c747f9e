#pragma once

#include <string>
#include <string_view>

namespace limn {

/// The text with every byte that is no valid UTF-8 replaced by U+FFFD: file names may hold any bytes, JSON and pages may not.
std::string valid_utf8(std::string_view text);

}  // namespace limn
