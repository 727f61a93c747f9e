// limn-bench: limn beside its peers, in one process, on the same input; interleaved runs, and the accuracy of every contestant beside
// its time, so that nobody is fast by being wrong.

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "sdf/error.h"
#include "sdf/output_file.h"
#include "sdf/version.h"
#include "tests/bench/against.h"
#include "tests/bench/calls_suite.h"
#include "tests/bench/convert_suite.h"
#include "tests/bench/fields_suite.h"
#include "tests/bench/growth_suite.h"
#include "tests/bench/image_methods.h"
#include "tests/bench/lines_suite.h"
#include "tests/bench/local_level_sets_suite.h"
#include "tests/bench/local_proof.h"
#include "tests/bench/local_suite.h"
#include "tests/bench/march_suite.h"
#include "tests/bench/plan_suite.h"

namespace limn::bench {
namespace {

constexpr const char* kUsage = R"(usage: limn-bench [--suite NAME] [options]

  --suite march     level sets, closed forms and meshes beside OpenVDB, NanoVDB and Embree
          fields    analytic fields beside the closed-form sphere and the memory-write floor
          convert   mesh to level set beside OpenVDB's meshToVolume
          images    image methods beside OpenCV
          plan      what a plan saves (minutes)
          local     local meshes beside meshes as fine everywhere (minutes)
          local-proof   rays through local meshes, and flips along a path (minutes)
          local-calls   whole calls of limn render --tolerance with and without local meshes (minutes)
          local-level-sets  local level sets beside uniform ones
          lines     view graphs from 26 sides: time and conflicts (minutes)
          growth    whole calls of limn on larger and larger files, beside assimp's reading of them (minutes)
          calls     whole calls of limn beside those of other programs, and their stages
          all       the first four (the default)
  --object NAME     sphere, torus, or a built-in scene with a cage; may be repeated
  --mesh FILE       a mesh to march and to convert; may be repeated
  --voxels N        along the longest side; may be repeated
  --runs N          interleaved runs of which the median counts (7)
  --width PX        of pictures 16:9 (1920)
  --scene NAME, --views N   of the plan and local suites (--scene of local-... and lines, too); --view I: only this one of the views, from 0
  --local           of the plan suite: local meshes are tried, too
  --tolerance PX    of the local suite; may be repeated (1 0.5 0.25 0.1)
  --oracle          of the lines suite: rays of another model say whether points of every line are seen; --voxels N: lines of level sets
  --level N         of the growth suite, how often its cage is refined; may be repeated (4 5 6 7)
  --program FILE    of the growth and calls suites: the program limn (the one beside this)
  --output FILE     JSON; --json prints it to stdout, tables then go to stderr
  --against BEFORE AFTER    compares JSON files of two revisions; each may be given as FILE,FILE,... (see ./run bench --against REF)
  --limit X         of --against: exit 1 where one of limn's rows takes more than X times as long (1.1)
)";

struct Settings {
  std::vector<int> voxels{}, levels{};
  std::string program{};
  std::vector<std::string> objects{}, meshes{}, scenes{};
  std::vector<double> tolerances_px{};
  int runs = 7;
  int width_px = 1920, height_px = 1080;
  std::string suite = "all";
  int views = 4;
  std::optional<int> only_view{};
  std::string output{};
  bool json = false, oracle = false, local = false;
  std::vector<std::string> against{};  ///< Two lists of files.
  double limit = 1.1;
  bool runs_suite(const std::string& name) const {
    constexpr std::string_view kQuick[] = {"march", "fields", "convert", "images"};
    return suite == name || (suite == "all" && std::find(std::begin(kQuick), std::end(kQuick), name) != std::end(kQuick));
  }
  /// With --json the document alone goes to stdout.
  std::FILE* table() const { return json ? stderr : stdout; }
};

[[noreturn]] void refuse(const std::string& flag, const std::string& value, const std::string& problem, const std::string& expected) {
  throw InputError({.field = flag, .value = value, .problem = problem, .expected = expected});
}

Settings parse(int argc, char** argv) {
  Settings settings;
  int at = 1;
  const auto value = [&](const std::string& flag) -> std::string {
    if (at + 1 >= argc) refuse(flag, "", "a value is missing", "see --help");
    return argv[++at];
  };
  const auto whole = [&](const std::string& flag, int least) {
    const std::string text = value(flag);
    const int number = std::atoi(text.c_str());
    if (number < least) refuse(flag, text, "out of range", fmt::format("a whole number from {}", least));
    return number;
  };
  for (; at < argc; ++at) {
    const std::string flag = argv[at];
    if (flag == "--output") {
      settings.output = value(flag);
    } else if (flag == "--runs") {
      settings.runs = whole(flag, 1);
    } else if (flag == "--voxels") {
      settings.voxels.push_back(whole(flag, 8));
    } else if (flag == "--object") {
      settings.objects.push_back(value(flag));
    } else if (flag == "--mesh") {
      settings.meshes.push_back(value(flag));
    } else if (flag == "--scene") {
      settings.scenes.push_back(value(flag));
    } else if (flag == "--views") {
      settings.views = whole(flag, 1);
    } else if (flag == "--view") {
      settings.only_view = whole(flag, 0);
    } else if (flag == "--tolerance") {
      settings.tolerances_px.push_back(std::atof(value(flag).c_str()));
      if (!(settings.tolerances_px.back() > 0.0)) refuse(flag, argv[at], "out of range", "a number of pixels above 0");
    } else if (flag == "--level") {
      settings.levels.push_back(whole(flag, 0));
    } else if (flag == "--program") {
      settings.program = value(flag);
    } else if (flag == "--suite") {
      settings.suite = value(flag);
      const std::vector<std::string> known{"march",       "fields",           "convert", "images", "plan",  "local", "local-proof",
                                           "local-calls", "local-level-sets", "lines",   "growth", "calls", "all"};
      if (std::find(known.begin(), known.end(), settings.suite) == known.end())
        refuse(flag, settings.suite, "unknown suite", fmt::format("{}", fmt::join(known, ", ")));
    } else if (flag == "--width") {
      settings.width_px = std::min(whole(flag, 16), 16384);
      settings.height_px = std::max(1, settings.width_px * 9 / 16);
    } else if (flag == "--local") {
      settings.local = true;
    } else if (flag == "--oracle") {
      settings.oracle = true;
    } else if (flag == "--json") {
      settings.json = true;
    } else if (flag == "--against") {
      settings.against = {value(flag)};
      settings.against.push_back(value(flag));
    } else if (flag == "--limit") {
      settings.limit = std::atof(value(flag).c_str());
      if (!(settings.limit > 0.0)) refuse(flag, argv[at], "out of range", "above 0");
    } else if (flag == "--help" || flag == "-h") {
      fmt::print("{}", kUsage);
      std::exit(0);
    } else {
      refuse(flag, "", "unknown option", "see --help");
    }
  }
  return settings;
}

nlohmann::json rows_of(const Settings& settings) {
  nlohmann::json rows = nlohmann::json::array();
  const auto append = [&rows](nlohmann::json more) {
    for (auto& row : more) rows.push_back(std::move(row));
  };
  if (settings.runs_suite("march"))
    append(bench_march(
        {settings.objects, settings.meshes, settings.voxels, settings.runs, settings.width_px, settings.height_px, settings.table()}));
  // Objects that are asked for by name are not fields' scenes.
  if (settings.suite == "fields" || (settings.suite == "all" && settings.objects.empty() && settings.meshes.empty()))
    append(
        bench_fields({.runs = settings.runs, .width_px = settings.width_px, .height_px = settings.height_px, .table = settings.table()}));
  if (settings.runs_suite("convert")) {
    // The largest of the marchers' grids would take a minute a run.
    std::vector<int> voxels = settings.voxels;
    if (settings.suite == "all") std::erase_if(voxels, [](int n) { return n > 512; });
    append(bench_convert({settings.objects, settings.meshes, voxels, settings.runs, settings.table()}));
  }
  if (settings.runs_suite("images"))
    append(bench_image_methods(
        {.runs = settings.runs, .width_px = settings.width_px, .height_px = settings.height_px, .table = settings.table()}));
  if (settings.runs_suite("lines"))
    append(bench_lines({.scenes = settings.scenes,
                        .meshes = settings.meshes,
                        .only_view = settings.only_view,
                        .voxels = settings.voxels.empty() ? std::nullopt : std::optional<int>(settings.voxels.front()),
                        .oracle = settings.oracle,
                        .table = settings.table()}));
  if (settings.runs_suite("growth"))
    append(bench_growth({.levels = settings.levels,
                         .voxels = settings.voxels,
                         .field_voxels = settings.voxels,
                         .width_px = settings.width_px == 1920 ? 1280 : settings.width_px,
                         .program = settings.program,
                         .table = settings.table()}));
  if (settings.runs_suite("calls")) append(bench_calls({.runs = settings.runs, .program = settings.program, .table = settings.table()}));
  if (settings.runs_suite("plan"))
    append(bench_plan({.scenes = settings.scenes,
                       .views = settings.views,
                       .only_view = settings.only_view,
                       .local = settings.local,
                       .table = settings.table()}));
  const LocalProofSettings proof{settings.scenes, settings.runs, settings.program, settings.table()};
  if (settings.runs_suite("local-proof")) append(bench_local_proof(proof));
  if (settings.runs_suite("local-calls")) append(bench_local_calls(proof));
  if (settings.runs_suite("local-level-sets"))
    append(
        bench_local_level_sets({.scenes = settings.scenes, .voxels = settings.voxels, .runs = settings.runs, .table = settings.table()}));
  if (settings.runs_suite("local")) {
    LocalBenchSettings local{
        .scenes = settings.scenes, .views = settings.views, .only_view = settings.only_view, .table = settings.table()};
    if (!settings.tolerances_px.empty()) local.tolerances_px = settings.tolerances_px;
    append(bench_local(local));
  }
  return rows;
}

int run(const Settings& settings) {
  nlohmann::json document;
  int result = 0;
  if (!settings.against.empty()) {
    document = compare_revisions(settings.against[0], settings.against[1], settings.limit, settings.table());
    result = document["slower"].empty() ? 0 : 1;
  } else {
    const nlohmann::json rows = rows_of(settings), shown = must_shows(rows);
    print_must_shows(shown, settings.table());
    document = {{"machine", {{"hardware_threads", std::thread::hardware_concurrency()}, {"limn", kVersion}}},
                {"rows", rows},
                {"must_shows", shown}};
  }
  if (!settings.output.empty()) write_whole(settings.output, document.dump(2) + "\n");
  if (settings.json) fmt::print("{}\n", document.dump(2));
  return result;
}

}  // namespace
}  // namespace limn::bench

int main(int argc, char** argv) {
  try {
    if (limn::bench::run_growth_part(argc, argv)) return 0;
    return limn::bench::run(limn::bench::parse(argc, argv));
  } catch (const std::exception& error) {
    fmt::print(stderr, "limn-bench: {}\n", error.what());
    return 2;
  }
}
