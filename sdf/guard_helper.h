#pragma once
// What run_guarded and its helper programs agree on (sdf/guard.h), and the frame of a helper's main.

#include <functional>

#include "sdf/answer.h"

namespace limn {

inline constexpr int kAnswerHandle = 3;  ///< File descriptor of the answer in the helper: a file in memory.
inline constexpr int kExitAnswer = 0;    ///< The answer is complete.
inline constexpr int kExitRefusal = 2;   ///< The answer is one line: why the file cannot be read.
inline constexpr int kExitMemory = 3;    ///< The memory limit was reached.
inline constexpr const char* kMemoryVariable = "LIMN_GUARD_MEMORY";

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define LIMN_SHADOW_MEMORY 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define LIMN_SHADOW_MEMORY 1
#endif
#endif
/// The sanitizers map terabytes of address space that they never touch.
#ifdef LIMN_SHADOW_MEMORY
inline constexpr bool kAddressSpaceCanBeLimited = false;
#else
inline constexpr bool kAddressSpaceCanBeLimited = true;
#endif

/// The body of a helper program's main: limits its own memory to what the guard said beyond what it has now, ends with its parent, and
/// lets `write` put the answer together. InputError and other exceptions become a refusal (their text in one line, control characters as
/// spaces), exhausted memory kExitMemory. Returns main's exit code.
int run_helper(const std::function<void(ByteWriter& answer)>& write);

}  // namespace limn
