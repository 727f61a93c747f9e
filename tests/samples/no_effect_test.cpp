// Options that would change nothing are refused, with what would make them matter; those that matter are taken.

#include <gtest/gtest.h>

#include <iterator>
#include <sstream>

#include "run_program.h"

namespace limn {
namespace {

constexpr const char* kTetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

using Words = std::vector<std::string>;

/// "MESH", "VOLUME", "CAGE" and "PICTURE" stand for files; what is written goes into the folder.
class NoEffect : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    folder_->write("mesh.obj", kTetrahedron);
    folder_->write("cage.obj", std::string(kTetrahedron) + "t crease 2/1/0 0 1 3.0\n");
    folder_->write("soft.toml",
                   "[surface]\nvoxels = 64\nlevel = 2\ngradient = \"cubic\"\nnormals = \"flat\"\n[[object]]\nshape = \"sphere\"\n");
    ASSERT_EQ(run_limn({"export", "ellipsoid", "--voxels", "16", "-o", folder_->file("volume.vdb"), "-q"}).exit_code, 0);
    ASSERT_EQ(run_limn({"render", "ellipsoid", "--size", "8x6", "-o", folder_->file("picture.exr"), "-q"}).exit_code, 0);
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }

  static RunResult run(Words call) {
    for (std::string& word : call) {
      if (word == "MESH") word = folder_->file("mesh.obj");
      if (word == "CAGE") word = folder_->file("cage.obj");
      if (word == "VOLUME") word = folder_->file("volume.vdb");
      if (word == "PICTURE") word = folder_->file("picture.exr");
      if (word == "SCENE") word = folder_->file("soft.toml");
    }
    const bool pictures = call[0] == "render" || call[0] == "compare" || call[0] == "plan" || call[0] == "study";
    if (pictures) call.insert(call.end(), {"--size", "16x12"});
    const TemporaryFolder out;
    const RunResult result = run_limn(call, out.path());
    if (result.exit_code == 2) {
      EXPECT_TRUE(out.files().empty()) << "something was written";
    }
    return result;
  }

  static std::string text_of(const Words& call, const RunResult& result) {
    std::string all;
    for (const std::string& word : call) all += word + " ";
    return all + "ended with " + std::to_string(result.exit_code) + ": " + result.err;
  }
  static testing::AssertionResult is_refused(const Words& call, const std::string& hint) {
    const RunResult result = run(call);
    const bool says = result.err.find("no effect") != std::string::npos && result.err.find(hint) != std::string::npos;
    if (result.exit_code == 2 && result.err_lines() == 1 && says) return testing::AssertionSuccess();
    return testing::AssertionFailure() << "wanted '" << hint << "': " << text_of(call, result);
  }
  static testing::AssertionResult is_taken(const Words& call) {
    const RunResult result = run(call);
    if (result.exit_code == 0) return testing::AssertionSuccess();
    return testing::AssertionFailure() << text_of(call, result);
  }

  static TemporaryFolder* folder_;
};
TemporaryFolder* NoEffect::folder_ = nullptr;

