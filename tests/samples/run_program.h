#pragma once
// The real program as a child process.

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/temporary_folder.h"

namespace limn {

struct RunResult {
  int exit_code = -1;  ///< 128 + signal where one ended it.
  std::string out, err;
  double peak_bytes = 0.0;  ///< Of resident memory, its helpers' not counted.
  int err_lines() const;
  nlohmann::json json() const { return nlohmann::json::parse(out); }
};

/// Runs LIMN_PROGRAM with `arguments`, in the folder `where` if given.
RunResult run_limn(const std::vector<std::string>& arguments, const std::filesystem::path& where = {});
/// The same where the system gives it no more than so many bytes of memory, which it does not know.
RunResult run_limn_within(std::uint64_t most_bytes, const std::vector<std::string>& arguments, const std::filesystem::path& where = {});
/// Starts it and sends SIGINT once `seconds` have passed.
RunResult interrupt_limn(const std::vector<std::string>& arguments, double seconds, const std::filesystem::path& where = {});

/// The same with SIGKILL, which nothing can answer.
RunResult kill_limn(const std::vector<std::string>& arguments, double seconds, const std::filesystem::path& where = {});

std::string read_bytes(const std::filesystem::path& file);

}  // namespace limn
