#pragma once
// Programs run to their end, and what they took.

#include <filesystem>
#include <string>
#include <vector>

namespace limn::bench {

/// With all that the program started.
struct ProcessCost {
  double wall_ms = 0.0;     ///< From its start to its end.
  double cpu_s = 0.0;       ///< User and system.
  double peak_bytes = 0.0;  ///< Resident, of the largest process.
  std::string output{};     ///< Its standard output.
};

/// call[0] is a file, or a program on the PATH. Throws InputError where it cannot be started or fails.
ProcessCost run_measured(const std::vector<std::string>& call);

/// The file of a program on the PATH; empty where there is none.
std::filesystem::path find_program(const std::string& name);

}  // namespace limn::bench
