// --max-memory and --max-time: refused beforehand with an estimate, held to while running; what the estimates are worth.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <regex>
#include <utility>

#include "run_program.h"
#include "samples/experiment/limits.h"
#include "sdf/guard_helper.h"

namespace limn {
namespace {

using Arguments = std::vector<std::string>;

/// "about 430.2 MB" of a message, in bytes; NaN where there is none.
double bytes_in(const std::string& text, const std::string& before) {
  std::smatch found;
  if (!std::regex_search(text, found, std::regex(before + R"(([0-9.]+) (B|kB|MB|GB))"))) return std::nan("");
  const std::string unit = found[2];
  return std::stod(found[1]) * (unit == "GB" ? 1e9 : unit == "MB" ? 1e6 : unit == "kB" ? 1e3 : 1.0);
}

TEST(Limits, MoreMemoryThanAllowedIsRefusedBeforehandWithWhatWouldFit) {
  const TemporaryFolder folder;
  const RunResult result = run_limn({"render", "gyroid", "--surface", "level_set", "--voxels", "4096", "--size", "64x64", "--max-memory",
                                     "400M", "-o", folder.file("x.png")});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.err_lines(), 1) << result.err;
  EXPECT_GT(bytes_in(result.err, "the call needs about "), 4e8) << result.err;
  EXPECT_EQ(bytes_in(result.err, "--max-memory allows "), 4e8) << result.err;
  EXPECT_LT(result.peak_bytes, 300e6) << "nothing was built";
  EXPECT_TRUE(folder.files().empty());

