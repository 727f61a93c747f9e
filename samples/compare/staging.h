#pragma once

#include <filesystem>
#include <vector>

#include "samples/output/held_folder.h"

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
  HeldFolder folder_;
  std::filesystem::path work_;
};

}  // namespace limn
