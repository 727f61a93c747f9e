#pragma once
// The real program as a child process, and a folder that goes away with the test.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

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
/// Starts it and sends SIGINT once `seconds` have passed.
RunResult interrupt_limn(const std::vector<std::string>& arguments, double seconds, const std::filesystem::path& where = {});

/// The same with SIGKILL, which nothing can answer.
RunResult kill_limn(const std::vector<std::string>& arguments, double seconds, const std::filesystem::path& where = {});

class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }
  std::string file(const std::string& name) const { return (path_ / name).string(); }
  /// Writes a file and returns its path.
  std::string write(const std::string& name, const std::string& content) const;
  /// Names of all files below it, sorted, relative.
  std::vector<std::string> files() const;

 private:
  std::filesystem::path path_;
};

std::string read_bytes(const std::filesystem::path& file);

}  // namespace limn
