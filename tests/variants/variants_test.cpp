// One file and one line: the variants of this folder are found wherever variants are named.

#include <gtest/gtest.h>

#include <algorithm>

#include "run_program.h"

namespace limn {
namespace {

using Words = std::vector<std::string>;

RunResult done(const Words& call, const TemporaryFolder& folder) {
  const RunResult result = run_limn(call, folder.path());
  std::string text;
  for (const std::string& word : call) text += word + " ";
  EXPECT_EQ(result.exit_code, 0) << text << ": " << result.err;
  return result;
}

/// Lists as JSON and as text, and the message that names what there is.
void expect_listed(const std::string& kind, const std::string& name, const Words& wrong, const TemporaryFolder& folder) {
  const nlohmann::json entries = done({"list", kind, "--json"}, folder).json();
  const auto is_it = [&](const nlohmann::json& entry) { return entry.at("name") == name; };
  EXPECT_TRUE(std::any_of(entries.begin(), entries.end(), is_it)) << kind << ": " << entries.dump();
  EXPECT_NE(done({"list", kind}, folder).out.find(name), std::string::npos) << kind;
  if (wrong.empty()) return;
  const RunResult refused = run_limn(wrong, folder.path());
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find(name), std::string::npos) << refused.err;
}

TEST(OneLine, AShapeIsListedAndReadFromSceneFiles) {
  const TemporaryFolder folder;
  const std::string scene = folder.write("ball.toml", "[[object]]\nshape = \"trial_ball\"\nradius = 0.5\n");
  const std::string wrong = folder.write("wrong.toml", "[[object]]\nshape = \"trial_bal\"\n");
  expect_listed("shapes", "trial_ball", {"render", wrong}, folder);
  EXPECT_GT(done({"render", scene, "--size", "32x24", "--json"}, folder).json()["hits"], 50);
}

TEST(OneLine, AGradientIsListedDrawnAndSwept) {
  const TemporaryFolder folder;
  expect_listed("gradients", "trial", {"render", "ellipsoid", "--surface", "level_set", "--gradient", "trail"}, folder);
  done({"render", "ellipsoid", "--surface", "level_set", "--voxels", "24", "--gradient", "trial", "--size", "32x24"}, folder);
  const std::string scene =
      folder.write("ball.toml", "[surface]\nkind = \"level_set\"\nvoxels = 24\ngradient = \"trial\"\n[[object]]\nshape = \"sphere\"\n");
  done({"render", scene, "--size", "32x24"}, folder);
  done({"study", "ellipsoid", "--surfaces", "level_set", "--voxels", "16", "--views", "1", "--size", "48x36", "-o", "study"}, folder);
  EXPECT_NE(read_bytes(folder.path() / "study" / "rows.csv").find("trial"), std::string::npos) << "not in the default sweep";
}

TEST(OneLine, ASurfaceIsListedDrawnComparedAndSwept) {
  const TemporaryFolder folder;
  expect_listed("surfaces", "trial", {"render", "ellipsoid", "--surface", "trail"}, folder);
  EXPECT_EQ(done({"render", "ellipsoid", "--surface", "trial", "--size", "32x24", "--json"}, folder).json()["surface"]["kind"], "trial");
  done({"compare", "ellipsoid", "--voxels", "24", "--size", "48x36", "-o", "compared"}, folder);
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "compared" / "trial.exr"));
  EXPECT_NE(read_bytes(folder.path() / "compared" / "report.html").find("trial"), std::string::npos);
  done({"study", "ellipsoid", "--levels", "1", "--voxels", "16", "--views", "1", "--size", "48x36", "-o", "study"}, folder);
  EXPECT_NE(read_bytes(folder.path() / "study" / "rows.csv").find("trial"), std::string::npos) << "not in the default sweep";
}

TEST(OneLine, ALookIsListedAndDrawn) {
  const TemporaryFolder folder;
  expect_listed("looks", "trial", {"render", "ellipsoid", "--look", "trail"}, folder);
  done({"render", "ellipsoid", "--look", "trial", "--size", "32x24", "-o", "look.png"}, folder);
  done({"render", "ellipsoid", "--size", "32x24", "--shading", "flat", "--method", "rim", "--set", "threshold=0.6", "--background", "0,0,1",
        "-o", "parts.png"},
       folder);
  done({"render", "ellipsoid", "--size", "32x24", "-o", "plain.png"}, folder);
  EXPECT_EQ(read_bytes(folder.path() / "look.png"), read_bytes(folder.path() / "parts.png"));
  EXPECT_NE(read_bytes(folder.path() / "look.png"), read_bytes(folder.path() / "plain.png"));
}

