#include "run_program.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace limn {
namespace fs = std::filesystem;

namespace {

void to_file(const char* path, int descriptor) {
  const int file = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0600);
  if (file < 0 || dup2(file, descriptor) < 0) _exit(99);
  close(file);
}

pid_t start(const std::vector<std::string>& arguments, const fs::path& where, const fs::path& out, const fs::path& err,
            rlim_t most_bytes = RLIM_INFINITY) {
  std::vector<char*> argv;
  std::string program = LIMN_PROGRAM;
  argv.push_back(program.data());
  std::vector<std::string> copies = arguments;
  for (std::string& argument : copies) argv.push_back(argument.data());
  argv.push_back(nullptr);
  const std::string out_name = out.string(), err_name = err.string(), folder = where.string();
  const pid_t child = fork();
  if (child != 0) return child;
  to_file(out_name.c_str(), STDOUT_FILENO);
  to_file(err_name.c_str(), STDERR_FILENO);
  const rlimit limit{most_bytes, most_bytes};
  if (most_bytes != RLIM_INFINITY && setrlimit(RLIMIT_DATA, &limit) != 0) _exit(96);
  if (!folder.empty() && chdir(folder.c_str()) != 0) _exit(98);
  execv(program.c_str(), argv.data());
  _exit(97);
}

RunResult finish(pid_t child, const fs::path& out, const fs::path& err) {
  int status = 0;
  rusage usage{};
  if (child < 0 || wait4(child, &status, 0, &usage) != child) throw std::runtime_error("cannot run " LIMN_PROGRAM);
  RunResult result;
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  result.peak_bytes = 1024.0 * static_cast<double>(usage.ru_maxrss);
  result.out = read_bytes(out);
  result.err = read_bytes(err);
  return result;
}

}  // namespace

int RunResult::err_lines() const { return static_cast<int>(std::count(err.begin(), err.end(), '\n')); }

RunResult run_limn(const std::vector<std::string>& arguments, const fs::path& where) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out", err = folder.path() / "err";
  return finish(start(arguments, where, out, err), out, err);
}

RunResult run_limn_within(std::uint64_t most_bytes, const std::vector<std::string>& arguments, const fs::path& where) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out", err = folder.path() / "err";
  return finish(start(arguments, where, out, err, most_bytes), out, err);
}

namespace {

RunResult stop_limn(const std::vector<std::string>& arguments, double seconds, int signal_number, const fs::path& where) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out", err = folder.path() / "err";
  const pid_t child = start(arguments, where, out, err);
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
  kill(child, signal_number);
  return finish(child, out, err);
}

}  // namespace

RunResult interrupt_limn(const std::vector<std::string>& arguments, double seconds, const fs::path& where) {
  return stop_limn(arguments, seconds, SIGINT, where);
}

RunResult kill_limn(const std::vector<std::string>& arguments, double seconds, const fs::path& where) {
  return stop_limn(arguments, seconds, SIGKILL, where);
}

std::string read_bytes(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

}  // namespace limn
