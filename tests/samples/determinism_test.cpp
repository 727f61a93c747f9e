#include <gtest/gtest.h>

#include "run_program.h"

namespace limn {
namespace {

class SameBytes : public testing::TestWithParam<const char*> {};

TEST_P(SameBytes, WhateverTheThreadsAndHoweverOften) {
  const TemporaryFolder folder;
  const std::string surface = GetParam();
  std::vector<std::string> call = {
      "render", "tilted_torus",      "--surface", surface, "--size", "160x120", "--samples", "2", "-q", "-o", folder.file("a.exr"),
      "-o",     folder.file("a.png")};
  if (surface.ends_with("level_set")) call.insert(call.end(), {"--voxels", "48"});
  if (surface.starts_with("mesh")) call.insert(call.end(), {"--level", "2"});
  std::vector<std::string> exr, png;
  for (const char* threads : {"1", "2", "0", "0"}) {
    std::vector<std::string> arguments = call;
    arguments.insert(arguments.end(), {"--threads", threads});
    const RunResult result = run_limn(arguments);
    ASSERT_EQ(result.exit_code, 0) << result.err;
    exr.push_back(read_bytes(folder.path() / "a.exr"));
    png.push_back(read_bytes(folder.path() / "a.png"));
  }
  EXPECT_GT(exr[0].size(), 1000u);
  for (size_t i = 1; i < exr.size(); ++i) {
    EXPECT_TRUE(exr[i] == exr[0]) << "EXR of run " << i;
    EXPECT_TRUE(png[i] == png[0]) << "PNG of run " << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Render, SameBytes, testing::Values("analytic", "level_set", "mesh", "mesh_level_set"),
                         [](const auto& test) { return std::string(test.param); });

TEST(Interrupt, ALongRenderLeavesNoFileAndSaysSoWithItsExitCode) {
  const TemporaryFolder folder;
  const RunResult result = interrupt_limn({"render", "gyroid", "--size", "6000x6000", "--samples", "64"}, 0.7, folder.path());
  EXPECT_EQ(result.exit_code, 130) << result.err;
  EXPECT_TRUE(folder.files().empty()) << folder.files().front();
}

TEST(Interrupt, AnOldFileSurvivesIt) {
  const TemporaryFolder folder;
  folder.write("a.png", "old picture");
  const RunResult result =
      interrupt_limn({"render", "gyroid", "--size", "8000x8000", "--samples", "64", "-o", "a.png"}, 0.5, folder.path());
  EXPECT_EQ(result.exit_code, 130) << result.err;
  EXPECT_EQ(folder.files(), std::vector<std::string>{"a.png"});
  EXPECT_EQ(read_bytes(folder.path() / "a.png"), "old picture");
}

TEST(Interrupt, BuildingALargeLevelSetStopsToo) {
  const TemporaryFolder folder;
  const RunResult result = interrupt_limn({"export", "gyroid", "--voxels", "1500", "-o", "a.vdb"}, 0.5, folder.path());
  EXPECT_EQ(result.exit_code, 130) << result.err;
  EXPECT_TRUE(folder.files().empty());
}

TEST(Views, GiveAsManyPicturesAllDifferent) {
  const TemporaryFolder folder;
  const RunResult result = run_limn({"render", "machined_part", "--size", "48x36", "--views", "12", "-o", folder.file("a.png"), "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.json().at("files").size(), 12u);
  EXPECT_EQ(folder.files().size(), 12u);
  EXPECT_EQ(folder.files().front(), "a_v00.png");
  EXPECT_NE(read_bytes(folder.path() / "a_v00.png"), read_bytes(folder.path() / "a_v07.png"));
}

}  // namespace
}  // namespace limn
