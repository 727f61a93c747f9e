#pragma once
// Local meshes over the built-in scenes: do they keep to the tolerance, and how many triangles fewer have they than meshes as fine
// everywhere?

#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace limn::bench {

struct LocalBenchSettings {
  std::vector<std::string> scenes{};  ///< Empty: all.
  int views = 4;
  std::optional<int> only_view{};  ///< Of these, from 0.
  std::vector<double> tolerances_px{1.0, 0.5, 0.25, 0.1};
  int width_px = 300, height_px = 300;
  std::FILE* table = stdout;
};

/// One row for each scene, view and tolerance; the table goes to `settings.table` as Markdown.
nlohmann::json bench_local(const LocalBenchSettings& settings);

}  // namespace limn::bench
