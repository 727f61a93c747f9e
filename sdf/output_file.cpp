#include "sdf/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <cstring>
#include <fstream>
#include <string>
#include <system_error>

#include "sdf/error.h"
#include "sdf/stale_files.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

// The one place of the house with state of its own: a signal handler has no other way to the files. It may neither allocate nor
// lock, so they stand in fixed slots, constant-initialised; a slot's path is complete before its state says `open`.
enum class SlotState : int { free, claimed, open };
struct Slot {
  std::atomic<SlotState> state{SlotState::free};
  char path[PATH_MAX]{};
};
static_assert(std::atomic<SlotState>::is_always_lock_free);
constinit std::array<Slot, 16> slots{};

/// Holds one temporary file: unlinked on destruction unless it was renamed away.
class TemporaryFile {
 public:
  TemporaryFile(const fs::path& path, unsigned mode) : path_(path) {
    for (Slot& slot : slots) {
      if (path.native().size() >= PATH_MAX) break;
      SlotState expected = SlotState::free;
      if (!slot.state.compare_exchange_strong(expected, SlotState::claimed)) continue;
      std::strcpy(slot.path, path.c_str());
      slot.state = SlotState::open;
      slot_ = &slot;
      break;
    }
    handle_ = make_locked_file(path, mode);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    if (handle_ >= 0 && !renamed_) ::unlink(path_.c_str());
    if (slot_) slot_->state = SlotState::free;
    if (handle_ >= 0) ::close(handle_);
  }
  bool made() const { return handle_ >= 0; }
  void renamed() { renamed_ = true; }

 private:
  fs::path path_;
  Slot* slot_ = nullptr;
  int handle_ = -1;  ///< Open, and with it locked, until the file is in its place: sdf/stale_files.h.
  bool renamed_ = false;
};

[[noreturn]] void refuse(const fs::path& target, const std::string& problem, const std::string& expected) {
  throw InputError({.file = target.string(), .field = {}, .value = {}, .problem = problem, .expected = expected});
}

/// Faults of the path are the caller's, those of the device the machine's.
[[noreturn]] void fail(const fs::path& target, const std::string& what, int error) {
  const std::string reason = what + ": " + std::generic_category().message(error);
  if (error == ENOSPC || error == EIO || error == EDQUOT || error == EMFILE || error == ENFILE)
    throw MachineError(target.string() + ": " + reason);
  refuse(target, reason, "a place where files can be written");
}

/// The file that is to be replaced: symbolic links are followed, so that writing through a link keeps the link.
fs::path resolved(const fs::path& target) {
  if (target.empty() || !target.has_filename()) refuse(target, "not the name of a file", "a file name");
  std::error_code error;
  const fs::file_status status = fs::status(target, error);
  if (fs::is_directory(status)) refuse(target, "is a directory", "the name of a file to write");
  if (fs::exists(status) && !fs::is_regular_file(status)) refuse(target, "is not a regular file", "the name of a file to write");
  if (!fs::exists(status)) return target;
  const fs::path real = fs::canonical(target, error);
  return error ? target : real;
}

}  // namespace

void write_whole(const fs::path& target, const std::function<void(const fs::path&)>& write) {
  const fs::path real = resolved(target);
  std::error_code error;
  if (real.has_parent_path()) fs::create_directories(real.parent_path(), error);
  if (error) fail(target, "cannot make its folder", error.value());

  // Asked for before anything is written, because a rename would replace a file that may not be written to.
  struct stat old {};
  const bool replaces = ::stat(real.c_str(), &old) == 0;
  if (replaces && ::access(real.c_str(), W_OK) != 0) fail(target, "cannot be written", errno);

  remove_stale_files(real.parent_path());
  const fs::path path = temporary_beside(real);
  TemporaryFile temporary(path, replaces ? (old.st_mode & 0777) : 0666);
  if (!temporary.made()) fail(target, "cannot be written", errno);

  write(path);
  if (!fs::is_regular_file(path, error)) throw MachineError(target.string() + ": its temporary file vanished while it was written");
  if (replaces) ::chmod(path.c_str(), old.st_mode & 0777);
  if (::rename(path.c_str(), real.c_str()) != 0) fail(target, "cannot be replaced", errno);
  temporary.renamed();
}

void write_whole(const fs::path& target, std::string_view content) {
  write_whole(target, [&](const fs::path& path) {
    std::ofstream stream(path, std::ios::binary | std::ios::trunc);
    stream.write(content.data(), static_cast<std::streamsize>(content.size()));
    stream.close();
    if (!stream) throw MachineError(target.string() + ": writing failed (is the disk full?)");
  });
}

void remove_temporary_files() noexcept {
  for (Slot& slot : slots)
    if (slot.state == SlotState::open) ::unlink(slot.path);
}

}  // namespace limn
