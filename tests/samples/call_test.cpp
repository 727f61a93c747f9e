// The command line itself: usage, help, version, slips of the hand.

#include <gtest/gtest.h>

#include "run_program.h"

namespace limn {
namespace {

TEST(Call, AloneItPrintsUsageAndSucceeds) {
  const RunResult result = run_limn({});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_TRUE(result.err.empty()) << result.err;
  for (const char* command : {"render", "compare", "study", "plan", "stability", "export", "info", "merge", "list"})
    EXPECT_NE(result.out.find(command), std::string::npos) << command;
  EXPECT_EQ(run_limn({"--help"}).out, result.out);
}

TEST(Call, HelpOfEveryCommandHasGroupsDefaultsAndAnExample) {
  for (const std::string command : {"render", "compare", "study", "plan", "stability", "export", "info", "merge", "list"}) {
    const RunResult result = run_limn({command, "--help"});
    EXPECT_EQ(result.exit_code, 0) << command;
    EXPECT_TRUE(result.err.empty()) << result.err;
    EXPECT_NE(result.out.find("  limn " + command + " "), std::string::npos) << "no example for " << command;
    EXPECT_NE(result.out.find("Output"), std::string::npos) << command;
  }
  const std::string render = run_limn({"render", "--help"}).out;
  for (const char* word : {"Camera", "Surface", "Border", "default 1280x720", "degrees", "world units", "voxels"}) {
    EXPECT_NE(render.find(word), std::string::npos) << word;
  }
}

TEST(Call, AnOptionWithoutMeaningForACommandDoesNotExistThere) {
  EXPECT_EQ(run_limn({"info", "ellipsoid", "--fov", "30"}).exit_code, 2);
  EXPECT_EQ(run_limn({"compare", "ellipsoid", "--views", "3"}).exit_code, 2);
  EXPECT_EQ(run_limn({"export", "ellipsoid", "--samples", "3"}).exit_code, 2);
  EXPECT_EQ(run_limn({"study", "ellipsoid", "--samples", "3"}).exit_code, 2);
  EXPECT_EQ(run_limn({"merge", "part", "--views", "3"}).exit_code, 2);
}

TEST(Call, VersionNamesTheLibraries) {
  const RunResult result = run_limn({"--version"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.out.rfind("limn ", 0), 0u) << result.out;
  for (const char* library : {"SIMD", "OpenVDB 1", "OpenSubdiv 3.", "OpenImageIO 2.", "Embree 3.", "oneTBB"}) {
    EXPECT_NE(result.out.find(library), std::string::npos) << library << " in " << result.out;
  }
}

struct Slip {
  std::vector<std::string> arguments;
  std::string hint;
};

class Slips : public testing::TestWithParam<Slip> {};

TEST_P(Slips, AreAnsweredInOneLineWithTheNearestName) {
  const TemporaryFolder folder;
  const RunResult result = run_limn(GetParam().arguments, folder.path());
  EXPECT_EQ(result.exit_code, 2) << result.err;
  EXPECT_EQ(result.err_lines(), 1) << result.err;
  EXPECT_TRUE(result.out.empty()) << result.out;
  EXPECT_NE(result.err.find(GetParam().hint), std::string::npos) << "wanted '" << GetParam().hint << "' in: " << result.err;
  EXPECT_TRUE(folder.files().empty());
}

INSTANTIATE_TEST_SUITE_P(
    Call, Slips,
    testing::Values(
        Slip{{"rendr", "ellipsoid"}, "'render'"}, Slip{{"render", "elipsoid"}, "'ellipsoid'"},
        Slip{{"render", "ellipsoid", "--voxel", "10"}, "'--voxels'"}, Slip{{"render", "ellipsoid", "--sise", "10x10"}, "'--size'"},
        Slip{{"render", "ellipsoid", "--surface", "levelset"}, "'level_set'"}, Slip{{"render", "ellipsoid", "--method", "rimm"}, "'rim'"},
        Slip{{"render", "ellipsoid", "--gradient", "centrl"}, "'central'"},
        Slip{{"render", "ellipsoid", "--scheme", "catmul"}, "'catmark'"},
        Slip{{"render", "ellipsoid", "--normals", "smooth"}, "flat, vertex, limit"},
        Slip{{"render", "ellipsoid", "--set", "treshold=0.3"}, "'threshold'"},
        Slip{{"render", "ellipsoid", "--set", "threshold"}, "key=value"}, Slip{{"render", "ellipsoid", "--set", "threshold=2"}, "1"},
        Slip{{"list", "shape"}, "'shapes'"}, Slip{{"list"}, "KIND"}, Slip{{"render"}, "INPUT"},
        Slip{{"render", "ellipsoid", "gyroid"}, "one"}, Slip{{"render", "ellipsoid", "--eye", "1,2"}, "three numbers"},
        Slip{{"render", "ellipsoid", "--eye", "1,2,nan"}, "finite"}, Slip{{"render", "ellipsoid", "--size", "0x10"}, "16384"},
        Slip{{"render", "ellipsoid", "--size", "100"}, "WxH"}, Slip{{"render", "ellipsoid", "--fov", "0"}, "180"},
        Slip{{"render", "ellipsoid", "--fov", "180"}, "180"}, Slip{{"render", "ellipsoid", "--fov", "30", "--ortho", "2"}, "--ortho"},
        Slip{{"render", "ellipsoid", "--ortho", "0"}, "above 0"}, Slip{{"render", "ellipsoid", "--level", "9"}, "0 to 8"},
        Slip{{"render", "ellipsoid", "--level", "automatic"}, "0 to 8"}, Slip{{"export", "ellipsoid", "--level", "auto"}, "0 to 8"},
        Slip{{"render", "ellipsoid", "--samples", "0"}, "1 to 1024"}, Slip{{"render", "ellipsoid", "--half-width", "1"}, "1.8"},
        Slip{{"render", "ellipsoid", "--voxel-size", "-1"}, "above 0"}, Slip{{"render", "ellipsoid", "--threads", "few"}, "whole number"},
        Slip{{"render", "ellipsoid", "--grid", "x"}, ".vdb"}, Slip{{"render", "ellipsoid", "--eye", "0,0,5", "--target", "0,0,5"}, "--eye"},
        Slip{{"study", "ellipsoid", "--levels", "0..9"}, "0 to 8"}, Slip{{"study", "ellipsoid", "--levels", "a"}, "whole number"},
        Slip{{"study", "ellipsoid", "--levels", "1,,2"}, "whole number"}, Slip{{"study", "ellipsoid", "--level", "3"}, "'--levels'"},
        Slip{{"study", "ellipsoid", "--voxels", "2"}, "4 to 8192"}, Slip{{"study", "ellipsoid", "--normals", "smooth"}, "flat"},
        Slip{{"study", "ellipsoid", "--gradients", "cubics"}, "'cubic'"}, Slip{{"study", "ellipsoid", "--methods", "rimm"}, "'rim'"},
        Slip{{"study", "ellipsoid", "--thresholds", "0.4,1"}, "below 1"}, Slip{{"study", "ellipsoid", "--views", "0"}, "1 to 10000"},
        Slip{{"study", "ellipsoid", "--methods", "sobel", "--thresholds", "0.2"}, "rim"},
        Slip{{"study", "ellipsoid", "--shard", "3"}, "2/8"}, Slip{{"study", "ellipsoid", "--shard", "0/3"}, "1 to 3"},
        Slip{{"study", "ellipsoid", "--shard", "4/3"}, "1 to 3"}, Slip{{"study", "ellipsoid", "--max-memory", "lots"}, "4G"},
        Slip{{"study", "elipsoid"}, "'ellipsoid'"}, Slip{{"study"}, "INPUT"}, Slip{{"merge"}, "DIR"},
        Slip{{"merge", "nowhere"}, "no such folder"}, Slip{{"merge", "."}, "no part"},
        Slip{{"render", "teacup", "--surface", "analytic"}, "mesh"}, Slip{{"export", "ellipsoid", "--surface", "analytic"}, "mesh"}));

TEST(Call, NegativeNumbersAreValuesNotOptions) {
  const TemporaryFolder folder;
  const RunResult result = run_limn({"render", "ellipsoid", "--size", "16x12", "--eye", "-3,-2,4", "-o", folder.file("a.png"), "-q"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
}

TEST(Call, LevelAutoTakesWhatThePictureNeedsAndSaysWhatItTook) {
  const TemporaryFolder folder;
  const auto triangles = [&](const std::string& distance) {
    const RunResult result = run_limn({"render", "pipe_junction", "--level", "auto", "--size", "160x120", "--eye", "0,0," + distance,
                                       "--target", "0,0,0", "-o", folder.file("a.exr"), "--json"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_NE(result.out.find("px from its surface"), std::string::npos) << result.out;
    const std::string field = "\"triangles\": ";
    return std::stol(result.out.substr(result.out.find(field) + field.size()));
  };
  const long near = triangles("8"), far = triangles("80");
  EXPECT_GT(near, 2 * far);
}

}  // namespace
}  // namespace limn
