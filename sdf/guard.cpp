#include "sdf/guard.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <thread>

#include "sdf/guard_helper.h"
#include "sdf/size_error.h"

extern char** environ;

namespace limn {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

/// Room for the program, its libraries and its threads, in the backstop limit that is set from outside.
constexpr std::int64_t kStartAllowance = std::int64_t{2} << 30;

std::string reason_of(int error) { return std::generic_category().message(error); }

std::string megabytes(std::int64_t bytes) { return std::to_string(std::max<std::int64_t>(bytes >> 20, 1)) + " MB"; }

[[noreturn]] void refuse(const fs::path& file, const std::string& problem, const std::string& expected) {
  throw InputError({.file = file.string(), .field = {}, .value = {}, .problem = problem, .expected = expected});
}

/// A file without a name, in memory that the helper and we see.
struct AnswerFile {
  int handle = -1;
  AnswerFile() : handle(::memfd_create("limn-answer", MFD_CLOEXEC | MFD_ALLOW_SEALING)) {
    if (handle < 0) throw MachineError("cannot make a file in memory: " + reason_of(errno));
  }
  AnswerFile(const AnswerFile&) = delete;
  AnswerFile& operator=(const AnswerFile&) = delete;
  ~AnswerFile() { ::close(handle); }
  std::int64_t size() const {
    struct stat status {};
    return ::fstat(handle, &status) == 0 ? static_cast<std::int64_t>(status.st_size) : 0;
  }
  /// From now on nobody can write to it. False where some process still may, or where the system has no such thing.
  bool seal() const { return ::fcntl(handle, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_WRITE | F_SEAL_SEAL) == 0; }
};

/// The helper's environment: ours, and the limits that it sets on itself first thing.
std::vector<std::string> helper_environment(const GuardLimits& limits) {
  std::vector<std::string> all;
  for (char** entry = environ; entry && *entry; ++entry)
    if (std::strncmp(*entry, kMemoryVariable, std::strlen(kMemoryVariable)) != 0) all.emplace_back(*entry);
  all.push_back(std::string(kMemoryVariable) + "=" + std::to_string(limits.memory_bytes));
  return all;
}

std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> result;
  result.reserve(texts.size() + 1);
  for (std::string& text : texts) result.push_back(text.data());
  result.push_back(nullptr);
  return result;
}

/// A program and not a fork of ourselves: a fork of a process with threads may not allocate, and would inherit all our memory.
pid_t start(const fs::path& program, std::span<const std::string> arguments, const GuardLimits& limits, const AnswerFile& answer) {
  std::vector<std::string> argv_text{program.string()};
  argv_text.insert(argv_text.end(), arguments.begin(), arguments.end());
  std::vector<std::string> environment_text = helper_environment(limits);

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, answer.handle, kAnswerHandle);
  posix_spawn_file_actions_addclosefrom_np(&actions, kAnswerHandle + 1);

  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none, defaults;
  sigemptyset(&none);
  sigemptyset(&defaults);
  for (const int signal : {SIGINT, SIGTERM, SIGPIPE, SIGHUP, SIGXCPU}) sigaddset(&defaults, signal);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &defaults);
  // A group of its own, so that whatever the helper starts can be ended with it.
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);

  pid_t child = -1;
  const int error =
      ::posix_spawn(&child, program.c_str(), &actions, &attributes, pointers(argv_text).data(), pointers(environment_text).data());
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) throw MachineError("cannot start " + program.string() + ": " + reason_of(error));
  return child;
}

