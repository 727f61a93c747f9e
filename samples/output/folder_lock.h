#pragma once
// One process at a time in a folder.

#include <filesystem>

namespace limn {

/// Makes a folder and keeps other processes out of it as long as it lives. Throws InputError where one is in it.
class FolderLock {
 public:
  /// Throws InputError where another process holds the folder, or where it cannot be made.
  explicit FolderLock(const std::filesystem::path& folder);
  /// Lets others in.
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int handle_ = -1;
};

}  // namespace limn
