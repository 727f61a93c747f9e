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

  static void refused(const Words& call, const std::string& hint) {
    const RunResult result = run(call);
    std::string all;
    for (const std::string& word : call) all += word + " ";
    EXPECT_EQ(result.exit_code, 2) << all << ": " << result.err;
    EXPECT_EQ(result.err_lines(), 1) << result.err;
    EXPECT_NE(result.err.find("no effect"), std::string::npos) << all << ": " << result.err;
    EXPECT_NE(result.err.find(hint), std::string::npos) << "wanted '" << hint << "' in: " << result.err;
  }
  static void taken(const Words& call) {
    const RunResult result = run(call);
    std::string all;
    for (const std::string& word : call) all += word + " ";
    EXPECT_EQ(result.exit_code, 0) << all << ": " << result.err;
  }

  static TemporaryFolder* folder_;
};
TemporaryFolder* NoEffect::folder_ = nullptr;

TEST_F(NoEffect, OfARender) {
  refused({"render", "MESH", "--voxels", "32"}, "--voxels: has no effect on a mesh drawn as mesh; add --surface mesh_level_set");
  refused({"render", "MESH", "--voxel-size", "0.1"}, "mesh_level_set");
  refused({"render", "MESH", "--gradient", "cubic"}, "mesh_level_set");
  refused({"render", "MESH", "--half-width", "4"}, "mesh_level_set");
  refused({"render", "ellipsoid", "--level", "2"},
          "--level: has no effect on a formula drawn as analytic; add --surface mesh or mesh_level_set");
  refused({"render", "ellipsoid", "--level", "auto"}, "--surface mesh");
  refused({"render", "ellipsoid", "--voxels", "32"}, "--surface level_set or mesh_level_set");
  refused({"render", "ellipsoid", "--normals", "flat"}, "--surface mesh");
  refused({"render", "ellipsoid", "--scheme", "loop"}, "leave it out");
  refused({"render", "ellipsoid", "--surface", "mesh", "--scheme", "loop"}, "leave it out");
  refused({"render", "VOLUME", "--level", "2"}, "leave it out");
  refused({"render", "VOLUME", "--scheme", "loop"}, "leave it out");
  refused({"render", "VOLUME", "--half-width", "4"}, "half-width");
  refused({"render", "VOLUME", "--normals", "flat"}, "--surface mesh");
  refused({"render", "ellipsoid", "--views", "2", "--eye", "0,0,5"}, "--views 1");
  refused({"render", "ellipsoid", "--tolerance", "2", "--half-width", "4"}, "--half-width");
  refused({"render", "ellipsoid", "--tolerance", "2", "--scheme", "loop"}, "--scheme");
  refused({"render", "ellipsoid", "--tolerance", "2", "--smooth-angle", "10"}, "--smooth-angle");
  refused({"render", "ellipsoid", "--surface", "mesh_level_set", "--voxels", "12", "--normals", "flat"}, "--surface mesh");
}

TEST_F(NoEffect, WhatARenderReadsIsTaken) {
  taken({"render", "MESH", "--level", "0"});
  taken({"render", "MESH", "--level", "1"});
  taken({"render", "MESH", "--scheme", "loop"});
  taken({"render", "MESH", "--normals", "flat"});
  taken({"render", "CAGE", "--level", "auto"});
  taken({"render", "MESH", "--surface", "mesh_level_set", "--voxels", "12", "--half-width", "4", "--gradient", "cell"});
  taken({"render", "ellipsoid", "--surface", "level_set", "--voxel-size", "0.2", "--gradient", "cubic"});
  taken({"render", "VOLUME", "--gradient", "cell"});
  taken({"render", "VOLUME", "--voxels", "12"});
  taken({"render", "VOLUME", "--voxels", "12", "--half-width", "4"});
  taken({"render", "VOLUME", "--surface", "mesh", "--voxels", "12"});
  taken({"render", "SCENE"});
  taken({"render", "ellipsoid", "--views", "2", "--target", "0,0,0", "--up", "0,0,1"});
}

