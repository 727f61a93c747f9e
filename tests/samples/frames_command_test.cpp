// limn render --frames: numbered files, and flips counted beside the truth's.

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "raymarch/border.h"
#include "tests/samples/run_program.h"

namespace limn {
namespace {

nlohmann::json flicker_of(const TemporaryFolder& folder, std::vector<std::string> arguments) {
  const std::vector<std::string> common = {"--size", "240x180", "--frames", "6",  "--path-step",
                                           "0.2",    "--json",  "-q",       "-o", folder.file("film.png")};
  arguments.insert(arguments.begin(), "render");
  arguments.insert(arguments.end(), common.begin(), common.end());
  const RunResult run = run_limn(arguments);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  return run.exit_code == 0 ? run.json().at("flicker") : nlohmann::json();
}

TEST(RenderFrames, WritesNumberedFilesAndNothingElse) {
  const TemporaryFolder folder;
  const nlohmann::json flicker = flicker_of(folder, {"ellipsoid"});
  EXPECT_EQ(folder.files(),
            (std::vector<std::string>{"film_f0.png", "film_f1.png", "film_f2.png", "film_f3.png", "film_f4.png", "film_f5.png"}));
  EXPECT_EQ(flicker.at("frames"), 6);
  EXPECT_EQ(flicker.at("per_frame").size(), 6u);
  EXPECT_EQ(flicker.at("per_frame").front().at("flips"), 0);
  // The surface drawn is the reference itself.
  EXPECT_GT(flicker.at("flips"), 0);
  EXPECT_EQ(flicker.at("flips"), flicker.at("reference_flips"));
  EXPECT_EQ(flicker.at("beyond"), 0);
}

TEST(RenderFrames, OfLevelSetsAndMeshesFlipBeyondTheTruthAndWithHysteresisDoNot) {
  for (const std::vector<std::string>& model :
       {std::vector<std::string>{"ellipsoid", "--surface", "level_set", "--voxels", "24", "--gradient", "cell"},
        {"tilted_torus", "--surface", "level_set", "--voxels", "48"},
        {"rook", "--surface", "mesh_level_set", "--voxels", "64"},
        {"rook", "--surface", "mesh", "--level", "2"}}) {
    const TemporaryFolder folder;
    const nlohmann::json plain = flicker_of(folder, model);
    std::vector<std::string> held = model;
    held.insert(held.end(), {"--set", "hysteresis=0.3"});
    const nlohmann::json with = flicker_of(folder, held);
    const std::string where = model[0] + " " + model[2] + ": " + plain.dump() + "\nwith: " + with.dump();
    EXPECT_GT(plain.at("beyond"), 0) << where;
    EXPECT_EQ(with.at("beyond"), 0) << where;
    EXPECT_EQ(plain.at("reference_flips"), with.at("reference_flips")) << where;
  }
}

TEST(RenderFrames, FlipNearTheThresholdOnly) {
  const TemporaryFolder folder;
  const nlohmann::json flicker = flicker_of(folder, {"ellipsoid", "--set", "threshold=0.5"});
  for (const nlohmann::json& frame : flicker.at("per_frame")) {
    if (frame.at("flips") == 0) continue;
    EXPECT_GT(frame.at("n_dot_v")[0], 0.45) << frame.dump();
    EXPECT_LT(frame.at("n_dot_v")[1], 0.55) << frame.dump();
  }
}

TEST(RenderFrames, OfEveryMethodAreCounted) {
  const TemporaryFolder folder;
  // The reference is a mesh too, so that methods that need one can draw it.
  const std::string cube = folder.write("cube.obj",
                                        "v -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 1\nv 1 -1 1\nv -1 1 1\nv 1 1 1\n"
                                        "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n");
  for (const std::string& method : border_methods().names()) {
    const nlohmann::json flicker = flicker_of(folder, {cube, "--level", "2", "--method", method});
    EXPECT_TRUE(flicker.at("flicker").is_number()) << method;
    EXPECT_GE(flicker.at("flips"), flicker.at("beyond")) << method;
  }
}

TEST(RenderFrames, AreCountedWithoutATruthWhereTheMethodCannotDrawIt) {
  const TemporaryFolder folder;
  const nlohmann::json flicker = flicker_of(folder, {"ellipsoid", "--surface", "mesh", "--level", "2", "--method", "edge_quads"});
  EXPECT_GE(flicker.at("flips"), 0);
  EXPECT_TRUE(flicker.at("beyond").is_null());
  EXPECT_TRUE(flicker.at("reference_flips").is_null());
  EXPECT_NE(flicker.at("reference").get<std::string>().find("edge_quads cannot draw"), std::string::npos);
}

TEST(RenderFrames, DependOnTheSeedAndOnNothingElse) {
  const TemporaryFolder folder;
  const nlohmann::json one = flicker_of(folder, {"ellipsoid", "--surface", "level_set", "--voxels", "24", "--threads", "1"});
  const std::string bytes = read_bytes(folder.file("film_f5.png"));
  EXPECT_EQ(flicker_of(folder, {"ellipsoid", "--surface", "level_set", "--voxels", "24", "--threads", "3"}), one);
  EXPECT_EQ(read_bytes(folder.file("film_f5.png")), bytes);
  EXPECT_NE(flicker_of(folder, {"ellipsoid", "--surface", "level_set", "--voxels", "24", "--seed", "2"}).at("per_frame"),
            one.at("per_frame"));
}

TEST(StudyFlicker, OfEveryModelEndsWithHysteresis) {
  const auto flicker_in = [](const char* hysteresis) {
    const TemporaryFolder folder;
    const RunResult run = run_limn({"study", "ellipsoid", "--flicker", "--size", "160x120", "--views", "1", "--levels", "2", "--voxels",
                                    "24", "--set", std::string("hysteresis=") + hysteresis, "-q", "-o", folder.file("study")});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    std::istringstream rows(read_bytes(folder.file("study/rows.jsonl")));
    std::vector<double> values;
    for (std::string line; std::getline(rows, line);) {
      const nlohmann::json row = nlohmann::json::parse(line);
      if (row.at("metric") == "flicker") values.push_back(row.at("value"));
    }
    return values;
  };
  const std::vector<double> plain = flicker_in("0"), held = flicker_in("0.15");
  ASSERT_GT(plain.size(), 4u);
  ASSERT_EQ(plain.size(), held.size());
  EXPECT_GT(*std::max_element(plain.begin(), plain.end()), 0.005);
  EXPECT_EQ(*std::max_element(held.begin(), held.end()), 0.0);
}

TEST(RenderFrames, AreSummedUpInASentence) {
  const TemporaryFolder folder;
  const auto sentence = [&](const char* method) {
    const RunResult run = run_limn({"render", "ellipsoid", "--surface", "mesh", "--level", "2", "--frames", "3", "--size", "64x48",
                                    "--method", method, "-o", folder.file("film.png")});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return run.out + run.err;
  };
  EXPECT_NE(sentence("rim").find("that of the analytic surface itself"), std::string::npos) << sentence("rim");
  EXPECT_NE(sentence("rim").find("over 3 frames"), std::string::npos);
  EXPECT_NE(sentence("edge_quads").find("flicker: ink flipped"), std::string::npos) << sentence("edge_quads");
}

TEST(RenderFrames, RefusesWhatMeansNothing) {
  for (const std::vector<std::string>& wrong : {std::vector<std::string>{"--frames", "0"},
                                                {"--frames", "three"},
                                                {"--frames", "3", "--path-step", "0"},
                                                {"--frames", "3", "--path-step", "1.5"},
                                                {"--path-step", "0.1"},
                                                {"--frames", "3", "--views", "2"},
                                                {"--frames", "3", "--set", "hysteresis=-1"}}) {
    const TemporaryFolder folder;
    std::vector<std::string> call = {"render", "ellipsoid", "--size", "16x16", "-o", folder.file("x.png")};
    call.insert(call.end(), wrong.begin(), wrong.end());
    const RunResult run = run_limn(call);
    EXPECT_EQ(run.exit_code, 2) << wrong[0] << " " << run.err;
    EXPECT_EQ(run.err_lines(), 1) << run.err;
    EXPECT_TRUE(folder.files().empty());
  }
}

}  // namespace
}  // namespace limn