TEST_F(NoEffect, OfARender) {
  EXPECT_TRUE(is_refused(Words{"render", "MESH", "--voxels", "32"},
                         "--voxels: has no effect on a mesh drawn as mesh; add --surface mesh_level_set"));
  EXPECT_TRUE(is_refused(Words{"render", "MESH", "--voxel-size", "0.1"}, "mesh_level_set"));
  EXPECT_TRUE(is_refused(Words{"render", "MESH", "--gradient", "cubic"}, "mesh_level_set"));
  EXPECT_TRUE(is_refused(Words{"render", "MESH", "--half-width", "4"}, "mesh_level_set"));
  EXPECT_TRUE(is_refused(Words{"render", "ellipsoid", "--level", "2"},
                         "--level: has no effect on a formula drawn as analytic; add --surface mesh or mesh_level_set"));
  EXPECT_TRUE(is_refused({"render", "ellipsoid", "--level", "auto"}, "--surface mesh"));
  EXPECT_TRUE(is_refused(Words{"render", "ellipsoid", "--voxels", "32"}, "--surface level_set or mesh_level_set"));
  EXPECT_TRUE(is_refused(Words{"render", "ellipsoid", "--normals", "flat"}, "--surface mesh"));
  EXPECT_TRUE(is_refused(Words{"render", "ellipsoid", "--scheme", "loop"}, "leave it out"));
  EXPECT_TRUE(is_refused(Words{"render", "ellipsoid", "--surface", "mesh", "--scheme", "loop"}, "leave it out"));
  EXPECT_TRUE(is_refused(Words{"render", "VOLUME", "--level", "2"}, "leave it out"));
  EXPECT_TRUE(is_refused(Words{"render", "VOLUME", "--scheme", "loop"}, "leave it out"));
  EXPECT_TRUE(is_refused(Words{"render", "VOLUME", "--half-width", "4"}, "half-width"));
  EXPECT_TRUE(is_refused(Words{"render", "VOLUME", "--normals", "flat"}, "--surface mesh"));
  EXPECT_TRUE(is_refused(Words{"render", "ellipsoid", "--views", "2", "--eye", "0,0,5"}, "--views 1"));
  EXPECT_TRUE(is_refused(Words{"render", "ellipsoid", "--tolerance", "2", "--half-width", "4"}, "--half-width"));
  EXPECT_TRUE(is_refused(Words{"render", "ellipsoid", "--tolerance", "2", "--scheme", "loop"}, "--scheme"));
  EXPECT_TRUE(is_refused(Words{"render", "ellipsoid", "--tolerance", "2", "--smooth-angle", "10"}, "--smooth-angle"));
  EXPECT_TRUE(
      is_refused(Words{"render", "ellipsoid", "--surface", "mesh_level_set", "--voxels", "12", "--normals", "flat"}, "--surface mesh"));
}

TEST_F(NoEffect, WhatARenderReadsIsTaken) {
  EXPECT_TRUE(is_taken(Words{"render", "MESH", "--level", "0"}));
  EXPECT_TRUE(is_taken(Words{"render", "MESH", "--level", "1"}));
  EXPECT_TRUE(is_taken(Words{"render", "MESH", "--scheme", "loop"}));
  EXPECT_TRUE(is_taken(Words{"render", "MESH", "--normals", "flat"}));
  EXPECT_TRUE(is_taken(Words{"render", "CAGE", "--level", "auto"}));
  EXPECT_TRUE(
      is_taken(Words{"render", "MESH", "--surface", "mesh_level_set", "--voxels", "12", "--half-width", "4", "--gradient", "cell"}));
  EXPECT_TRUE(is_taken(Words{"render", "ellipsoid", "--surface", "level_set", "--voxel-size", "0.2", "--gradient", "cubic"}));
  EXPECT_TRUE(is_taken(Words{"render", "VOLUME", "--gradient", "cell"}));
  EXPECT_TRUE(is_taken(Words{"render", "VOLUME", "--voxels", "12"}));
  EXPECT_TRUE(is_taken(Words{"render", "VOLUME", "--voxels", "12", "--half-width", "4"}));
  EXPECT_TRUE(is_taken(Words{"render", "VOLUME", "--surface", "mesh", "--voxels", "12"}));
  EXPECT_TRUE(is_taken(Words{"render", "SCENE"}));
  EXPECT_TRUE(is_taken(Words{"render", "ellipsoid", "--views", "2", "--target", "0,0,0", "--up", "0,0,1"}));
}

TEST_F(NoEffect, OfACompareAndAStudy) {
  EXPECT_TRUE(is_refused(Words{"compare", "MESH", "--surface", "mesh", "--voxels", "12"}, "mesh_level_set"));
  EXPECT_TRUE(is_refused(Words{"compare", "ellipsoid", "--surface", "level_set", "--level", "1"}, "--surface mesh"));
  EXPECT_TRUE(is_refused(Words{"compare", "VOLUME", "--scheme", "loop"}, "leave it out"));
  EXPECT_TRUE(is_taken(Words{"compare", "MESH", "--voxels", "12", "--gradient", "cell", "--surface", "mesh_level_set"}));
  EXPECT_TRUE(is_refused(Words{"study", "MESH", "--surfaces", "mesh", "--voxels", "8", "--views", "1"}, "mesh_level_set"));
  EXPECT_TRUE(is_refused(Words{"study", "ellipsoid", "--surfaces", "level_set", "--levels", "1", "--views", "1"}, "--surface mesh"));
  EXPECT_TRUE(is_refused(Words{"study", "ellipsoid", "--surfaces", "level_set", "--normals", "flat", "--views", "1"}, "--normals"));
  EXPECT_TRUE(is_refused(Words{"study", "MESH", "--surfaces", "mesh", "--gradients", "cell", "--views", "1"}, "--gradients"));
  EXPECT_TRUE(is_refused(Words{"study", "ellipsoid", "--eye", "0,0,5", "--views", "2"}, "--views 1"));
}

