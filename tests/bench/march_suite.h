#pragma once
// Level sets, closed forms and meshes beside their peers, on the same rays; and what the marchers must show, with the figures of the run.

#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace limn::bench {

struct MarchBenchSettings {
  std::vector<std::string> objects{};  ///< sphere, torus, or a built-in scene's first cage; empty: sphere, torus, rook.
  std::vector<std::string> meshes{};   ///< Files, over the built-in cage.
  std::vector<int> voxels{};           ///< Along the longest side; empty: 128, 256, 1024.
  int runs = 7;
  int width_px = 1920, height_px = 1080;
  std::FILE* table = stdout;
};

/// Rows of kind "march" (a contestant in a picture), "grid" (what a ray-ready grid costs) and "simd" (targets beside the widest).
nlohmann::json bench_march(const MarchBenchSettings& settings);

/// One entry a demand that the rows say something of: {"number", "what", "bound", "figure", "met"}.
nlohmann::json must_shows(const nlohmann::json& rows);
void print_must_shows(const nlohmann::json& shown, std::FILE* table);

}  // namespace limn::bench
