#pragma once
// Lines alone: how long a view graph takes from each of 26 sides, and whether its certificate finds conflicts.

#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace limn::bench {

struct LinesBenchSettings {
  std::vector<std::string> scenes{};  ///< Names of built-in ones; empty: all of them, unless there are `meshes`.
  std::vector<std::string> meshes{};  ///< Files, as subdivision cages.
  std::optional<int> only_view{};     ///< Of the 26, from 0.
  std::optional<int> voxels{};        ///< Lines of level sets of so many voxels instead.
  bool oracle = false;                ///< Rays of a model of its own are asked about points of every line.
  int width_px = 640, height_px = 360;
  int threads = 2;
  std::FILE* table = stdout;
};

/// One row an input; the table goes to `settings.table` as Markdown, and each conflict on a line of its own.
nlohmann::json bench_lines(const LinesBenchSettings& settings);

}  // namespace limn::bench