  // What it proposes is let through, and does.
  std::smatch found;
  ASSERT_TRUE(std::regex_search(result.err, found, std::regex("--voxels ([0-9]+) needs about"))) << result.err;
  const RunResult smaller = run_limn({"render", "gyroid", "--surface", "level_set", "--voxels", found[1].str(), "--size", "64x64",
                                      "--max-memory", "400M", "-q", "-o", folder.file("x.png")});
  EXPECT_EQ(smaller.exit_code, 0) << smaller.err;
  // The sanitizers' own memory says nothing of limn's.
  if (kAddressSpaceCanBeLimited) {
    EXPECT_LT(smaller.peak_bytes, 4.2e8);
  }
}

TEST(Limits, EveryCommandThatBuildsRefuses) {
  const TemporaryFolder folder;
  const std::string out = folder.file("out");
  const Arguments calls[] = {
      {"export", "ellipsoid", "--voxels", "4096", "-o", out + ".vdb", "--max-memory", "500M"},
      {"export", "teacup", "--level", "8", "-o", out + ".obj", "--max-memory", "500M"},
      {"compare", "ellipsoid", "--size", "8192x8192", "-o", out, "--max-memory", "500M"},
      {"render", "ellipsoid", "--size", "16384x16384", "-o", out + ".exr", "--max-memory", "4G"},
      {"render", "ellipsoid", "--voxel-size", "1e-4", "--surface", "level_set", "-o", out + ".png", "--max-memory", "2G"},
      {"plan", "ellipsoid", "--tolerance", "1", "--size", "8192x8192", "--max-memory", "1G"},
  };
  for (const Arguments& call : calls) {
    const RunResult result = run_limn(call);
    EXPECT_EQ(result.exit_code, 2) << call.front() << ": " << result.err;
    EXPECT_EQ(result.err_lines(), 1) << result.err;
    EXPECT_NE(result.err.find("the call needs about "), std::string::npos) << result.err;
    EXPECT_NE(result.err.find("needs about", result.err.find("; --max-memory allows ")), std::string::npos)
        << "no smaller call named: " << result.err;
    EXPECT_TRUE(folder.files().empty()) << call.front();
  }
}

TEST(Limits, WithoutOptionsTheMachineIsTheLimit) {
  if (machine_memory() > 60e9) GTEST_SKIP() << "this machine has room for the picture";
  const TemporaryFolder folder;
  const RunResult result = run_limn({"render", "ellipsoid", "--size", "16384x16384", "-o", folder.file("x.exr")});
  EXPECT_EQ(result.exit_code, 2) << result.err;
  EXPECT_GT(bytes_in(result.err, "the call needs about "), machine_memory()) << result.err;
  EXPECT_NE(result.err.find("the machine has"), std::string::npos) << result.err;
}

TEST(Limits, MemoryForTheProgramItselfMustBeThere) {
  const RunResult result = run_limn({"render", "ellipsoid", "--max-memory", "5M"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("--max-memory: too little; the program itself takes"), std::string::npos) << result.err;
}

struct EstimateCase {
  const char* name;
  Arguments arguments;
};

class Estimate : public testing::TestWithParam<EstimateCase> {};

TEST_P(Estimate, IsRightToAFactorOfTwoBeyondTheProgramItself) {
  if (!kAddressSpaceCanBeLimited) GTEST_SKIP() << "the sanitizers take memory of their own";
  const TemporaryFolder folder;
  Arguments arguments = GetParam().arguments;
  const bool layers = arguments.back() == "exr";
  if (layers) arguments.pop_back();
  for (const std::string& more : {std::string("-v"), std::string("-o"), folder.file(layers ? "x.exr" : "x.png")}) arguments.push_back(more);
  const RunResult result = run_limn(arguments);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const double of_itself = kProgramBytes;
  const double expected = bytes_in(result.err, "expected to take about ") - of_itself, taken = result.peak_bytes - of_itself;
  ASSERT_GT(taken, 30e6) << "too small to tell";
  EXPECT_GT(expected, 0.5 * taken) << expected << " expected, " << taken << " taken";
  EXPECT_LT(expected, 2.0 * taken) << expected << " expected, " << taken << " taken";
}

INSTANTIATE_TEST_SUITE_P(
    Limits, Estimate,
    testing::Values(
        EstimateCase{"level_set_512", {"render", "ellipsoid", "--size", "64x64", "--surface", "level_set", "--voxels", "512"}},
        EstimateCase{"level_set_512_wide",
                     {"render", "ellipsoid", "--size", "64x64", "--surface", "level_set", "--voxels", "512", "--half-width", "6"}},
        EstimateCase{"gyroid_256", {"render", "gyroid", "--size", "64x64", "--surface", "level_set", "--voxels", "256"}},
        EstimateCase{"mesh_5", {"render", "ellipsoid", "--size", "64x64", "--surface", "mesh", "--level", "5"}},
        EstimateCase{"cage_4", {"render", "teacup", "--size", "64x64", "--surface", "mesh", "--level", "4"}},
        EstimateCase{"cage_5", {"render", "teacup", "--size", "64x64", "--surface", "mesh", "--level", "5"}},
        EstimateCase{"mesh_level_set_384", {"render", "teacup", "--size", "64x64", "--surface", "mesh_level_set", "--voxels", "384"}},
        EstimateCase{"picture", {"render", "ellipsoid", "--size", "2400x1800"}},
        EstimateCase{"picture_of_many_samples", {"render", "ellipsoid", "--size", "2000x1500", "--samples", "9"}},
        EstimateCase{"samples", {"render", "ellipsoid", "--size", "1600x1200", "--samples", "3", "--method", "sobel"}},
        EstimateCase{"sequence", {"render", "ellipsoid", "--size", "900x600", "--frames", "4"}},
        EstimateCase{"sequence_that_holds_on",
                     {"render", "ellipsoid", "--size", "600x400", "--frames", "4", "--samples", "3", "--set", "hysteresis=0.1"}},
        EstimateCase{"layers", {"render", "ellipsoid", "--size", "1200x900", "exr"}}),
    [](const testing::TestParamInfo<EstimateCase>& one) { return one.param.name; });

TEST(Limits, MemoryIsHeldToWhereNothingWasExpected) {
  if (!kAddressSpaceCanBeLimited) GTEST_SKIP() << "the sanitizers take memory of their own";
  const TemporaryFolder folder;
  // What the search for a true border takes nobody knows beforehand; here some 65 MB.
  const RunResult held = run_limn(
      {"plan", "gyroid", "--tolerance", "1", "--surface", "level_set", "--size", "320x180", "--max-memory", "45M", "-q"}, folder.path());
  EXPECT_EQ(held.exit_code, 1) << held.err;
  EXPECT_EQ(held.err, "limn: --max-memory: the limit of 45.0 MB was reached; use fewer voxels, a lower level or a smaller picture\n");
  EXPECT_TRUE(held.out.empty());
  EXPECT_TRUE(folder.files().empty());
  EXPECT_LT(held.peak_bytes, 1.3 * 45e6) << "stacks of threads are counted, and not touched";
}

TEST(Limits, AStudyWhoseMemoryEndsSaysSo) {
  if (!kAddressSpaceCanBeLimited) GTEST_SKIP() << "the sanitizers take memory of their own";
  // Where nobody told it of the limit. Wherever it ends, in whatever loops; with more threads it may do.
  int ended = 0;
  for (const auto& [scene, most_bytes] :
       {std::pair{"teacup", 250'000'000u}, {"teacup", 300'000'000u}, {"rook", 250'000'000u}, {"rook", 300'000'000u}}) {
    const TemporaryFolder folder;
    const RunResult held = run_limn_within(most_bytes, {"study", scene, "--fresh", "-q", "-o", folder.file("out")}, folder.path());
    EXPECT_TRUE(held.exit_code == 0 || held.exit_code == 1) << scene << " " << most_bytes << ": " << held.exit_code << held.err;
    if (held.exit_code == 0) continue;
    ++ended;
    EXPECT_NE(held.err.find("memory"), std::string::npos) << scene << " " << most_bytes << held.err;
  }
  EXPECT_GT(ended, 0);
}

TEST(Limits, AStudyFitsIntoTheMemoryThatItAccepts) {
  if (!kAddressSpaceCanBeLimited) GTEST_SKIP() << "the sanitizers take memory of their own";
  const auto study = [](const char* scene, const char* size, const char* views, const char* memory) {
    const TemporaryFolder folder;
    return run_limn(
        {"study", scene, "--fresh", "--size", size, "--views", views, "--threads", "2", "--max-memory", memory, "-o", folder.file("out")},
        folder.path());
  };
  // Just above what it asks for: the finest models are left out, and the others have room.
  for (const auto& [scene, size, views, memory] : {std::array{"ellipsoid", "160x90", "1", "210M"},
                                                   {"ellipsoid", "160x90", "3", "235M"},
                                                   {"teacup", "320x180", "1", "220M"},
                                                   {"ellipsoid", "640x360", "2", "290M"}}) {
    const RunResult fits = study(scene, size, views, memory);
    EXPECT_EQ(fits.exit_code, 0) << scene << ' ' << size << ' ' << memory << ": " << fits.err;
    EXPECT_NE(fits.err.find("models left out"), std::string::npos) << scene << ' ' << size << ' ' << memory << ": " << fits.err;
  }
  const RunResult refused = study("ellipsoid", "640x360", "4", "300M");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_EQ(refused.err_lines(), 1) << refused.err;
  EXPECT_NE(refused.err.find("--max-memory: too little for a study (got 300.0 MB, expected more than"), std::string::npos) << refused.err;
  EXPECT_NE(refused.err.find("4 views of 640 x 360 pixels"), std::string::npos) << refused.err;
}

TEST(Limits, ALibraryThatCannotBeLoadedForWantOfMemoryDoesNotAbort) {
  if (!kAddressSpaceCanBeLimited) GTEST_SKIP() << "the sanitizers take memory of their own";
  // From what the call is expected to take on; OpenVDB's libraries make threads while they are loaded.
  for (const char* const memory : {"62M", "66M", "72M"}) {
    const TemporaryFolder folder;
    const RunResult held =
        run_limn({"export", "ellipsoid", "--surface", "level_set", "--voxels", "32", "--max-memory", memory, "-o", folder.file("x.vdb")},
                 folder.path());
    EXPECT_TRUE(held.exit_code >= 0 && held.exit_code <= 2) << memory << ": " << held.exit_code << held.err;
    EXPECT_TRUE(held.exit_code == 0 || held.err.find("--max-memory") != std::string::npos) << memory << held.err;
  }
}

TEST(Limits, MoreTimeThanAllowedIsRefusedBeforehand) {
  const TemporaryFolder folder;
  const RunResult result = run_limn({"render", "gyroid", "--surface", "level_set", "--voxels", "1024", "--size", "64x64", "--max-time",
                                     "500ms", "-o", folder.file("x.png")});
  EXPECT_EQ(result.exit_code, 2) << result.err;
  EXPECT_EQ(result.err_lines(), 1) << result.err;
  EXPECT_TRUE(
      std::regex_search(result.err, std::regex("the call needs about [0-9.]+ m?s; --max-time allows 500 ms; --voxels [0-9]+ needs about")))
      << result.err;
  const RunResult study = run_limn({"study", "ellipsoid", "--views", "200", "--max-time", "20s", "-o", folder.file("study")});
  EXPECT_EQ(study.exit_code, 2) << study.err;
  EXPECT_NE(study.err.find("the study needs about"), std::string::npos) << study.err;
  const RunResult plan = run_limn({"plan", "ellipsoid", "--tolerance", "1", "--size", "4096x4096", "--max-time", "1s"});
  EXPECT_EQ(plan.exit_code, 2) << plan.err;
  EXPECT_NE(plan.err.find("the call needs about"), std::string::npos) << plan.err;
  EXPECT_TRUE(folder.files().empty());
}

TEST(Limits, TimeIsHeldTo) {
  const TemporaryFolder folder;
  const RunResult result = run_limn({"plan", "gyroid", "--tolerance", "0.001", "--size", "320x180", "--max-time", "300ms"}, folder.path());
  EXPECT_EQ(result.exit_code, 1) << result.err;
  EXPECT_EQ(result.err, "limn: --max-time: stopped after 300 ms\n");
  EXPECT_TRUE(result.out.empty());
  EXPECT_TRUE(folder.files().empty());
}

TEST(Limits, SizesAndTimesThatAreNoneAreRefused) {
  for (const Arguments& call : {Arguments{"--max-memory", "much"}, Arguments{"--max-memory", "0"}, Arguments{"--max-time", "5"},
                                Arguments{"--max-time", "-1s"}, Arguments{"--max-time", "1d"}}) {
    const RunResult result = run_limn({"info", "ellipsoid", call[0], call[1]});
    EXPECT_EQ(result.exit_code, 2) << call[1];
    EXPECT_NE(result.err.find(call[0]), std::string::npos) << result.err;
  }
  EXPECT_EQ(run_limn({"info", "ellipsoid", "--max-memory", "1G", "--max-time", "10m"}).exit_code, 0);
}

TEST(Limits, TheSmallestAndTheWidestPictureAreDrawnAndTooManyVoxelsAreNot) {
  const TemporaryFolder folder;
  EXPECT_EQ(run_limn({"render", "ellipsoid", "--size", "1x1", "-q", "-o", folder.file("one.exr")}).exit_code, 0);
  EXPECT_EQ(run_limn({"render", "ellipsoid", "--size", "16384x2", "-q", "-o", folder.file("wide.png")}).exit_code, 0);
  for (const Arguments& wrong : {Arguments{"--voxels", "100000"}, Arguments{"--size", "16385x4"}, Arguments{"--size", "0x4"}}) {
    const RunResult result = run_limn({"render", "ellipsoid", wrong[0], wrong[1], "-o", folder.file("none.png")});
    EXPECT_EQ(result.exit_code, 2) << wrong[1];
    EXPECT_EQ(result.err_lines(), 1) << result.err;
    EXPECT_NE(result.err.find(wrong[0]), std::string::npos) << result.err;
  }
}

TEST(Warnings, OnlyWhatMattersForTheSurfacesAndMethodsAskedForIsSaid) {
  const TemporaryFolder folder;
  const std::string sheet = folder.write("sheet.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  const auto render = [&](const Arguments& more) {
    Arguments call{"render", sheet, "--size", "64x48", "-o", folder.file("x.png")};
    // Where nobody names a method, a sheet is drawn by its lines.
    if (std::find(more.begin(), more.end(), "--method") == more.end()) call.insert(call.end(), {"--method", "rim"});
    call.insert(call.end(), more.begin(), more.end());
    return run_limn(call);
  };
  EXPECT_NE(render({}).err.find("limn: warning: sheet: 4 edges with a face on one side only"), std::string::npos) << render({}).err;
  EXPECT_EQ(render({"--method", "blur"}).err, "") << "it reads no normals";
  EXPECT_EQ(render({"-q"}).err, "");
  const RunResult remedy = render({"-v"});
  EXPECT_NE(remedy.err.find("remedy: close the holes"), std::string::npos) << remedy.err;
  const RunResult json = render({"--json", "-q"});
  ASSERT_EQ(json.json().at("warnings").size(), 1u);
  EXPECT_EQ(json.err, "");
  const RunResult grid = render({"--surface", "mesh_level_set", "--voxels", "32"});
  EXPECT_NE(grid.err.find("limn: warning: "), std::string::npos) << "what building it tells goes the same way: " << grid.err;
  EXPECT_EQ(grid.err.find("on one side only"), std::string::npos) << grid.err;
}

TEST(Warnings, CleanInputGivesNone) {
  const TemporaryFolder folder;
  for (const char* scene : {"ellipsoid", "teacup", "tilted_torus"}) {
    const RunResult result = run_limn({"render", scene, "--size", "64x48", "--json", "-o", folder.file("x.png")});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_TRUE(result.json().at("warnings").empty()) << result.out;
    EXPECT_EQ(result.err.find("warning"), std::string::npos) << result.err;
  }
}

TEST(Info, SaysForWhomAFindingIsAFaultAndWhatHelps) {
  const TemporaryFolder folder;
  const std::string sheet = folder.write("sheet.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  const RunResult json_result = run_limn({"info", sheet, "--json"});
  bool found = false;
  const nlohmann::json document = json_result.json();
  for (const nlohmann::json& finding : document.at("audit")) {
    for (const char* key : {"remedy", "surfaces", "methods"}) EXPECT_TRUE(finding.contains(key)) << key;
    if (finding.at("check") != "open edges") continue;
    found = true;
    EXPECT_EQ(finding.at("surfaces"), nlohmann::json({"mesh"}));
    EXPECT_FALSE(finding.at("methods").empty());
    EXPECT_FALSE(finding.at("remedy").get<std::string>().empty());
  }
  EXPECT_TRUE(found);
  const RunResult text = run_limn({"info", sheet});
  EXPECT_NE(text.out.find("fails: mesh; rim"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("remedy: "), std::string::npos) << text.out;
  // Numbers at the resolution that is asked for.
  EXPECT_NE(run_limn({"info", "gyroid", "--voxels", "32"}).out.find("walls thinner than two voxels (0.125)"), std::string::npos);
}

}  // namespace
}  // namespace limn
