#pragma once
// Reading files that nobody vouches for: a helper program reads, under limits, and sends back plain bytes that we then validate.

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "sdf/answer.h"

namespace limn {

/// What a helper program may take.
struct GuardLimits {
  std::int64_t memory_bytes = std::int64_t{6} << 30;  ///< Address space of the helper, beyond what it starts with.
  std::int64_t answer_bytes = std::int64_t{4} << 30;  ///< Size of its answer.
  std::chrono::milliseconds time{120'000};            ///< Wall clock.
};

/// Where a helper program or module is: in $LIMN_HELPERS, beside the running program, in the installed libexec folder or in the build tree.
/// Throws MachineError that says where it was looked for.
std::filesystem::path find_helper(const std::string& name);

/// Runs the helper program `name` with `arguments`, and returns all that it wrote to its answer, which nobody can change any more.
/// The helper's exit codes: 0 answer complete; 2 the file is at fault, its one-line reason being the answer.
/// Throws InputError (file = `file`) for exit 2, a crash, a timeout or exhausted limits, each in its own words; MachineError where the
/// helper cannot be started.
MappedBytes run_guarded(const std::string& name, std::span<const std::string> arguments, const std::filesystem::path& file,
                        const GuardLimits& limits = {});

/// Plain checks every reader makes first: exists, is a regular file, is not empty, is readable. Throws InputError.
void check_readable(const std::filesystem::path& file, const std::string& what);

}  // namespace limn
