#pragma once
// files.tsv: files that nobody here made, what limn does with each, and why.

#include <filesystem>
#include <string>
#include <vector>

namespace limn::foreign {

/// One line: group, path below the group's folder, outcome, reason, separated by tabs.
struct ListedFile {
  std::string group{}, path{};
  bool drawn = false;    ///< `drawn`, or `refused`.
  bool compared = true;  ///< `drawn!`: drawn, and the second reader does not read the same; `reason` says why.
  /// Refused: words that the message must hold, and after " | ", where the second reader takes the file, why limn is right.
  std::string reason{};
};

/// Throws std::runtime_error naming the line where the list cannot be read.
std::vector<ListedFile> listed_files(const std::filesystem::path& list);

/// Where a group's files lie; empty where that package is not installed.
std::filesystem::path folder_of(const std::string& group);

}  // namespace limn::foreign