/// The limits that hold even for a helper that does not set its own.
void limit_from_outside(pid_t child, const GuardLimits& limits) {
  const auto seconds = static_cast<rlim_t>(limits.time.count() / 1000 + 1) * std::max(1u, std::thread::hardware_concurrency());
  const rlimit cpu{seconds, seconds + 1}, no_core{0, 0};
  ::prlimit(child, RLIMIT_CPU, &cpu, nullptr);
  ::prlimit(child, RLIMIT_CORE, &no_core, nullptr);
  // Its answer is the only file that it writes. What it started before has no such limit: wait_for() looks at the answer, too.
  const auto longest = static_cast<rlim_t>(limits.answer_bytes + 1);
  const rlimit answer{longest, longest};
  ::prlimit(child, RLIMIT_FSIZE, &answer, nullptr);
  if (!kAddressSpaceCanBeLimited) return;
  const auto bytes = static_cast<rlim_t>(limits.memory_bytes + kStartAllowance);
  const rlimit memory{bytes, bytes};
  ::prlimit(child, RLIMIT_AS, &memory, nullptr);
}

/// No helper gets more than what our own process may allocate, which it inherits anyway: so its limit is the one that messages name. Its
/// answer, which is memory of nobody, is no larger either.
GuardLimits within_our_own(GuardLimits limits) {
  rlimit data{};
  if (::getrlimit(RLIMIT_DATA, &data) != 0 || data.rlim_cur == RLIM_INFINITY) return limits;
  const auto own = static_cast<std::int64_t>(data.rlim_cur);
  limits.memory_bytes = std::min(limits.memory_bytes, own);
  limits.answer_bytes = std::min(limits.answer_bytes, own);
  return limits;
}

enum class Ending { ended, out_of_time, answer_too_long };

bool has_ended(pid_t child) {
  siginfo_t info{};
  return ::waitid(P_PID, static_cast<id_t>(child), &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid == child;
}

/// Readable once the process has ended; -1 where the system has no such thing.
class EndOfProcess {
 public:
  explicit EndOfProcess(pid_t child) : handle_(static_cast<int>(::syscall(SYS_pidfd_open, child, 0))) {}
  EndOfProcess(const EndOfProcess&) = delete;
  EndOfProcess& operator=(const EndOfProcess&) = delete;
  ~EndOfProcess() {
    if (handle_ >= 0) ::close(handle_);
  }
  /// At most so long; a millisecond where its end makes no event.
  void wait(std::int64_t most_ms) const {
    pollfd end{handle_, POLLIN, 0};
    ::poll(&end, 1, static_cast<int>(handle_ >= 0 ? most_ms : std::min<std::int64_t>(most_ms, 1)));
  }

 private:
  int handle_;
};

/// The answer takes memory while it grows: it is never looked away from for long.
constexpr std::int64_t kLook_ms = 10;

Ending wait_for(pid_t child, const AnswerFile& answer, const GuardLimits& limits) {
  const Clock::time_point deadline = Clock::now() + limits.time;
  const EndOfProcess end(child);
  while (!has_ended(child)) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    if (left <= 0) return Ending::out_of_time;
    if (answer.size() > limits.answer_bytes) return Ending::answer_too_long;
    end.wait(std::min<std::int64_t>(left, kLook_ms));
  }
  return Ending::ended;
}

