#include "tests/bench/calls_suite.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <map>

#include "sdf/error.h"
#include "tests/bench/process.h"

namespace limn::bench {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// A folder that goes when the suite is done.
struct Folder {
  Folder() : path(fs::temp_directory_path() / fmt::format("limn-calls-{}", ::getpid())) { fs::create_directories(path); }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  fs::path path;
};

struct Contestant {
  std::string name{};
  std::vector<std::string> call{};
};

/// The first of a group is what the others are compared with.
struct Group {
  std::string title{};
  std::vector<Contestant> contestants{};
};

struct Spread {
  std::vector<double> sorted_ms{};
  double median_ms() const { return sorted_ms[sorted_ms.size() / 2]; }
};

/// False where the system does not let us.
bool empty_file_cache() {
  ::sync();
  std::ofstream drop("/proc/sys/vm/drop_caches");
  drop << "1" << std::flush;
  return drop.good();
}

/// Every call once in each round, so that a slow minute of the machine is everybody's.
std::vector<Spread> time_calls(const std::vector<Contestant>& contestants, int runs, bool cold) {
  std::vector<Spread> spreads(contestants.size());
  for (int run = cold ? 0 : -1; run < runs; ++run) {
    for (size_t i = 0; i < contestants.size(); ++i) {
      if (cold) empty_file_cache();
      const double wall_ms = run_measured(contestants[i].call).wall_ms;
      if (run >= 0) spreads[i].sorted_ms.push_back(wall_ms);
    }
  }
  for (Spread& spread : spreads) std::sort(spread.sorted_ms.begin(), spread.sorted_ms.end());
  return spreads;
}

struct Suite {
  const CallsBenchSettings& settings;
  std::string limn;
  fs::path folder;
  json rows = json::array();

  std::string file(const std::string& name) const { return (folder / name).string(); }

  std::vector<std::string> render(const std::string& input, const std::vector<std::string>& more, const std::string& output) const {
    std::vector<std::string> call{limn, "render",        input,     "--size", "1920x1080", "--samples",
                                  "1",  "--no-progress", "--quiet", "-o",     file(output)};
    call.insert(call.end(), more.begin(), more.end());
    return call;
  }

  void add(const Group& group, const Contestant& who, const Spread& spread, double first_ms, bool cold) {
    const double median = spread.median_ms();
    rows.push_back({{"kind", "calls"},
                    {"group", group.title},
                    {"name", who.name},
                    {"cache", cold ? "cold" : "warm"},
                    {"median_ms", median},
                    {"least_ms", spread.sorted_ms.front()},
                    {"most_ms", spread.sorted_ms.back()},
                    {"of_first", median / first_ms}});
    fmt::print(settings.table, "| {} | {} | {} | {:.1f} | {:.1f} | {:.1f} | {:.2f} |\n", group.title, who.name, cold ? "cold" : "warm",
               median, spread.sorted_ms.front(), spread.sorted_ms.back(), median / first_ms);
    std::fflush(settings.table);
  }

  void race(const Group& group) {
    for (const bool cold : {false, true}) {
      if (cold && !empty_file_cache()) continue;
      const std::vector<Spread> spreads = time_calls(group.contestants, cold ? std::min(settings.runs, 3) : settings.runs, cold);
      for (size_t i = 0; i < spreads.size(); ++i) add(group, group.contestants[i], spreads[i], spreads[0].median_ms(), cold);
    }
  }

