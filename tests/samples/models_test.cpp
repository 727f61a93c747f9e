// Real files from elsewhere, through the real program: they are hit, and everything written is finite.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "raymarch/image_io.h"
#include "run_program.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

// Renders small, and looks at every layer.
testing::AssertionResult draws_soundly(const std::string& input, const std::vector<std::string>& more = {}) {
  const TemporaryFolder folder;
  const std::string exr = folder.file("a.exr");
  std::vector<std::string> arguments = {"render", input, "--size", "96x72", "--json", "-o", exr};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const RunResult result = run_limn(arguments);
  const auto failure = [&] { return testing::AssertionFailure() << fmt::format("{} {}: ", input, fmt::join(more, " ")); };
  if (result.exit_code != 0) return failure() << "exit code " << result.exit_code << ", " << result.err;
  const auto document = result.json();
  if (!(document.at("hits") > 200)) return failure() << document.at("hits") << " hits, should be more than 200";
  if (!(document.at("misses") > 50)) return failure() << document.at("misses") << " misses, should be framed with some room around it";
  if (document.at("out_of_steps") != 0) return failure() << document.at("out_of_steps") << " rays out of steps";
  const Image<float> id = read_channel(exr, "id.Y"), z = read_channel(exr, "Z"), border = read_channel(exr, "border.Y"),
                     facing = read_channel(exr, "NdotV.Y");
  const auto share = [](float v) { return v >= 0.0f && v <= 1.0f; };
  std::int64_t hits = 0;
  for (size_t i = 0; i < id.size(); ++i) {
    const bool hit = id.pixels[i] > 0.0f;
    hits += hit;
    const bool sound = (hit ? std::isfinite(z.pixels[i]) && z.pixels[i] > 0.0f : std::isinf(z.pixels[i])) && share(border.pixels[i]) &&
                       share(facing.pixels[i]);
    if (!sound)
      return failure() << fmt::format("pixel {}: id {}, Z {}, border {}, NdotV {}", i, id.pixels[i], z.pixels[i], border.pixels[i],
                                      facing.pixels[i]);
  }
  if (hits != document.at("hits")) return failure() << hits << " pixels hit, " << document.at("hits") << " said to be";
  for (const char* channel : {"R", "G", "B", "A", "N.X", "N.Y", "N.Z"}) {
    const Image<float> layer = read_channel(exr, channel);
    if (!std::all_of(layer.pixels.begin(), layer.pixels.end(), [](float v) { return std::isfinite(v); }))
      return failure() << channel << " is not finite everywhere";
  }
  return testing::AssertionSuccess();
}

class Models : public testing::TestWithParam<const char*> {};

TEST_P(Models, AreDrawnAsMeshAndAsLevelSet) {
  const fs::path file = fs::path(LIMN_TEST_DATA) / GetParam();
  EXPECT_TRUE(draws_soundly(file.string()));
  EXPECT_TRUE(draws_soundly(file.string(), {"--surface", "mesh_level_set", "--voxels", "64"}));
}

INSTANTIATE_TEST_SUITE_P(Collection, Models,
                         testing::Values("ogre_controlmesh.obj", "pig_quad_controlmesh.obj", "spot_control_mesh.obj", "spot_damaged.obj"),
                         [](const auto& test) {
                           std::string name = test.param;
                           std::replace_if(
                               name.begin(), name.end(), [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); }, '_');
                           return name;
                         });

TEST(Formats, GltfStlPlyAndOffOfAnotherCollectionAreDrawn) {
  const fs::path models = "/usr/share/assimp/models";
  if (!fs::exists(models)) GTEST_SKIP() << "the package assimp-testmodels is not installed";
  for (const char* name :
       {"glTF2/BoxTextured-glTF-Binary/BoxTextured.glb", "glTF2/BoxTextured-glTF/BoxTextured.gltf", "STL/Spider_ascii.stl",
        "STL/Spider_binary.stl", "PLY/Wuson.ply", "PLY/cube_binary.ply", "OFF/Wuson.off", "OFF/Cube.off"}) {
    ASSERT_TRUE(fs::exists(models / name)) << name;
    EXPECT_TRUE(draws_soundly((models / name).string()));
  }
}

TEST(Formats, AVolumeWrittenByAnotherToolIsDrawn) {
  const TemporaryFolder folder;
  const std::string volume = folder.file("sphere.vdb");
  if (std::system("command -v vdb_tool > /dev/null 2>&1") != 0) GTEST_SKIP() << "vdb_tool is not installed";
  ASSERT_EQ(std::system(("vdb_tool -quiet -sphere dim=64 radius=1.5 center='(1,2,3)' -write " + volume + " > /dev/null 2>&1").c_str()), 0);
  EXPECT_TRUE(draws_soundly(volume));
  const auto bounds = run_limn({"info", volume, "--json"}).json().at("bounds");
  EXPECT_NEAR(bounds.at("upper").at(0).get<double>(), 2.5, 0.1);
  EXPECT_NEAR(bounds.at("lower").at(2).get<double>(), 1.5, 0.1);
}

TEST(Formats, WhatExportWritesIsReadBackAsTheSameSurface) {
  const TemporaryFolder folder;
  for (const std::string name : {"a.obj", "a.ply", "a.vdb"}) {
    const RunResult result = run_limn(
        {"export", "ellipsoid", name == "a.vdb" ? "--voxels" : "--level", name == "a.vdb" ? "48" : "2", "-o", folder.file(name), "--json"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const auto original = run_limn({"info", "ellipsoid", "--json"}).json().at("bounds");
    const auto exported = run_limn({"info", folder.file(name), "--json"}).json().at("bounds");
    for (const char* side : {"lower", "upper"}) {
      // A field's own bounds may be loose, so the exported surface lies inside them, and fills most of them.
      for (size_t axis = 0; axis < 3; ++axis) {
        const double outer = std::abs(original.at(side).at(axis).get<double>()), inner = std::abs(exported.at(side).at(axis).get<double>());
        EXPECT_LE(inner, outer + 0.1) << name << side << axis;
        EXPECT_GE(inner, 0.5 * outer) << name << side << axis;
      }
    }
    EXPECT_TRUE(draws_soundly(folder.file(name)));
  }
}

TEST(Formats, AnExportedCageIsNoCageAnyMore) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_limn({"export", "rook", "--level", "1", "-o", folder.file("a.obj"), "-q"}).exit_code, 0);
  const auto document = run_limn({"info", folder.file("a.obj"), "--json"}).json();
  EXPECT_EQ(document.at("counts").at("creases"), 0);
  EXPECT_EQ(document.at("objects").at(0).at("kind"), "mesh");
}

TEST(Scenes, TheExampleFilesAreDrawn) {
  EXPECT_TRUE(draws_soundly(LIMN_SOURCE_DIR "/samples/scenes/still_life.toml"));
  EXPECT_TRUE(draws_soundly(LIMN_SOURCE_DIR "/samples/scenes/two_metals.toml"));
}

TEST(Scenes, EveryBuiltInOneIsDrawn) {
  for (const auto& scene : run_limn({"list", "scenes", "--json"}).json()) EXPECT_TRUE(draws_soundly(scene.at("name")));
}

}  // namespace
}  // namespace limn
