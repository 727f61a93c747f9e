// A volume as the only input: what is known of it, and what its pictures are held against.

#include <gtest/gtest.h>

#include "run_program.h"

namespace limn {
namespace {

using nlohmann::json;

/// An ellipsoid's level set of 24 voxels, written and nothing else.
std::string volume(const TemporaryFolder& folder, const char* half_width) {
  const std::string file = folder.file("ball.vdb");
  const RunResult made =
      run_limn({"export", "ellipsoid", "--surface", "level_set", "--voxels", "24", "--half-width", half_width, "-q", "-o", file});
  EXPECT_EQ(made.exit_code, 0) << made.err;
  return file;
}

TEST(VolumeInput, StandsInForItsTruthWithTheBestGradientOfItsBand) {
  for (const auto& [half_width, gradient] : {std::pair("2", "cell"), {"3", "central"}, {"5", "cubic"}}) {
    const TemporaryFolder folder;
    const RunResult run = run_limn({"study", volume(folder, half_width), "--size", "96x72", "--views", "1", "--surfaces", "level_set", "-q",
                                    "--reference", "smooth", "--json", "-o", folder.file("study")});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const json document = run.json();
    EXPECT_FALSE(document.at("exact").get<bool>());
    EXPECT_NE(document.at("truth").get<std::string>().find(std::string("the volume with the ") + gradient + " gradient"), std::string::npos)
        << document.at("truth");
    // The model that the truth is, is right; no other is.
    std::istringstream rows(read_bytes(folder.file("study/rows.jsonl")));
    int measured = 0;
    for (std::string line; std::getline(rows, line);) {
      const json row = json::parse(line);
      if (row.at("metric") != "normal_error_mean" || row.at("value").is_null()) continue;
      ++measured;
      const bool same = row.at("surface_parameters").dump().find(gradient) != std::string::npos;
      EXPECT_EQ(row.at("value").get<double>() < 1e-3, same) << row;
    }
    EXPECT_EQ(measured, half_width == std::string("2") ? 1 : half_width == std::string("3") ? 2 : 3);
  }
}

TEST(VolumeInput, InfoSaysWhatEachCheckTook) {
  const TemporaryFolder folder;
  const std::string file = volume(folder, "3");
  const RunResult plain = run_limn({"info", file}), verbose = run_limn({"info", "-v", file});
  EXPECT_EQ(verbose.out, plain.out);
  EXPECT_EQ(plain.err.find("checks"), std::string::npos) << plain.err;
  for (const char* check : {"quick checks", "slope", "band", "thin", "flat"})
    EXPECT_NE(verbose.err.find(check), std::string::npos) << verbose.err;
}

TEST(Parameters, AreTrueOrFalse) {
  const TemporaryFolder folder;
  const auto picture = [&](const std::string& name, const std::vector<std::string>& set) {
    std::vector<std::string> call{"render", "rook", "--size", "120x90", "--method", "roberts", "-q", "-o", folder.file(name)};
    call.insert(call.end(), set.begin(), set.end());
    const RunResult run = run_limn(call);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return read_bytes(folder.file(name));
  };
  const std::vector<std::string> depth{"--set", "roberts.depth_weight=1"};
  const auto with = [&](const char* modulation) {
    std::vector<std::string> set = depth;
    set.insert(set.end(), {"--set", std::string("roberts.modulation=") + modulation});
    return set;
  };
  const std::string plain = picture("plain.png", depth);
  EXPECT_EQ(picture("true.png", with("true")), plain);
  EXPECT_NE(picture("false.png", with("false")), plain);
}

}  // namespace
}  // namespace limn
