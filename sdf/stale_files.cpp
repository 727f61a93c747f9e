#include "sdf/stale_files.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdint>
#include <ctime>
#include <mutex>
#include <set>
#include <string>

namespace limn {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPrefix = ".limn-";
constexpr std::time_t kForeignPatienceSeconds = 24 * 60 * 60;

/// FNV-1a of the host's name: short, and fit for a file name whatever the host is called.
std::string host_tag() {
  char name[256] = {};
  ::gethostname(name, sizeof name - 1);
  std::uint32_t hash = 2166136261u;
  for (const char* c = name; *c; ++c) hash = (hash ^ static_cast<unsigned char>(*c)) * 16777619u;
  constexpr const char* kDigits = "0123456789abcdef";
  std::string tag;
  for (int shift = 28; shift >= 0; shift -= 4) tag += kDigits[(hash >> shift) & 15u];
  return tag;
}

bool first_look_at(const fs::path& folder) {
  static std::mutex mutex;
  static std::set<fs::path> seen;
  std::error_code error;
  const fs::path real = fs::canonical(folder, error);
  const std::scoped_lock lock(mutex);
  return !error && seen.insert(real).second;
}

/// Opened without following links, and only what is a plain file: nothing but our own leavings is ever removed.
void remove_if_stale(const fs::path& path, bool foreign) {
  const int handle = ::open(path.c_str(), O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (handle < 0) return;
  struct stat status {};
  const bool plain = ::fstat(handle, &status) == 0 && S_ISREG(status.st_mode);
  const bool old_enough = !foreign || std::time(nullptr) - status.st_mtime > kForeignPatienceSeconds;
  if (plain && old_enough && ::flock(handle, LOCK_EX | LOCK_NB) == 0) ::unlink(path.c_str());
  ::close(handle);
}

}  // namespace

fs::path temporary_beside(const fs::path& target) {
  static std::atomic<unsigned> counter{0};
  const std::string name = kPrefix + host_tag() + "-" + std::to_string(::getpid()) + "-" + std::to_string(counter.fetch_add(1));
  return target.parent_path() / (name + target.extension().string());
}

int make_locked_file(const fs::path& path, unsigned mode) {
  // A process that looks for stale files may come between the making and the locking, take the lock and the file with it.
  for (int attempt = 0; attempt < 100; ++attempt) {
    const int handle = ::open(path.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, mode);
    if (handle < 0) return -1;
    const bool locked = ::flock(handle, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK;
    struct stat status {};
    if (locked && ::fstat(handle, &status) == 0 && status.st_nlink > 0) return handle;
    ::unlink(path.c_str());
    ::close(handle);
  }
  errno = EEXIST;
  return -1;
}

void remove_stale_files(const fs::path& folder) {
  const fs::path real = folder.empty() ? fs::path(".") : folder;
  if (!first_look_at(real)) return;
  const std::string own = kPrefix + host_tag() + "-";
  std::error_code error;
  for (fs::directory_iterator at(real, error), end; !error && at != end; at.increment(error)) {
    const std::string name = at->path().filename().string();
    if (name.starts_with(kPrefix)) remove_if_stale(at->path(), !name.starts_with(own));
  }
}

}  // namespace limn
