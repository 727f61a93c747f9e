// One rule says what is right, wrong, or not to be told; rows carry the floor that it needs, and two questions are asked of files.

#include "samples/experiment/error_floor.h"

#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "run_program.h"

namespace limn {
namespace {

using nlohmann::json;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Judge, AnErrorIsRightWithinTheToleranceIfTheFloorIsToo) {
  const ErrorFloor good{0.01, 0.006, true};
  EXPECT_EQ(good.px(), 0.01);
  EXPECT_EQ(judge(0.5, 0.5, good), Verdict::right);
  EXPECT_EQ(judge(0.51, 0.5, good), Verdict::wrong);
  EXPECT_EQ(judge(NAN, 0.5, good), Verdict::not_to_be_told);
  EXPECT_EQ(judge(0.001, 0.005, good), Verdict::not_to_be_told);  // a floor of 0.01 px tells nothing of 0.005 px
  EXPECT_EQ(why_not_to_be_told(0.5, good), "");
  EXPECT_EQ(why_not_to_be_told(0.005, good), "the true border itself may be 0.006 px off");
  EXPECT_EQ(why_not_to_be_told(0.008, good), "the reference itself scores 0.01 px");
}

TEST(Judge, WhatATruthThatIsNotExactMayBeOffCountsAgainstEitherAnswer) {
  const ErrorFloor doubtful{0.0, 0.2, false};
  EXPECT_EQ(judge(0.3, 0.5, doubtful), Verdict::right);
  EXPECT_EQ(judge(0.31, 0.5, doubtful), Verdict::not_to_be_told);
  EXPECT_EQ(judge(0.7, 0.5, doubtful), Verdict::not_to_be_told);
  EXPECT_EQ(judge(0.71, 0.5, doubtful), Verdict::wrong);
  const ErrorFloor unknown{0.0, kInfinity, false};
  for (const double error : {0.0, 0.4, 1000.0}) EXPECT_EQ(judge(error, 0.5, unknown), Verdict::not_to_be_told);
  EXPECT_EQ(why_not_to_be_told(0.5, unknown), "nobody knows how far the true border itself is off");
}

TEST(Judge, NothingBelowTheFloorIsQuoted) {
  EXPECT_EQ(error_text(0.13, {0.0, 0.006, true}), "0.13 px");
  EXPECT_EQ(error_text(0.001, {0.0, 0.006, true}), "less than 0.006 px");
  EXPECT_EQ(error_text(3.8e-15, {}), "less than 0.005 px");
  // Two digits, rounded up: what is said is never less than the floor.
  EXPECT_EQ(error_text(0.0, {0.01234, 0.0, true}), "less than 0.013 px");
  EXPECT_EQ(error_text(123.4, {}), "123 px");
  EXPECT_EQ(error_text(99.7, {}), "100 px");
}

std::vector<json> rows_of(const std::filesystem::path& folder) {
  std::ifstream stream(folder / "rows.jsonl");
  std::vector<json> rows;
  for (std::string line; std::getline(stream, line);) rows.push_back(json::parse(line));
  return rows;
}

TEST(Floor, OfAFieldIsWhatItsAnalyticSurfaceScores) {
  const TemporaryFolder folder;
  const RunResult run = run_limn({"study", "tilted_torus", "--size", "160x120", "--views", "2", "--surface", "analytic", "--surface",
                                  "level_set", "--voxels", "24", "--gradients", "cubic", "-q", "-o", folder.file("out")});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  std::map<std::pair<std::string, int>, double> analytic;
  for (const json& row : rows_of(folder.path() / "out"))
    if (row["surface"] == "analytic") analytic[{row["metric"], row["view"]}] = row["value"].is_null() ? NAN : row["value"].get<double>();
  int compared = 0;
  for (const json& row : rows_of(folder.path() / "out")) {
    EXPECT_EQ(row["width_px"], 160);
    EXPECT_EQ(row["threshold"], 0.4);
    EXPECT_EQ(row["truth_exact"], true);
    EXPECT_GT(row["truth_bound_px"], 0.0);
    if (row["surface"] == "analytic" || row["floor"].is_null()) continue;
    EXPECT_EQ(row["floor"], (analytic.at({row["metric"], row["view"]}))) << row;
    ++compared;
  }
  EXPECT_GT(compared, 20);
}

/// A cube, whose facets are all there is of it.
std::string cube(const TemporaryFolder& folder) {
  return folder.write("cube.obj",
                      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
                      "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
}

TEST(GivenOrSmooth, AMeshAsItIsIsExactAndTheSurfaceThatWasMeantIsNot) {
  const TemporaryFolder folder;
  const std::string mesh = cube(folder);
  const std::vector<std::string> call = {"study", mesh, "--size", "120x90", "--views", "1", "--surface", "mesh", "-q", "-o"};
  for (const std::string reference : {"given", "smooth"}) {
    std::vector<std::string> words = call;
    words.insert(words.end(), {folder.file(reference), "--reference", reference});
    ASSERT_EQ(run_limn(words).exit_code, 0);
    double worst = 0.0;
    for (const json& row : rows_of(folder.path() / reference)) {
      EXPECT_EQ(row["truth_exact"], reference == "given") << row;
      if (row["metric"] == "silhouette_displacement_max") worst = std::max(worst, row["value"].get<double>());
    }
    // The mesh against itself, from rays on two grids.
    EXPECT_LT(worst, 0.05) << reference;
  }
  const RunResult none = run_limn({"study", "ellipsoid", "--reference", "given", "-o", folder.file("x")});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_NE(none.err.find("--reference: has no effect"), std::string::npos) << none.err;
  const RunResult wrong = run_limn({"study", mesh, "--reference", "smoth", "-o", folder.file("x")});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_NE(wrong.err.find("smooth"), std::string::npos) << wrong.err;
}

}  // namespace
}  // namespace limn
