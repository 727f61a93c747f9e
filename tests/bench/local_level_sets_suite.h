#pragma once
// Local level sets beside uniform ones: how memory, building and pictures grow with the voxels at the border.

#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace limn::bench {

struct LocalLevelSetsBenchSettings {
  std::vector<std::string> scenes{};  ///< Empty: ellipsoid, tilted_torus, machined_part.
  std::vector<int> voxels{};          ///< Empty: 512, 1024, 2048, 4096.
  int runs = 7;
  int width_px = 600, height_px = 450;
  bool silhouette = false;  ///< Border: the silhouette alone.
  std::FILE* table = stdout;
};

/// Rows of kind "local level sets", one a model; the table goes to `settings.table` as Markdown. Times are processor times of all threads,
/// the least of the runs, which go by turns.
nlohmann::json bench_local_level_sets(const LocalLevelSetsBenchSettings& settings);

}  // namespace limn::bench
