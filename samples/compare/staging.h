#pragma once

#include <filesystem>
#include <vector>

#include "samples/study/journal.h"

namespace limn {

/// A folder whose files are replaced together: it is locked, they are written into a folder of their own within it, "compare.unfinished",
/// and take their places when all are complete. What is thrown takes that folder away; a process that is killed leaves it, as the mark of
/// what is missing, for the next one to remove.
class StagedFolder {
 public:
  explicit StagedFolder(const std::filesystem::path& folder);
  ~StagedFolder();
  StagedFolder(const StagedFolder&) = delete;
  StagedFolder& operator=(const StagedFolder&) = delete;

  const std::filesystem::path& work() const { return work_; }
  /// Brings the files of that name to their places, in that order; returns these.
  std::vector<std::filesystem::path> publish(const std::vector<std::filesystem::path>& names) const;

 private:
  std::filesystem::path folder_, work_;
  bool made_ = false;  ///< The folder was not there: it goes again where nothing comes into it.
  FolderLock lock_;
};

}  // namespace limn
