// limn study and limn merge as people run them, stop them and run them again.

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <map>
#include <random>
#include <set>
#include <sstream>

#include "run_program.h"
#include "tests/random_seed.h"

namespace limn {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

// Three kinds of model, two views, a fraction of a second.
std::vector<std::string> small_study(const std::string& out, std::vector<std::string> more = {}) {
  std::vector<std::string> arguments = {"study",    "ellipsoid", "--size",    "96x72",       "--levels",    "0..2",
                                        "--voxels", "16,24",     "--normals", "flat,limit",  "--views",     "2",
                                        "-o",       out,         "-q",        "--gradients", "cell,central"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

std::vector<json> rows_of(const fs::path& folder) {
  std::vector<json> rows;
  std::ifstream stream(folder / "rows.jsonl");
  for (std::string line; std::getline(stream, line);) rows.push_back(json::parse(line));
  return rows;
}

/// Rows in their order, times aside.
std::string timeless(const fs::path& folder) {
  std::string text;
  for (json row : rows_of(folder)) {
    for (const char* of : {"time", "build", "trace", "border"})
      for (const char* which : {"_ms", "_low_ms", "_high_ms"}) row.erase(std::string(of) + which);
    text += row.dump() + "\n";
  }
  return text;
}

void expect_consistent(const fs::path& folder) {
  std::set<std::pair<std::string, std::string>> seen;
  const std::vector<json> rows = rows_of(folder);
  for (const json& row : rows) EXPECT_TRUE(seen.emplace(row.at("key"), row.at("metric")).second) << "twice: " << row.dump();
  std::ifstream csv(folder / "rows.csv");
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line.substr(0, 10), "key,scene,");
  for (const json& row : rows) {
    ASSERT_TRUE(std::getline(csv, line));
    EXPECT_EQ(line.substr(0, line.find(',')), row.at("key").get<std::string>());
  }
  EXPECT_FALSE(std::getline(csv, line)) << "rows.csv has more rows than rows.jsonl";
}

TEST(StudyCommand, MeasuresEveryCellAndReports) {
  const TemporaryFolder folder;
  const RunResult result = run_limn(small_study(folder.file("out"), {"--json"}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(result.err.empty()) << result.err;
  const json document = result.json();
  EXPECT_EQ(document.at("cells"), (1 + 3 * 2 + 2 * 2) * 2);
  EXPECT_EQ(document.at("failed"), 0);
  for (const std::string file : document.at("files")) EXPECT_TRUE(fs::exists(file)) << file;
  expect_consistent(folder.path() / "out");
  std::map<std::string, double> mean_error;
  std::set<std::string> keys;
  for (const json& row : rows_of(folder.path() / "out")) {
    keys.insert(row.at("key"));
    EXPECT_TRUE(fs::exists(folder.path() / "out/cells" / (row.at("key").get<std::string>() + ".png")));
    EXPECT_GT(row.at("trace_ms"), 0.0);
    if (row.at("surface") == "mesh" && row.at("metric") == "normal_error_mean" && row.at("view") == 1 &&
        row.at("surface_parameters").at("normals") == "flat")
      mean_error[row.at("surface_parameters").at("level")] = row.at("value");
    if (row.at("surface") == "analytic" && row.at("metric") == "normal_error_mean") {
      EXPECT_EQ(row.at("value"), 0.0);
    }
    if (row.at("surface") == "level_set") {
      EXPECT_GT(row.at("bytes"), 0);
    }
  }
  EXPECT_EQ(keys.size(), document.at("cells"));
  EXPECT_LT(mean_error.at("2"), 0.6 * mean_error.at("1"));
  EXPECT_LT(mean_error.at("1"), 0.6 * mean_error.at("0"));
}

TEST(StudyCommand, SaysBeforehandWhatItWillTake) {
  const TemporaryFolder folder;
  std::vector<std::string> arguments = small_study(folder.file("out"));
  std::erase(arguments, "-q");
  const RunResult result = run_limn(arguments);
  EXPECT_NE(result.err.find("22 cells (11 models x 2 views x 1 methods); about "), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("MB"), std::string::npos) << result.err;
  EXPECT_NE(result.out.find("report.html"), std::string::npos) << result.out;
}

TEST(StudyCommand, WhatWouldNotFitIsARowWithItsReasonAndNotBuilt) {
  const TemporaryFolder folder;
  const RunResult result = run_limn({"study", "rook", "--size", "64x48", "--surface", "mesh", "--levels", "1,8", "--normals", "flat",
                                     "--views", "1", "--max-memory", "400M", "-o", folder.file("out"), "--json", "-q"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.json().at("failed"), 1);
  int failed = 0;
  for (const json& row : rows_of(folder.path() / "out")) {
    if (!row.contains("failed")) continue;
    ++failed;
    EXPECT_EQ(row.at("surface_parameters").at("level"), "8");
    EXPECT_FALSE(row.at("failed").get<std::string>().empty());
    EXPECT_TRUE(row.at("value").is_null());
  }
  EXPECT_EQ(failed, 1);
}

TEST(StudyCommand, FlickerIsMeasuredWhereItIsAskedFor) {
  const TemporaryFolder folder;
  const std::vector<std::string> arguments = {"study", "ellipsoid", "--size", "64x48",   "--surface", "mesh", "--levels",
                                              "1",     "--normals", "flat",   "--views", "1",         "-q",   "-o"};
  const auto metrics = [&](const std::string& out, bool flicker) {
    std::vector<std::string> own = arguments;
    own.push_back(folder.file(out));
    if (flicker) own.push_back("--flicker");
    EXPECT_EQ(run_limn(own).exit_code, 0);
    std::set<std::string> names;
    for (const json& row : rows_of(folder.path() / out)) names.insert(row.at("metric"));
    return names;
  };
  const std::set<std::string> still = metrics("still", false), moved = metrics("moved", true);
  bool has_motion_metric = false;
  for (const json& metric : run_limn({"list", "metrics", "--json"}).json())
    has_motion_metric = has_motion_metric || metric.at("name").get<std::string>().find("flicker") != std::string::npos;
  EXPECT_EQ(moved.size() > still.size(), has_motion_metric);
}

TEST(StudyCommand, AFinishedStudyIsNotDoneAgainAndAnotherOneIsRefused) {
  const TemporaryFolder folder;
  const std::string out = folder.file("out");
  ASSERT_EQ(run_limn(small_study(out)).exit_code, 0);
  const std::string rows = read_bytes(folder.path() / "out/rows.jsonl");
  ASSERT_EQ(run_limn(small_study(out)).exit_code, 0);
  EXPECT_EQ(read_bytes(folder.path() / "out/rows.jsonl"), rows) << "times too: nothing was measured again";
  const RunResult other = run_limn(small_study(out, {"--thresholds", "0.3"}));
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_EQ(other.err_lines(), 1) << other.err;
  EXPECT_NE(other.err.find("threshold"), std::string::npos) << other.err;
  EXPECT_NE(other.err.find("--fresh"), std::string::npos) << other.err;
  EXPECT_EQ(read_bytes(folder.path() / "out/rows.jsonl"), rows);
  EXPECT_EQ(run_limn(small_study(out, {"--thresholds", "0.3", "--fresh"})).exit_code, 0);
  EXPECT_NE(timeless(folder.path() / "out").find("\"threshold\":\"0.3\""), std::string::npos);
  expect_consistent(folder.path() / "out");
}

TEST(StudyCommand, InterruptedItEndsWith130AndGoesOnWhereItStopped) {
  const TemporaryFolder folder;
  const std::vector<std::string> more = {"--size", "160x120", "--views", "3"};
  // On a machine that is done by then the interrupt comes earlier.
  RunResult result;
  for (double after_s = 0.5; after_s > 0.01; after_s *= 0.7) {
    fs::remove_all(folder.path() / "out");
    result = interrupt_limn(small_study(folder.file("out"), more), after_s);
    if (result.exit_code != 0) break;
  }
  EXPECT_EQ(result.exit_code, 130);
  for (const std::string& file : folder.files()) EXPECT_EQ(file.find(".limn-"), std::string::npos) << file;
  ASSERT_EQ(run_limn(small_study(folder.file("out"), more)).exit_code, 0);
  ASSERT_EQ(run_limn(small_study(folder.file("whole"), more)).exit_code, 0);
  EXPECT_EQ(timeless(folder.path() / "out"), timeless(folder.path() / "whole"));
}

TEST(StudyCommand, KilledAtTenRandomMomentsItEndsWithTheRowsOfAnUndisturbedOne) {
  const TemporaryFolder folder;
  const fs::path whole = folder.path() / "whole", out = folder.path() / "out";
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(run_limn(small_study(whole.string())).exit_code, 0);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const std::string expected = timeless(whole);
  const unsigned seed = random_seed();
  std::printf("seed %u, %.2f s undisturbed\n", seed, seconds);
  std::mt19937 random(seed);
  // Others may use the machine from now on: while no kill finds a row, later ones are tried, but for those that come too late.
  double earliest = 0.0, latest = 0.5 * seconds;
  int kills = 0, in_the_middle = 0;
  for (int attempt = 0; attempt < 80 && (kills < 10 || in_the_middle == 0); ++attempt) {
    const double moment = std::uniform_real_distribution<double>(earliest, latest)(random);
    const RunResult result = kill_limn(small_study(out.string()), moment);
    const size_t done = fs::exists(out / "rows.jsonl") ? fs::file_size(out / "rows.jsonl") : 0;
    if (result.exit_code == 0) {
      EXPECT_EQ(timeless(out), expected) << "after " << kills << " kills";
      fs::remove_all(out);
      latest = std::max(moment, 1.05 * earliest);
      continue;
    }
    ASSERT_EQ(result.exit_code, 137);
    ++kills;
    in_the_middle += done > 0 ? 1 : 0;
    if (done == 0 && in_the_middle == 0) earliest = 0.9 * moment, latest = std::max(latest, 1.3 * moment);
  }
  EXPECT_GE(kills, 10);
  EXPECT_GT(in_the_middle, 0);
  ASSERT_EQ(run_limn(small_study(out.string())).exit_code, 0);
  EXPECT_EQ(timeless(out), expected);
  expect_consistent(out);
}

TEST(StudyCommand, ShardsMergedInAnyOrderGiveTheRowsOfOneProcess) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_limn(small_study(folder.file("whole"))).exit_code, 0);
  const fs::path out = folder.path() / "out";
  for (const char* shard : {"3/3", "1/3"}) ASSERT_EQ(run_limn(small_study(out.string(), {"--shard", shard})).exit_code, 0);
  EXPECT_EQ(run_limn(small_study(out.string(), {"--shard", "1/3"})).exit_code, 0) << "there already";
  const RunResult partly = run_limn({"merge", out.string(), "-o", folder.file("merged")});
  EXPECT_EQ(partly.exit_code, 1);
  EXPECT_NE(partly.err.find("cells are missing"), std::string::npos) << partly.err;
  ASSERT_EQ(run_limn(small_study(out.string(), {"--shard", "2/3"})).exit_code, 0);
  const auto part = [&](int i) { return (out / ("part-" + std::to_string(i) + "-of-3")).string(); };
  const RunResult merged = run_limn({"merge", part(2), part(3), part(2), part(1), "-o", folder.file("merged"), "--json"});
  ASSERT_EQ(merged.exit_code, 0) << merged.err;
  EXPECT_TRUE(merged.json().at("missing").empty());
  EXPECT_EQ(timeless(folder.path() / "merged"), timeless(folder.path() / "whole"));
  EXPECT_TRUE(fs::exists(folder.path() / "merged/report.html"));
  expect_consistent(folder.path() / "merged");
  EXPECT_EQ(run_limn(small_study(folder.file("merged"))).exit_code, 0) << "the merged folder is the study's";
  ASSERT_EQ(run_limn(small_study(folder.file("other"), {"--thresholds", "0.3", "--shard", "1/2"})).exit_code, 0);
  const RunResult mixed = run_limn({"merge", part(1), folder.file("other"), "-o", folder.file("mixed")});
  EXPECT_EQ(mixed.exit_code, 2);
  EXPECT_EQ(mixed.err_lines(), 1) << mixed.err;
  EXPECT_NE(mixed.err.find("threshold"), std::string::npos) << mixed.err;
  EXPECT_FALSE(fs::exists(folder.path() / "mixed")) << "an empty folder";
}

}  // namespace
}  // namespace limn
