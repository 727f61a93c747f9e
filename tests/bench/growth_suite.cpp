#include "tests/bench/growth_suite.h"

#include <fmt/format.h>
#include <unistd.h>

#include <map>

#include "sdf/error.h"

namespace limn::bench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

fs::path own_program() { return fs::read_symlink("/proc/self/exe"); }

/// A folder that goes when the suite is done.
struct Folder {
  explicit Folder(const fs::path& wanted)
      : path(wanted.empty() ? fs::temp_directory_path() / fmt::format("limn-growth-{}", ::getpid()) : wanted) {
    fs::create_directories(path);
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  fs::path path;
};

struct Suite {
  const GrowthBenchSettings& settings;
  std::string limn;
  fs::path folder;
  json rows = json::array();
  std::map<std::string, ProcessCost> before{};  ///< Of each call, at the next smaller size.

  std::string size() const { return fmt::format("{}x{}", settings.width_px, std::max(1, settings.width_px * 9 / 16)); }

  /// One call and its row. `units`: what the input has, faces or voxels.
  void add(const std::string& input, const std::string& what, const std::string& call, const ProcessCost& cost, double units,
           double input_bytes) {
    const std::string key = input + " " + what;
    const auto smaller = before.find(key);
    const auto growth = [&](double now, double then) { return smaller == before.end() ? json() : json(now / then); };
    rows.push_back({{"kind", "growth"},
                    {"input", input},
                    {"what", what},
                    {"call", call},
                    {"units", units},
                    {"input_bytes", input_bytes},
                    {"cpu_s", cost.cpu_s},
                    {"peak_bytes", cost.peak_bytes},
                    {"cpu_us_per_unit", 1e6 * cost.cpu_s / units},
                    {"peak_bytes_per_unit", cost.peak_bytes / units},
                    {"cpu_growth", smaller == before.end() ? json() : growth(cost.cpu_s, smaller->second.cpu_s)},
                    {"peak_growth", smaller == before.end() ? json() : growth(cost.peak_bytes, smaller->second.peak_bytes)}});
    const auto shown = [&](const char* field) {
      const json& value = rows.back()[field];
      return value.is_null() ? std::string() : fmt::format("{:.2f}", value.get<double>());
    };
    fmt::print(settings.table, "| {} | {} | {:.0f} | {:.1f} | {:.2f} | {:.0f} | {:.2f} | {:.0f} | {} | {} |\n", input, what, units,
               input_bytes / 1e6, cost.cpu_s, cost.peak_bytes / 1e6, 1e6 * cost.cpu_s / units, cost.peak_bytes / units, shown("cpu_growth"),
               shown("peak_growth"));
    std::fflush(settings.table);
    before[key] = cost;
  }

  ProcessCost render(const std::string& input, const std::vector<std::string>& more) const {
    std::vector<std::string> call{limn, "render",        input,     "--size", size(), "--samples",
                                  "1",  "--no-progress", "--quiet", "--json", "-o",   (folder / "picture.png").string()};
    call.insert(call.end(), more.begin(), more.end());
    return run_measured(call);
  }

  void run_files(int level) {
    const std::string stem = (folder / fmt::format("{}{}", settings.scene, level)).string();
    const ProcessCost made = run_measured({own_program(), "--growth-part", "files", settings.scene, std::to_string(level), stem});
    const double faces = std::stod(made.output);
    for (const std::string ending : {"obj", "ply", "glb"}) {
      const std::string file = stem + "." + ending;
      const auto bytes = static_cast<double>(fs::file_size(file));
      add(ending, "assimp reads it", "", run_measured({own_program(), "--growth-part", "assimp", file}), faces, bytes);
      add(ending, "info", "limn info FILE", run_measured({limn, "info", file, "--json"}), faces, bytes);
      add(ending, "render, mesh", "limn render FILE", render(file, {}), faces, bytes);
      for (const int voxels : settings.voxels.empty() ? std::vector<int>{256, 512} : settings.voxels)
        add(ending, fmt::format("render, mesh_level_set, {} voxels", voxels),
            fmt::format("limn render FILE --surface mesh_level_set --voxels {}", voxels),
            render(file, {"--surface", "mesh_level_set", "--voxels", std::to_string(voxels)}), faces, bytes);
      fs::remove(file);
    }
  }

  void run_fields() {
    for (const int voxels : settings.field_voxels.empty() ? std::vector<int>{256, 512, 1024, 2048} : settings.field_voxels) {
      const ProcessCost cost = render(settings.field, {"--surface", "level_set", "--voxels", std::to_string(voxels)});
      const json answer = json::parse(cost.output, nullptr, false);
      const double active = answer.is_discarded() ? 0.0 : answer["surface"].value("voxels", 0.0);
      add("field", "render, level_set", fmt::format("limn render {} --surface level_set --voxels N", settings.field), cost, active, 0.0);
    }
  }
};

}  // namespace

json bench_growth(const GrowthBenchSettings& settings) {
  const Folder folder(settings.folder);
  const fs::path program = settings.program.empty() ? own_program().parent_path() / "limn" : settings.program;
  if (!fs::exists(program))
    throw InputError({.field = "--program", .value = program.string(), .problem = "no such program", .expected = "the program limn"});
  fmt::print(settings.table,
             "\n{} refined, in {} pictures: processor time and largest resident memory of each call; units are faces, of level sets active "
             "voxels; growth: times the row's next smaller size\n\n",
             settings.scene, settings.width_px);
  fmt::print(settings.table,
             "| input | call | units | file, MB | CPU, s | peak, MB | CPU, us a unit | peak, bytes a unit | CPU growth | peak growth |\n");
  fmt::print(settings.table, "|---|---|---:|---:|---:|---:|---:|---:|---:|---:|\n");
  Suite suite{settings, program.string(), folder.path};
  for (const int level : settings.levels.empty() ? std::vector<int>{4, 5, 6, 7} : settings.levels) suite.run_files(level);
  suite.run_fields();
  return std::move(suite.rows);
}

}  // namespace limn::bench