TEST_F(NoEffect, OfAPlan) {
  EXPECT_TRUE(is_refused(Words{"plan", "ellipsoid", "--tolerance", "2", "--method", "sobel"}, "--method sobel"));
  EXPECT_TRUE(is_refused(Words{"plan", "ellipsoid", "--tolerance", "2", "--set", "color=1,0,0"}, "--set color"));
  EXPECT_TRUE(is_refused(Words{"plan", "ellipsoid", "--tolerance", "2", "--metric", "silhouette", "--set", "threshold=0.2"}, "silhouette"));
  EXPECT_TRUE(is_refused(Words{"plan", "ellipsoid", "--tolerance", "2", "--half-width", "4"}, "--half-width"));
  EXPECT_TRUE(is_refused(Words{"plan", "ellipsoid", "--tolerance", "2", "--scheme", "loop"}, "--scheme"));
  for (const char* option : {"--samples", "--background"}) {
    const RunResult result = run({"plan", "ellipsoid", "--tolerance", "2", option, "1"});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_NE(result.err.find("unknown option"), std::string::npos) << result.err;
  }
  for (const char* option : {"--metric", "--budget"}) {
    const RunResult result = run({"render", "ellipsoid", option, option == std::string("--metric") ? "border" : "1G"});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_NE(result.err.find("--tolerance"), std::string::npos) << result.err;
  }
  EXPECT_TRUE(is_taken(Words{"plan", "ellipsoid", "--tolerance", "4", "--method", "rim", "--set", "threshold=0.2"}));
}

TEST_F(NoEffect, OfExportAndInfo) {
  EXPECT_TRUE(is_refused(Words{"export", "ellipsoid", "--voxels", "12", "-o", "a.obj"}, "--voxels"));
  EXPECT_TRUE(is_refused(Words{"export", "ellipsoid", "--level", "1", "-o", "a.vdb"}, "--level"));
  EXPECT_TRUE(is_refused(Words{"export", "ellipsoid", "--normals", "flat", "-o", "a.vdb"}, "--normals"));
  EXPECT_TRUE(is_refused(Words{"export", "ellipsoid", "--gradient", "cell", "-o", "a.ply"}, "--gradient"));
  EXPECT_TRUE(is_taken(Words{"export", "ellipsoid", "--level", "1", "--normals", "flat", "-o", "a.ply"}));
  EXPECT_TRUE(is_taken(Words{"export", "ellipsoid", "--voxels", "12", "--half-width", "4", "-o", "a.vdb"}));
  EXPECT_TRUE(is_taken(Words{"export", "ellipsoid", "--surface", "mesh_level_set", "--voxels", "12", "--level", "1", "-o", "a.vdb"}));
  EXPECT_TRUE(is_taken(Words{"export", "MESH", "--voxels", "12", "-o", "a.vdb"}));
  EXPECT_TRUE(is_refused(Words{"export", "MESH", "--smooth-angle", "10", "-o", "a.obj"}, "--smooth-angle"));
  EXPECT_TRUE(is_refused(Words{"export", "MESH", "--normals", "flat", "-o", "a.obj"}, "--normals"));
  EXPECT_TRUE(is_refused(Words{"export", "ellipsoid", "--surface", "level_set", "--voxels", "12", "--normals", "flat", "-o", "a.obj"},
                         "--normals"));
  EXPECT_TRUE(is_refused(Words{"export", "VOLUME", "--gradient", "cubic", "-o", "a.vdb"}, "--gradient"));
  EXPECT_TRUE(is_taken(Words{"export", "VOLUME", "--voxels", "12", "--gradient", "cubic", "-o", "a.vdb"}));
  EXPECT_TRUE(is_taken(Words{"export", "CAGE", "--level", "1", "--normals", "flat", "-o", "a.obj"}));
  EXPECT_TRUE(is_refused(Words{"info", "VOLUME", "--voxels", "12"}, "--voxels"));
  EXPECT_TRUE(is_refused(Words{"info", "ellipsoid", "--half-width", "4"}, "--half-width"));
  EXPECT_TRUE(is_refused(Words{"info", "ellipsoid", "--normals", "flat"}, "--normals"));
  EXPECT_TRUE(is_refused(Words{"info", "ellipsoid", "--gradient", "cell"}, "--gradient"));
  EXPECT_TRUE(is_refused(Words{"info", "VOLUME", "--level", "1"}, "--level"));
  EXPECT_TRUE(is_refused(Words{"info", "PICTURE", "--voxels", "12"}, "picture"));
  EXPECT_TRUE(is_taken(Words{"info", "ellipsoid", "--voxels", "12"}));
  EXPECT_TRUE(is_taken(Words{"info", "VOLUME", "--gradient", "cell"}));
  EXPECT_TRUE(is_taken(Words{"info", "MESH", "--level", "1"}));
}

