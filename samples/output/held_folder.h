#pragma once

#include "samples/output/folder_lock.h"

namespace limn {

/// A FolderLock that takes the folder away again where it was not there before and nothing came into it.
class HeldFolder {
 public:
  explicit HeldFolder(const std::filesystem::path& folder);
  ~HeldFolder();
  HeldFolder(const HeldFolder&) = delete;
  HeldFolder& operator=(const HeldFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  bool made_;
  FolderLock lock_;
};

}  // namespace limn
