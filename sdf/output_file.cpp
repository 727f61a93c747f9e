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
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "sdf/error.h"
#include "sdf/output_together.h"
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
constinit std::atomic<int> replacing{0};

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

/// An output whose content is complete, in a temporary file beside its place.
struct Staged {
  fs::path target{};  ///< As it was given.
  fs::path real{};    ///< What is replaced.
  fs::path path{};    ///< The temporary file.
  std::unique_ptr<TemporaryFile> temporary{};
};

Staged stage(const OutputFile& output) {
  Staged staged{output.target, resolved(output.target), {}, {}};
  const fs::path& real = staged.real;
  std::error_code error;
  if (real.has_parent_path()) fs::create_directories(real.parent_path(), error);
  if (error) fail(output.target, "cannot make its folder", error.value());

  // Asked for before anything is written, because a rename would replace a file that may not be written to.
  struct stat old {};
  const bool replaces = ::stat(real.c_str(), &old) == 0;
  if (replaces && ::access(real.c_str(), W_OK) != 0) fail(output.target, "cannot be written", errno);

  remove_stale_files(real.parent_path());
  staged.path = temporary_beside(real);
  staged.temporary = std::make_unique<TemporaryFile>(staged.path, replaces ? (old.st_mode & 0777) : 0666);
  if (!staged.temporary->made()) fail(output.target, "cannot be written", errno);

  output.write(staged.path);
  if (!fs::is_regular_file(staged.path, error))
    throw MachineError(output.target.string() + ": its temporary file vanished while it was written");
  if (replaces) ::chmod(staged.path.c_str(), old.st_mode & 0777);
  return staged;
}

/// Puts complete files in their places, all or none.
class Replacement {
 public:
  explicit Replacement(std::vector<Staged>& staged) : staged_(staged), old_(staged.size()) { ++replacing; }
  Replacement(const Replacement&) = delete;
  Replacement& operator=(const Replacement&) = delete;
  ~Replacement() {
    for (const fs::path& old : old_) {
      if (!old.empty()) ::unlink(old.c_str());
    }
    --replacing;
  }

  void run() {
    // The old files of all but the first leave before any new one comes; the first is kept by a second name, so that its place is never
    // empty.
    for (size_t i = 1; i < staged_.size(); ++i) set_aside(i, ::rename);
    if (staged_.size() > 1) set_aside(0, ::link);
    for (; done_ < staged_.size(); ++done_) {
      const Staged& one = staged_[done_];
      if (::rename(one.path.c_str(), one.real.c_str()) != 0) undo(one.target, errno);
      one.temporary->renamed();
    }
  }

 private:
  void set_aside(size_t i, int (*move)(const char*, const char*)) {
    // A folder that has come there meanwhile would move like a file.
    struct stat there {};
    if (::lstat(staged_[i].real.c_str(), &there) == 0 && S_ISDIR(there.st_mode)) undo(staged_[i].target, EISDIR);
    fs::path old = temporary_beside(staged_[i].real);
    if (move(staged_[i].real.c_str(), old.c_str()) == 0)
      old_[i] = std::move(old);
    else if (errno != ENOENT && move == ::rename)
      undo(staged_[i].target, errno);
  }
  [[noreturn]] void undo(const fs::path& target, int error) {
    for (size_t i = 0; i < staged_.size(); ++i) {
      if (!old_[i].empty()) {
        ::rename(old_[i].c_str(), staged_[i].real.c_str());
        ::unlink(old_[i].c_str());  // of two names of one file a rename removes none
      } else if (i < done_) {
        ::unlink(staged_[i].real.c_str());
      }
      old_[i].clear();
    }
    fail(target, "cannot be replaced", error);
  }

  std::vector<Staged>& staged_;
  std::vector<fs::path> old_;  ///< Where the old files wait; empty where there is none.
  size_t done_ = 0;
};

}  // namespace

void write_bytes(const fs::path& path, const fs::path& target, std::string_view content) {
  std::ofstream stream(path, std::ios::binary | std::ios::trunc);
  stream.write(content.data(), static_cast<std::streamsize>(content.size()));
  stream.close();
  if (!stream) throw MachineError(target.string() + ": writing failed (is the disk full?)");
}

void write_together(std::span<const OutputFile> files) {
  std::vector<Staged> staged;
  staged.reserve(files.size());
  for (const OutputFile& file : files) staged.push_back(stage(file));
  Replacement replacement(staged);
  replacement.run();
}

void write_whole(const fs::path& target, const std::function<void(const fs::path&)>& write) {
  const OutputFile file{target, write};
  write_together({&file, 1});
}

void write_whole(const fs::path& target, std::string_view content) {
  write_whole(target, [&](const fs::path& path) { write_bytes(path, target, content); });
}

OutputFile bytes_output(const fs::path& target, std::string bytes) {
  return {target, [target, bytes = std::move(bytes)](const fs::path& path) { write_bytes(path, target, bytes); }};
}

bool outputs_are_being_replaced() noexcept { return replacing > 0; }

void remove_temporary_files() noexcept {
  for (Slot& slot : slots)
    if (slot.state == SlotState::open) ::unlink(slot.path);
}

}  // namespace limn
