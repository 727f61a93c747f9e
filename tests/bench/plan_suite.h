#pragma once
// The plan over all built-in scenes: does what it chooses keep to the tolerance, does the next coarser model not, and what does it save?

#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace limn::bench {

struct PlanBenchSettings {
  std::vector<std::string> scenes{};  ///< Empty: all.
  int views = 4;
  std::optional<int> only_view{};  ///< Of these, from 0.
  bool local = false;              ///< Local meshes are tried, too.
  int width_px = 640, height_px = 360;
  std::FILE* table = stdout;
};

/// One row a plan and one a scene; the table goes to `settings.table` as Markdown.
nlohmann::json bench_plan(const PlanBenchSettings& settings);

}  // namespace limn::bench
