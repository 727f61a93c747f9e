#pragma once
// Mesh to level set beside OpenVDB's meshToVolume: time, and the largest distance error of both.

#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace limn::bench {

struct ConvertBenchSettings {
  std::vector<std::string> objects{};  ///< As bench_object; empty: sphere, torus, rook, teacup, pipe_junction.
  std::vector<std::string> meshes{};   ///< Files, beside those.
  std::vector<int> voxels{};           ///< Along the longest side; empty: 128, 256, 512.
  int runs = 7;
  std::FILE* table = stdout;
};

/// Rows of kind "convert".
nlohmann::json bench_convert(const ConvertBenchSettings& settings);

}  // namespace limn::bench