/// Ends the helper and all it started, and leaves no zombie. The group is signalled before the leader is reaped: until then its number
/// cannot belong to anyone else.
int reap(pid_t child) {
  ::kill(-child, SIGKILL);
  ::kill(child, SIGKILL);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

std::string one_line_of(std::span<const std::byte> answer) {
  std::string text(reinterpret_cast<const char*>(answer.data()), std::min<size_t>(answer.size(), 2000));
  return text.empty() ? "cannot be read" : text;
}

/// The file takes more than it may: where a damaged one may take more than that, the limit is to blame as much as the file.
[[noreturn]] void refuse_size(const fs::path& file, const std::string& problem, bool allowed_less) {
  if (allowed_less) throw SizeError({.file = file.string(), .field = {}, .value = {}, .problem = problem, .expected = {}});
  refuse(file, problem + "; it is damaged or far too large", "a smaller or an undamaged file");
}

void judge(Ending ending, int status, std::span<const std::byte> answer, const fs::path& file, const GuardLimits& limits,
           const GuardLimits& asked) {
  if (ending == Ending::out_of_time)
    refuse(file, "reading it took longer than " + std::to_string(limits.time.count() / 1000) + " s; it is damaged or far too large",
           "an undamaged file");
  const bool cut = ending == Ending::answer_too_long || (WIFSIGNALED(status) && WTERMSIG(status) == SIGXFSZ);
  if (cut || static_cast<std::int64_t>(answer.size()) > limits.answer_bytes)
    refuse_size(file, "what is in it takes more than " + megabytes(limits.answer_bytes), limits.answer_bytes < asked.answer_bytes);
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU)
    refuse(file, "reading it used up its processor time; it is damaged or far too large", "an undamaged file");
  if (WIFSIGNALED(status))
    refuse(file, std::string("the reader crashed on it (") + ::strsignal(WTERMSIG(status)) + "); it is damaged", "an undamaged file");
  const int code = WEXITSTATUS(status);
  if (code == kExitAnswer) return;
  if (code == kExitRefusal)
    throw InputError({.file = file.string(), .field = {}, .value = {}, .problem = one_line_of(answer), .expected = {}});
  if (code == kExitMemory)
    refuse_size(file, "reading it needs more than " + megabytes(limits.memory_bytes) + " of memory",
                limits.memory_bytes < asked.memory_bytes);
  refuse(file, "the reader gave up on it (exit code " + std::to_string(code) + "); it is damaged", "an undamaged file");
}

}  // namespace

fs::path find_helper(const std::string& name) {
  const bool is_module = name.ends_with(".so");
  std::vector<fs::path> folders;
  if (const char* given = std::getenv("LIMN_HELPERS"); given && *given) folders.emplace_back(given);
  std::error_code error;
  const fs::path self = fs::read_symlink("/proc/self/exe", error);
  if (!error) folders.push_back(self.parent_path());
#ifdef LIMN_HELPERS_INSTALLED
  folders.emplace_back(LIMN_HELPERS_INSTALLED);
#endif
#ifdef LIMN_HELPERS_BUILD
  folders.emplace_back(LIMN_HELPERS_BUILD);
#endif
  std::string looked_in;
  for (const fs::path& folder : folders) {
    fs::path candidate = folder / name;
    if (::access(candidate.c_str(), is_module ? R_OK : X_OK) == 0) return candidate;
    looked_in += (looked_in.empty() ? "" : ", ") + folder.string();
  }
  throw MachineError(name + " is not installed (looked in " + looked_in + "); set LIMN_HELPERS to its folder");
}

MappedBytes run_guarded(const std::string& name, std::span<const std::string> arguments, const fs::path& file, const GuardLimits& asked) {
  const GuardLimits limits = within_our_own(asked);
  const AnswerFile answer_file;
  const pid_t child = start(find_helper(name), arguments, limits, answer_file);
  limit_from_outside(child, limits);
  Ending ending;
  try {
    ending = wait_for(child, answer_file, limits);
  } catch (...) {
    reap(child);
    throw;
  }
  const int status = reap(child);
  MappedBytes answer = answer_file.seal() ? MappedBytes(answer_file.handle) : MappedBytes::copied(answer_file.handle);
  judge(ending, status, answer, file, limits, asked);
  return answer;
}

void check_readable(const fs::path& file, const std::string& what) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  const bool absent = !error || error == std::errc::no_such_file_or_directory || error == std::errc::not_a_directory;
  if (!fs::exists(status)) refuse(file, absent ? "no such file" : error.message(), what);
  if (fs::is_directory(status)) refuse(file, "is a directory", what);
  if (!fs::is_regular_file(status)) refuse(file, "is not a regular file", what);
  if (::access(file.c_str(), R_OK) != 0) refuse(file, "may not be read (" + reason_of(errno) + ")", what);
  if (fs::file_size(file, error) == 0) refuse(file, "is empty", what);
}

}  // namespace limn
