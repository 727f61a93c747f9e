#pragma once
// The case files as they stand in the program, put there when it is built.

#include <span>
#include <string_view>

namespace limn {

struct CorpusFile {
  std::string_view name{};  ///< "cube_faces.toml".
  std::string_view text{};
};
std::span<const CorpusFile> corpus_files();

}  // namespace limn