  /// Where the time of a call goes, by its own account; what is left is its start and its end.
  void break_down(const std::string& what, std::vector<std::string> call) {
    call.push_back("--json");
    const std::vector<std::string> stages{"load", "build", "trace", "border", "write"};
    std::map<std::string, std::vector<double>> of_stage;
    for (int run = -1; run < settings.runs; ++run) {
      const ProcessCost cost = run_measured(call);
      const json timings = json::parse(cost.output)["timings_ms"];
      double sum = 0.0;
      for (const std::string& stage : stages) {
        const double ms = timings.value(stage, 0.0);
        sum += ms;
        if (run >= 0) of_stage[stage].push_back(ms);
      }
      if (run < 0) continue;
      // Of several pictures one is written while the next is traced: nothing is left then.
      of_stage["start and end"].push_back(std::max(0.0, cost.wall_ms - sum));
      of_stage["all"].push_back(cost.wall_ms);
    }
    json row{{"kind", "calls"}, {"group", "stages"}, {"name", what}};
    fmt::print(settings.table, "| {}", what);
    for (const std::string stage : {"start and end", "load", "build", "trace", "border", "write", "all"}) {
      std::vector<double>& times = of_stage[stage];
      std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2), times.end());
      row[stage] = times[times.size() / 2];
      fmt::print(settings.table, " | {:.1f}", times[times.size() / 2]);
    }
    fmt::print(settings.table, " |\n");
    rows.push_back(row);
  }

  bool has(const std::string& program, const std::string& package) {
    if (!find_program(program).empty()) return true;
    fmt::print(settings.table, "\n{} is not installed (package {}): its calls are left out\n", program, package);
    return false;
  }

  void run() {
    const std::vector<std::string> level_set{"--surface", "level_set"};
    run_measured({limn, "export", "ellipsoid", "--surface", "level_set", "--quiet", "-o", file("e.vdb")});
    run_measured(render("teacup", {}, "t.png"));
    const bool oiiotool = has("oiiotool", "openimageio-tools"), vdb_render = has("vdb_render", "libopenvdb-tools"),
               assimp = has("assimp", "assimp-utils");
    fmt::print(settings.table,
               "\n| what | call | file cache | median ms | least | most | of the first |\n|---|---|---|---:|---:|---:|---:|\n");

    Group start{"start", {}}, picture{"1080p of a level set of 256 voxels", {}}, writing{"1080p copied, and drawn", {}},
        mesh{"facts of a mesh", {}};
    if (oiiotool) start.contestants.push_back({"oiiotool --version", {"oiiotool", "--version"}});
    start.contestants.push_back({"limn --version", {limn, "--version"}});
    start.contestants.push_back({"limn list scenes", {limn, "list", "scenes"}});
    start.contestants.push_back({"limn info ellipsoid", {limn, "info", "ellipsoid"}});
    race(start);

    if (vdb_render)
      picture.contestants.push_back({"vdb_render e.vdb",
                                     {"vdb_render", file("e.vdb"), file("peer.png"), "-res", "1920x1080", "-shader", "normal", "-translate",
                                      "0,0,4", "-samples", "1"}});
    picture.contestants.push_back({"limn render ellipsoid", render("ellipsoid", level_set, "e.png")});
    picture.contestants.push_back({"limn render e.vdb", render(file("e.vdb"), {}, "v.png")});
    race(picture);

    if (oiiotool) writing.contestants.push_back({"oiiotool t.png -o u.png", {"oiiotool", file("t.png"), "-o", file("u.png")}});
    writing.contestants.push_back(
        {"limn render machined_part --surface analytic", render("machined_part", {"--surface", "analytic"}, "w.png")});
    if (oiiotool) race(writing);

    run_measured({limn, "export", "rook", "--level", "5", "--quiet", "-o", file("rook.obj")});
    if (assimp) mesh.contestants.push_back({"assimp info rook.obj", {"assimp", "info", file("rook.obj")}});
    mesh.contestants.push_back({"limn info rook.obj", {limn, "info", file("rook.obj")}});
    mesh.contestants.push_back({"limn render rook.obj", render(file("rook.obj"), {}, "r.png")});
    race(mesh);

    fmt::print(settings.table,
               "\n| stages of a call, ms | start and end | load | build | trace | border | write | all |\n"
               "|---|---:|---:|---:|---:|---:|---:|---:|\n");
    break_down("render ellipsoid --surface level_set", render("ellipsoid", level_set, "e.png"));
    break_down("render e.vdb", render(file("e.vdb"), {}, "v.png"));
    break_down("render teacup", render("teacup", {}, "t.png"));
    break_down("render machined_part --surface analytic", render("machined_part", {"--surface", "analytic"}, "m.png"));
    std::vector<std::string> views = render("ellipsoid", level_set, "v{view}.png");
    views.insert(views.end(), {"--views", "16"});
    break_down("render ellipsoid --surface level_set --views 16", views);
  }
};

}  // namespace

json bench_calls(const CallsBenchSettings& settings) {
  const Folder folder;
  const fs::path program = settings.program.empty() ? fs::read_symlink("/proc/self/exe").parent_path() / "limn" : settings.program;
  if (!fs::exists(program))
    throw InputError({.field = "--program", .value = program.string(), .problem = "no such program", .expected = "the program limn"});
  Suite suite{settings, program.string(), folder.path};
  suite.run();
  return std::move(suite.rows);
}

}  // namespace limn::bench
