#pragma once

#include <string>

namespace limn {

/// Our own version, those of the libraries in use, and the SIMD setting, as `--version` prints them.
std::string version_text();

}  // namespace limn
