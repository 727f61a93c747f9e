#pragma once
// How whole calls of limn grow with what they are given: processor time and peak memory of the program as a person runs it, its helpers
// included, on files of one surface refined further and further, beside assimp's own reading of the same files.

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/bench/process.h"

namespace limn::bench {

struct GrowthBenchSettings {
  std::string scene = "rook";       ///< A built-in scene with a cage.
  std::string field = "ellipsoid";  ///< A built-in scene with a field.
  std::vector<int> levels{};        ///< Empty: 4 to 7, which makes 70 thousand to 4.4 million quads of the rook.
  std::vector<int> voxels{};        ///< Of meshes made level sets; empty: 256, 512.
  std::vector<int> field_voxels{};  ///< Empty: 256, 512, 1024, 2048.
  int width_px = 1280;
  std::filesystem::path program{};  ///< Empty: limn beside this program.
  std::filesystem::path folder{};   ///< For the files, which are removed afterwards; empty: a temporary one.
  std::FILE* table = stdout;
};

/// Rows of kind "growth", one a call; the table goes to `settings.table` as Markdown.
nlohmann::json bench_growth(const GrowthBenchSettings& settings);

/// What the suite runs in programs of their own, so that their memory is not counted for the calls: "files SCENE LEVEL STEM" writes
/// STEM.obj, .ply and .glb and prints the number of faces; "assimp FILE" reads a file and drops it. False: it is neither.
bool run_growth_part(int argc, char** argv);

}  // namespace limn::bench
