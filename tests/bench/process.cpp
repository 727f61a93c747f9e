#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <sstream>

#include "sdf/error.h"
#include "tests/bench/process.h"

extern char** environ;

namespace limn::bench {
namespace {

double seconds(const timeval& time) { return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec); }

std::string text_of(const std::vector<std::string>& call) {
  std::string text;
  for (const std::string& word : call) text += (text.empty() ? "" : " ") + word;
  return text;
}

std::string read_all(int descriptor) {
  std::string text;
  std::array<char, 65536> part;
  for (ssize_t got = 0; (got = ::read(descriptor, part.data(), part.size())) > 0;) text.append(part.data(), static_cast<size_t>(got));
  return text;
}

}  // namespace

ProcessCost run_measured(const std::vector<std::string>& call) {
  std::vector<char*> words;
  for (const std::string& word : call) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) throw MachineError("no pipe could be opened");
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  pid_t child = 0;
  const auto start = std::chrono::steady_clock::now();
  const int failed = ::posix_spawnp(&child, words[0], &actions, nullptr, words.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  ::close(ends[1]);
  ProcessCost cost;
  if (failed == 0) cost.output = read_all(ends[0]);
  ::close(ends[0]);
  if (failed != 0) throw InputError({.field = "--program", .value = call[0], .problem = "cannot be started", .expected = "a program"});
  int status = 0;
  rusage usage{};
  while (::wait4(child, &status, 0, &usage) < 0 && errno == EINTR) {
  }
  cost.wall_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw InputError({.field = "bench", .value = text_of(call), .problem = "the call failed", .expected = "exit code 0"});
  cost.cpu_s = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  cost.peak_bytes = 1024.0 * static_cast<double>(usage.ru_maxrss);
  return cost;
}

std::filesystem::path find_program(const std::string& name) {
  const char* const path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const std::filesystem::path file = std::filesystem::path(folder) / name;
    if (::access(file.c_str(), X_OK) == 0) return file;
  }
  return {};
}

}  // namespace limn::bench
