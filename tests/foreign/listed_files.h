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

/// Where a group's files lie: `assimp` and `cgal` in their packages, `data` in tests/data, `models` in the folder that the environment's
/// LIMN_MODELS names. Empty where there is none.
std::filesystem::path folder_of(const std::string& group);

}  // namespace limn::foreign