TEST(OneLine, AMethodIsListedDrawnComparedAndSwept) {
  const TemporaryFolder folder;
  expect_listed("methods", "trial", {"render", "ellipsoid", "--method", "trail"}, folder);
  done({"render", "ellipsoid", "--method", "trial", "--set", "below=0.5", "--size", "32x24"}, folder);
  const RunResult refused = run_limn({"render", "ellipsoid", "--method", "trial", "--set", "below=2"}, folder.path());
  EXPECT_NE(refused.err.find("--set trial.below: out of range"), std::string::npos) << refused.err;
  const std::string scene = folder.write("ball.toml", "[[border]]\nmethod = \"trial\"\nbelow = 0.2\n[[object]]\nshape = \"sphere\"\n");
  done({"render", scene, "--size", "32x24"}, folder);
  done({"compare", "ellipsoid", "--methods", "all", "--surface", "mesh", "--level", "1", "--size", "48x36", "-o", "compared"}, folder);
  EXPECT_NE(read_bytes(folder.path() / "compared" / "rows.json").find("\"trial below=0.3\""), std::string::npos);
  done(
      {"study", "ellipsoid", "--surfaces", "mesh", "--levels", "1", "--methods", "trial", "--views", "1", "--size", "48x36", "-o", "study"},
      folder);
  EXPECT_NE(read_bytes(folder.path() / "study" / "rows.csv").find("trial"), std::string::npos);
  EXPECT_NE(read_bytes(folder.path() / "study" / "report.html").find("trial"), std::string::npos);
}

TEST(OneLine, AMetricIsListedAndInRows) {
  const TemporaryFolder folder;
  expect_listed("metrics", "trial", {}, folder);
  done({"compare", "ellipsoid", "--surface", "mesh", "--level", "1", "--size", "48x36", "-o", "compared"}, folder);
  EXPECT_NE(read_bytes(folder.path() / "compared" / "rows.json").find("trial_ink"), std::string::npos);
  EXPECT_NE(read_bytes(folder.path() / "compared" / "report.html").find("trial ink"), std::string::npos);
  done({"study", "ellipsoid", "--surfaces", "mesh", "--levels", "1", "--views", "1", "--size", "48x36", "-o", "study"}, folder);
  EXPECT_NE(read_bytes(folder.path() / "study" / "rows.csv").find("trial_ink"), std::string::npos);
}

TEST(OneLine, AnAuditCheckSpeaksInInfo) {
  const TemporaryFolder folder;
  EXPECT_NE(done({"info", "ellipsoid"}, folder).out.find("the check on trial looked"), std::string::npos);
}

TEST(OneLine, AStabilityCheckIsNamedByCasesAndOnTheirPage) {
  const TemporaryFolder folder;
  const char* const rest =
      "row = \"trial\"\nbreaks = \"nothing\"\nholds = \"little ink\"\nmethods = [\"rim\"]\nsurfaces = [\"analytic\"]\nbound = 0\n"
      "sizes = [[32, 24]]\n[[object]]\nshape = \"sphere\"\n";
  const std::string good = folder.write("good.toml", std::string("[case]\ncheck = \"trial_ink\"\n") + rest);
  const std::string wrong = folder.write("wrong.toml", std::string("[case]\ncheck = \"trial_inc\"\n") + rest);
  done({"stability", "--case", good, "-o", "cases"}, folder);
  EXPECT_NE(read_bytes(folder.path() / "cases" / "report.html").find("trial"), std::string::npos);
  const RunResult refused = run_limn({"stability", "--case", wrong}, folder.path());
  EXPECT_NE(refused.err.find("trial_ink"), std::string::npos) << refused.err;
}

TEST(OneLine, ASceneIsListedAndDrawn) {
  const TemporaryFolder folder;
  expect_listed("scenes", "trial", {"render", "trail"}, folder);
  EXPECT_GT(done({"render", "trial", "--size", "32x24", "--json"}, folder).json()["hits"], 50);
}

}  // namespace
}  // namespace limn
