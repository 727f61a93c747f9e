#pragma once
// Internal to sdf/output_file: temporary files, and those that programs left which were killed.

#include <filesystem>

namespace limn {

/// A name beside `target` that no other process takes: ".limn-<host>-<process>-<number><extension of target>".
std::filesystem::path temporary_beside(const std::filesystem::path& target);

/// Makes `path`, which must not be there yet, and locks it for as long as the handle is open: the lock says that somebody is at work on it,
/// and goes with the process, however that ends. -1 with errno where it cannot be made.
int make_locked_file(const std::filesystem::path& path, unsigned mode);

/// Removes temporary files in `folder` (empty: the working folder) that nobody holds a lock on. Looks once a process at each folder. Those
/// that another host made stay for a day after their last change, because not every network filesystem shows the locks of other hosts.
void remove_stale_files(const std::filesystem::path& folder);

}  // namespace limn
