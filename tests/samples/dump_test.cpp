// limn info --dump: text on stdout and nothing else anywhere; what has no effect, or is not there, is refused.

#include <gtest/gtest.h>

#include <sstream>

#include "run_program.h"
#include "tests/text_lines.h"

namespace limn {
namespace {

using Words = std::vector<std::string>;

using test::lines_of;

/// The dump of a scene of one object, after the two lines that say where it is and whose it is.
std::vector<std::string> dump(const Words& call) {
  const RunResult result = run_limn(call);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  std::vector<std::string> lines = lines_of(result.out);
  EXPECT_GT(lines.size(), 3u);
  if (lines.size() < 3) return {};
  EXPECT_TRUE(lines[0].starts_with("render_origin: [")) << lines[0];
  EXPECT_TRUE(lines[1].starts_with("object 0: ")) << lines[1];
  lines.erase(lines.begin(), lines.begin() + 2);
  return lines;
}

size_t number_after(const std::string& line, const std::string& word) {
  const size_t at = line.find(word);
  EXPECT_NE(at, std::string::npos) << line;
  return at == std::string::npos ? 0 : std::stoul(line.substr(at + word.size()));
}

void expect_refused(const Words& call, const std::string& hint) {
  const RunResult result = run_limn(call);
  std::string all;
  for (const std::string& word : call) all += word + " ";
  EXPECT_EQ(result.exit_code, 2) << all << result.err;
  EXPECT_EQ(result.out, "") << all;
  EXPECT_EQ(result.err_lines(), 1) << all << result.err;
  EXPECT_NE(result.err.find(hint), std::string::npos) << all << result.err;
}

TEST(Dump, OfAFormulaIsItsProgramOrItsTape) {
  for (const std::string what : {"program", "tape"}) {
    const std::vector<std::string> lines = dump({"info", "gyroid", "--dump", what});
    ASSERT_FALSE(lines.empty());
    ASSERT_TRUE(lines[0].starts_with(what + ": ")) << lines[0];
    const size_t leaves = number_after(lines[0], "constants, ");
    EXPECT_EQ(lines.size(), 1 + leaves + number_after(lines[0], what + ": "));
    EXPECT_TRUE(lines[1].starts_with("leaf 0: "));
  }
}

TEST(Dump, OfALevelSetIsItsBricksAndOneOfThemItsValues) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_limn({"export", "ellipsoid", "--voxels", "24", "-o", folder.file("egg.vdb"), "-q"}).exit_code, 0);
  const std::string cube = folder.write("cube.obj",
                                        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
                                        "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
  for (const Words& input : {Words{"ellipsoid", "--voxels", "24"}, Words{folder.file("egg.vdb")}, Words{cube, "--voxels", "12"}}) {
    Words call = {"info"};
    call.insert(call.end(), input.begin(), input.end());
    call.insert(call.end(), {"--dump", "bricks"});
    const std::vector<std::string> lines = dump(call);
    ASSERT_GT(lines.size(), 5u) << input[0];
    EXPECT_EQ(lines.size(), 5 + number_after(lines[0], "bricks: ")) << input[0];
    call.insert(call.end(), {"--threads", "1"});
    EXPECT_EQ(dump(call), lines) << input[0];
    call.insert(call.end(), {"--brick", "1"});
    const std::vector<std::string> values = dump(call);
    ASSERT_EQ(values.size(), 91u) << input[0];
    EXPECT_EQ(values[0], lines[6]);
    EXPECT_EQ(values[1], "slice z 0");
    call.back() = "100000";
    expect_refused(call, "--brick: no such brick (got 100000, expected 0 to ");
  }
}

TEST(Dump, WhatHasNoEffectOrIsNotThereIsRefused) {
  const TemporaryFolder folder;
  const std::string mesh = folder.write("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
  const std::string picture = folder.file("p.exr");
  ASSERT_EQ(run_limn({"render", "ellipsoid", "--size", "8x6", "-o", picture, "-q"}).exit_code, 0);
  expect_refused({"info", "gyroid", "--dump", "tapes"}, "did you mean 'tape'?");
  expect_refused({"info", "gyroid", "--dump", "tape", "--json"}, "--json");
  expect_refused({"info", "gyroid", "--dump", "tape", "--voxels", "16"}, "--voxels: has no effect on what is dumped");
  expect_refused({"info", "gyroid", "--dump", "bricks", "--level", "2"}, "--level: has no effect on what is dumped");
  expect_refused({"info", "gyroid", "--brick", "2"}, "--dump");
  expect_refused({"info", "gyroid", "--dump", "tape", "--brick", "2"}, "--brick: has no effect on a tape");
  expect_refused({"info", mesh, "--dump", "tape"}, "--dump");
  expect_refused({"info", picture, "--dump", "bricks"}, "a picture holds no formula");
}

TEST(Dump, OfAMixedSceneSaysWhichObjectsHaveNone) {
  const TemporaryFolder folder;
  folder.write("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
  const std::string scene = folder.write("two.toml", "[[object]]\nshape = \"sphere\"\n[[object]]\nmesh = \"mesh.obj\"\n");
  const RunResult result = run_limn({"info", scene, "--dump", "tape"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("\ntape: "), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("\nnothing to dump: "), std::string::npos) << result.out;
  expect_refused({"info", scene, "--dump", "bricks", "--voxels", "12", "--brick", "0"}, "several objects");
}

}  // namespace
}  // namespace limn