TEST_F(NoEffect, ARepresentationThatCannotBeMadeIsWhatIsNamed) {
  for (const Words& call :
       {Words{"render", "VOLUME", "--surface", "analytic", "--voxels", "12"},
        Words{"render", "MESH", "--surface", "analytic", "--level", "1"}, Words{"export", "MESH", "--surface", "mesh", "-o", "a.vdb"}}) {
    const RunResult result = run(call);
    EXPECT_EQ(result.exit_code, 2) << result.err;
    EXPECT_NE(result.err.find(call[3]), std::string::npos) << result.err;
    EXPECT_EQ(result.err.find("no effect"), std::string::npos) << result.err;
  }
}

TEST_F(NoEffect, PathsThatLookLikeSettingsStayAsTheyAre) {
  const TemporaryFolder out;
  const std::string picture = out.file("level = 3.png");
  const RunResult json = run_limn({"render", "ellipsoid", "--size", "16x12", "-o", picture, "--json"});
  ASSERT_EQ(json.exit_code, 0) << json.err;
  EXPECT_EQ(json.json()["files"][0], picture);
  EXPECT_NE(run_limn({"render", "ellipsoid", "--size", "16x12", "-o", picture}).out.find(picture), std::string::npos);
}

TEST_F(NoEffect, ARenderWithoutAPlanSaysSoInJson) {
  const RunResult result = run({"render", "gyroid", "--tolerance", "0.0001", "--budget", "1M", "--json"});
  EXPECT_EQ(result.exit_code, 1) << result.err;
  EXPECT_TRUE(result.json()["plan"]["chosen"].is_null()) << result.out;
}

/// The call with nothing left open, as --verbose prints it.
std::string resolved_in(const RunResult& result, const std::string& command) {
  std::istringstream lines(result.err);
  for (std::string line; std::getline(lines, line);) {
    const size_t at = line.find("limn " + command + " ");
    if (at != std::string::npos) return line.substr(at + 5);
  }
  return {};
}

TEST_F(NoEffect, TheResolvedCallIsTakenAndDrawsTheSame) {
  for (const std::string input : {"ellipsoid", "MESH", "CAGE", "VOLUME"}) {
    for (const std::string surface : {"", "mesh", "mesh_level_set"}) {
      Words call{"render", input};
      if (!surface.empty()) call.insert(call.end(), {"--surface", surface});
      Words first = call;
      const TemporaryFolder out;
      const std::string picture = out.file("first.png"), again = out.file("again.png");
      first.insert(first.end(), {"-o", picture, "-v"});
      const RunResult drawn = run(first);
      if (drawn.exit_code == 2) continue;  // a volume is no mesh to make a level set of
      std::istringstream words(resolved_in(drawn, "render"));
      Words resolved((std::istream_iterator<std::string>(words)), std::istream_iterator<std::string>());
      ASSERT_GT(resolved.size(), 5u) << drawn.err;
      resolved.insert(resolved.end(), {"-o", again});
      const RunResult second = run_limn(resolved);
      EXPECT_EQ(second.exit_code, 0) << input << " " << surface << ": " << second.err;
      EXPECT_EQ(read_bytes(picture), read_bytes(again)) << input << " " << surface;
    }
  }
}

}  // namespace
}  // namespace limn
