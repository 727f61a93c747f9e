#pragma once
// Whole calls of limn, as processes, beside programs that do the same: what a person waits for, and the stages it is made of.

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

namespace limn::bench {

struct CallsBenchSettings {
  int runs = 7;                     ///< Rounds of which the median counts, after one to warm up.
  std::filesystem::path program{};  ///< Empty: limn beside this program.
  std::FILE* table = stdout;
};

/// Rows of kind "calls", one a call; the tables go to `settings.table` as Markdown. Peers that are not installed are left out with a word:
/// oiiotool (openimageio-tools), vdb_render (libopenvdb-tools), assimp (assimp-utils), blender. With an emptied file cache only where the
/// system lets this program empty it.
nlohmann::json bench_calls(const CallsBenchSettings& settings);

}  // namespace limn::bench