TEST_F(NoEffect, OfACompareAndAStudy) {
  refused({"compare", "MESH", "--surface", "mesh", "--voxels", "12"}, "mesh_level_set");
  refused({"compare", "ellipsoid", "--surface", "level_set", "--level", "1"}, "--surface mesh");
  refused({"compare", "VOLUME", "--scheme", "loop"}, "leave it out");
  taken({"compare", "MESH", "--voxels", "12", "--gradient", "cell", "--surface", "mesh_level_set"});
  refused({"study", "MESH", "--surfaces", "mesh", "--voxels", "8", "--views", "1"}, "mesh_level_set");
  refused({"study", "ellipsoid", "--surfaces", "level_set", "--levels", "1", "--views", "1"}, "--surface mesh");
  refused({"study", "ellipsoid", "--surfaces", "level_set", "--normals", "flat", "--views", "1"}, "--normals");
  refused({"study", "MESH", "--surfaces", "mesh", "--gradients", "cell", "--views", "1"}, "--gradients");
  refused({"study", "ellipsoid", "--eye", "0,0,5", "--views", "2"}, "--views 1");
}

TEST_F(NoEffect, OfAPlan) {
  refused({"plan", "ellipsoid", "--tolerance", "2", "--method", "sobel"}, "--method sobel");
  refused({"plan", "ellipsoid", "--tolerance", "2", "--set", "color=1,0,0"}, "--set color");
  refused({"plan", "ellipsoid", "--tolerance", "2", "--metric", "silhouette", "--set", "threshold=0.2"}, "silhouette");
  refused({"plan", "ellipsoid", "--tolerance", "2", "--half-width", "4"}, "--half-width");
  refused({"plan", "ellipsoid", "--tolerance", "2", "--scheme", "loop"}, "--scheme");
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
  taken({"plan", "ellipsoid", "--tolerance", "4", "--method", "rim", "--set", "threshold=0.2"});
}

TEST_F(NoEffect, OfExportAndInfo) {
  refused({"export", "ellipsoid", "--voxels", "12", "-o", "a.obj"}, "--voxels");
  refused({"export", "ellipsoid", "--level", "1", "-o", "a.vdb"}, "--level");
  refused({"export", "ellipsoid", "--normals", "flat", "-o", "a.vdb"}, "--normals");
  refused({"export", "ellipsoid", "--gradient", "cell", "-o", "a.ply"}, "--gradient");
  taken({"export", "ellipsoid", "--level", "1", "--normals", "flat", "-o", "a.ply"});
  taken({"export", "ellipsoid", "--voxels", "12", "--half-width", "4", "-o", "a.vdb"});
  taken({"export", "ellipsoid", "--surface", "mesh_level_set", "--voxels", "12", "--level", "1", "-o", "a.vdb"});
  taken({"export", "MESH", "--voxels", "12", "-o", "a.vdb"});
  refused({"export", "MESH", "--smooth-angle", "10", "-o", "a.obj"}, "--smooth-angle");
  refused({"export", "MESH", "--normals", "flat", "-o", "a.obj"}, "--normals");
  refused({"export", "ellipsoid", "--surface", "level_set", "--voxels", "12", "--normals", "flat", "-o", "a.obj"}, "--normals");
  refused({"export", "VOLUME", "--gradient", "cubic", "-o", "a.vdb"}, "--gradient");
  taken({"export", "VOLUME", "--voxels", "12", "--gradient", "cubic", "-o", "a.vdb"});
  taken({"export", "CAGE", "--level", "1", "--normals", "flat", "-o", "a.obj"});
  refused({"info", "VOLUME", "--voxels", "12"}, "--voxels");
  refused({"info", "ellipsoid", "--half-width", "4"}, "--half-width");
  refused({"info", "ellipsoid", "--normals", "flat"}, "--normals");
  refused({"info", "ellipsoid", "--gradient", "cell"}, "--gradient");
  refused({"info", "VOLUME", "--level", "1"}, "--level");
  refused({"info", "PICTURE", "--voxels", "12"}, "picture");
  taken({"info", "ellipsoid", "--voxels", "12"});
  taken({"info", "VOLUME", "--gradient", "cell"});
  taken({"info", "MESH", "--level", "1"});
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
