#pragma once
// What every fuzzer does with its input: it may be refused in one line, and nothing else may come of it.

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "sdf/error.h"

/// libFuzzer's entry; the replay's too.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace limn::fuzz {

/// A broken promise that no sanitizer sees.
inline void require(bool promise, const char* words) {
  if (promise) return;
  std::fprintf(stderr, "fuzz: %s\n", words);
  std::abort();
}

/// Anything but an InputError of one line ends the program.
template <class Use>
void only_refused(Use&& use) {
  try {
    use();
  } catch (const InputError& error) {
    require(std::string_view(error.what()).find('\n') == std::string_view::npos, "a refusal of more than one line");
  }
}

inline std::string_view text_of(const std::uint8_t* data, std::size_t size) { return {reinterpret_cast<const char*>(data), size}; }

}  // namespace limn::fuzz
