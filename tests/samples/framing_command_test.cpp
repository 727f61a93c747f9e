// Pictures of inputs without a camera, by their pixels: framed to 86 %, centred; cameras given back; turntables; grounds and looks.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>

#include "raymarch/image_io.h"
#include "raymarch/look.h"
#include "tests/samples/run_program.h"

namespace limn {
namespace {

using Json = nlohmann::json;

/// Where a picture's alpha is not 0, in pixels: one past the last on the right and below.
struct Covered {
  int left = 1 << 20, right = 0, top = 1 << 20, bottom = 0;
};

Covered covered(const std::string& file) {
  const Image<float> alpha = read_channel(file, "A");
  Covered c;
  for (int y = 0; y < alpha.height; ++y) {
    for (int x = 0; x < alpha.width; ++x) {
      if (alpha.at(x, y) <= 0.0f) continue;
      c.left = std::min(c.left, x);
      c.right = std::max(c.right, x + 1);
      c.top = std::min(c.top, y);
      c.bottom = std::max(c.bottom, y + 1);
    }
  }
  return c;
}

testing::AssertionResult is_framed(const std::string& file, int width, int height) {
  const Covered c = covered(file);
  const double share = std::max(double(c.right - c.left) / width, double(c.bottom - c.top) / height);
  const int aside = std::abs(c.left + c.right - width), above = std::abs(c.top + c.bottom - height);
  const bool framed = std::abs(share - 0.86) <= 0.02 * 0.86 && aside <= 4 && above <= 4;
  return (framed ? testing::AssertionSuccess() : testing::AssertionFailure())
         << "it fills " << share << ", and its margins differ by " << aside << " and " << above << " pixels";
}

void run_well(const std::vector<std::string>& arguments) {
  const RunResult run = run_limn(arguments);
  ASSERT_EQ(run.exit_code, 0) << run.err;
}

/// Built-in surfaces as files, without a camera.
std::vector<std::string> foreign_inputs(const TemporaryFolder& folder) {
  std::vector<std::string> files;
  for (const std::vector<std::string>& made : {std::vector<std::string>{"rook", "rook.obj"},
                                               {"teacup", "teacup.obj", "--level", "3"},
                                               {"tilted_torus", "torus.ply", "--surface", "mesh", "--level", "4"},
                                               {"machined_part", "part.obj", "--surface", "mesh", "--level", "4"},
                                               {"gyroid", "gyroid.vdb", "--voxels", "96"},
                                               {"ellipsoid", "egg.vdb", "--voxels", "64"}}) {
    files.push_back(folder.file(made[1]));
    std::vector<std::string> call = {"export", made[0], "-q", "-o", files.back()};
    call.insert(call.end(), made.begin() + 2, made.end());
    run_well(call);
  }
  return files;
}

TEST(Framing, FilesFill86PercentOfTheTighterSideAndAreCentred) {
  const TemporaryFolder folder;
  for (const std::string& input : foreign_inputs(folder)) {
    for (const auto& [width, height] : {std::pair(640, 360), std::pair(300, 500)}) {
      const std::string out = folder.file("out.png");
      run_well({"render", input, "-q", "--transparent", "--samples", "1", "--method", "rim", "--size",
                std::to_string(width) + "x" + std::to_string(height), "-o", out});
      EXPECT_TRUE(is_framed(out, width, height)) << input;
    }
    run_well({"render", input, "-q", "--transparent", "--samples", "1", "--method", "rim", "--size", "400x300", "--views", "3", "--up", "z",
              "-o", folder.file("view.png")});
    for (const char* const view : {"view_v0.png", "view_v1.png", "view_v2.png"})
      EXPECT_TRUE(is_framed(folder.file(view), 400, 300)) << input << " " << view;
  }
}

TEST(Framing, CameraOfJsonGivenBackDrawsTheSamePicture) {
  const TemporaryFolder folder;
  const std::string input = folder.file("rook.obj"), first = folder.file("a.png"), second = folder.file("b.png"),
                    third = folder.file("c.png");
  run_well({"export", "rook", "-q", "-o", input});
  const RunResult run = run_limn({"render", input, "-q", "--json", "--size", "320x200", "--azimuth", "120", "--elevation", "-20", "--roll",
                                  "15", "--zoom", "1.2", "--samples", "1", "-o", first});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json camera = run.json().at("cameras").at(0);
  EXPECT_NEAR(camera.at("angles").at("azimuth").get<double>(), 120.0, 1e-9);
  EXPECT_NEAR(camera.at("angles").at("elevation").get<double>(), -20.0, 1e-9);
  EXPECT_NEAR(camera.at("angles").at("roll").get<double>(), 15.0, 1e-9);
  const auto vector = [&](const char* key) {
    const Json& v = camera.at(key);
    return v.at(0).dump() + "," + v.at(1).dump() + "," + v.at(2).dump();
  };
  run_well({"render", input, "-q", "--size", "320x200", "--eye", vector("eye"), "--target", vector("target"), "--up", vector("up"), "--fov",
            camera.at("fov").dump(), "--samples", "1", "-o", second});
  const Image<float> a = read_channel(first, "R"), b = read_channel(second, "R");
  size_t differ = 0;
  for (size_t i = 0; i < a.size(); ++i) differ += a.pixels[i] != b.pixels[i] ? 1 : 0;
  // The camera's axes are rounded once more: a ray on an edge may fall on its other side.
  EXPECT_LE(differ, a.size() / 2000);
  // The angles alone are framed anew, with the same result where nothing else is asked for.
  run_well({"render", input, "-q", "--size", "320x200", "--azimuth", "120", "--elevation", "-20", "--roll", "15", "--zoom", "1.2",
            "--samples", "1", "-o", third});
  EXPECT_EQ(read_bytes(first), read_bytes(third));
}

TEST(Framing, OptionsThatContradictOrAreOutOfRangeAreRefused) {
  for (const std::vector<std::string>& wrong : {std::vector<std::string>{"--azimuth", "1", "--eye", "1,2,3"},
                                                {"--elevation", "91"},
                                                {"--zoom", "0"},
                                                {"--margin", "0.5"},
                                                {"--up", "w"},
                                                {"--turntable", "1"},
                                                {"--turntable", "4", "--views", "2"},
                                                {"--animate"},
                                                {"--transparent", "--background", "white"},
                                                {"--look", "tone"},
                                                {"--shading", "fla"}}) {
    const TemporaryFolder folder;
    std::vector<std::string> call = {"render", "ellipsoid", "-q", "--size", "40x30", "-o", folder.file("x.png")};
    call.insert(call.end(), wrong.begin(), wrong.end());
    const RunResult run = run_limn(call);
    EXPECT_EQ(run.exit_code, 2) << wrong[0] << run.err;
    EXPECT_EQ(run.err_lines(), 1) << run.err;
    EXPECT_TRUE(folder.files().empty());
  }
}

TEST(Turntable, WritesNumberedFilesAndOnePictureThatPlaysThem) {
  const TemporaryFolder folder;
  run_well({"render", "rook", "-q", "--size", "80x60", "--samples", "1", "--turntable", "5", "--fps", "10", "-o", folder.file("t.png"),
            "-o", folder.file("t.apng")});
  EXPECT_EQ(folder.files(), (std::vector<std::string>{"t.apng", "t_f0.png", "t_f1.png", "t_f2.png", "t_f3.png", "t_f4.png"}));
  const std::string bytes = read_bytes(folder.file("t.apng"));
  const auto count = [&](const std::string& name) {
    size_t found = 0;
    for (size_t at = bytes.find(name); at != std::string::npos; at = bytes.find(name, at + 1)) ++found;
    return found;
  };
  EXPECT_EQ(count("acTL"), 1u);
  EXPECT_EQ(count("fcTL"), 5u);
  EXPECT_GE(count("fdAT"), 4u);
  // A program that knows no APNG shows the first frame.
  std::filesystem::copy_file(folder.file("t.apng"), folder.file("still.png"));
  EXPECT_EQ(read_channel(folder.file("still.png"), "G").pixels, read_channel(folder.file("t_f0.png"), "G").pixels);
  // After half of an even turn the other side is seen.
  EXPECT_NE(read_bytes(folder.file("t_f0.png")), read_bytes(folder.file("t_f2.png")));
}

TEST(RenderDefaults, AreEightSamplesOnWhite) {
  const TemporaryFolder folder;
  const std::vector<std::string> call = {"render", "ellipsoid", "-q", "--size", "120x90", "-o", folder.file("plain.png")};
  const auto with = [&](const std::string& out, const std::vector<std::string>& more) {
    std::vector<std::string> all = call;
    all.back() = folder.file(out);
    all.insert(all.end(), more.begin(), more.end());
    run_well(all);
    return read_bytes(folder.file(out));
  };
  const std::string plain = with("plain.png", {});
  EXPECT_EQ(plain, with("said.png", {"--samples", "8", "--background", "white"}));
  EXPECT_NE(plain, with("one.png", {"--samples", "1"}));
  with("clear.png", {"--transparent"});
  const Image<float> opaque = read_channel(folder.file("plain.png"), "A"), clear = read_channel(folder.file("clear.png"), "A");
  EXPECT_EQ(*std::min_element(opaque.pixels.begin(), opaque.pixels.end()), 1.0f);
  EXPECT_EQ(clear.at(0, 0), 0.0f);
  EXPECT_EQ(read_channel(folder.file("plain.png"), "R").at(0, 0), 1.0f);
  // Layers keep their alpha, whether a picture is written beside them or not.
  with("layers.exr", {"-o", folder.file("beside.png")});
  EXPECT_EQ(read_channel(folder.file("layers.exr"), "A").at(0, 0), 0.0f);
  EXPECT_EQ(read_bytes(folder.file("beside.png")), plain);
}

TEST(RenderDefaults, InkOnlyIsTheInkWithItsCoverageAsAlpha) {
  const TemporaryFolder folder;
  run_well({"render", "teacup", "-q", "--size", "160x120", "--ink-only", "-o", folder.file("ink.exr"), "-o", folder.file("ink.png")});
  const Image<float> alpha = read_channel(folder.file("ink.exr"), "A"), ink = read_channel(folder.file("ink.exr"), "border.Y");
  EXPECT_GT(*std::max_element(ink.pixels.begin(), ink.pixels.end()), 0.9f);
  for (size_t i = 0; i < alpha.size(); ++i) EXPECT_NEAR(alpha.pixels[i], ink.pixels[i], 1e-3f);
  const Image<float> seen = read_channel(folder.file("ink.png"), "A");
  for (size_t i = 0; i < alpha.size(); ++i) EXPECT_NEAR(alpha.pixels[i], seen.pixels[i], 3e-3f);
}

TEST(RenderLooks, AllDrawAndHaveTheirGround) {
  const TemporaryFolder folder;
  for (const Look& look : looks()) {
    const std::string out = folder.file(look.about.name + ".png");
    run_well({"render", "rook", "-q", "--size", "160x120", "--look", look.about.name, "-o", out});
    const Image<float> red = read_channel(out, "R");
    EXPECT_NEAR(red.at(0, 0), srgb_from_linear(look.ground.r), 3e-3f) << look.about.name;
    EXPECT_LT(*std::min_element(red.pixels.begin(), red.pixels.end()), red.at(0, 0) - 0.1f) << look.about.name;
  }
  // What somebody names stays.
  run_well({"render", "rook", "-q", "--size", "160x120", "--look", "clay", "--method", "rim", "--background", "black", "-o",
            folder.file("x.png")});
  EXPECT_EQ(read_channel(folder.file("x.png"), "R").at(0, 0), 0.0f);
}

TEST(RenderDefaults, FlatInputsAreDrawnByTheirLines) {
  const TemporaryFolder folder;
  const std::string box = folder.file("box.toml"), egg = folder.file("egg.toml");
  std::ofstream(box) << "[[object]]\nshape = \"box\"\n";
  std::ofstream(egg) << "[[object]]\nshape = \"ellipsoid\"\n";
  const auto err_of = [&](const std::string& input, const std::vector<std::string>& more) {
    std::vector<std::string> call = {"render", input, "--size", "80x60", "-o", folder.file("out.png")};
    call.insert(call.end(), more.begin(), more.end());
    const RunResult run = run_limn(call);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return run.err;
  };
  EXPECT_NE(err_of(box, {}).find("drawn by its lines"), std::string::npos);
  EXPECT_EQ(err_of(box, {"--method", "rim"}).find("drawn by its lines"), std::string::npos);
  EXPECT_EQ(err_of(egg, {}).find("drawn by its lines"), std::string::npos);
}

TEST(Mattes, AreInTheFileWithTheirManifest) {
  const TemporaryFolder folder;
  run_well({"render", "passing_tori", "-q", "--size", "80x60", "-o", folder.file("m.exr")});
  const std::vector<std::string> names = channel_names(folder.file("m.exr"));
  for (const char* const name : {"CryptoObject00.R", "CryptoObject00.A", "CryptoMaterial00.R", "Z", "N.X", "P.Z", "border.Y", "albedo.R"})
    EXPECT_NE(std::find(names.begin(), names.end(), name), names.end()) << name;
  const Image<float> share = read_channel(folder.file("m.exr"), "CryptoObject00.G"),
                     rest = read_channel(folder.file("m.exr"), "CryptoObject00.A"), alpha = read_channel(folder.file("m.exr"), "A");
  for (size_t i = 0; i < alpha.size(); ++i) EXPECT_NEAR(share.pixels[i] + rest.pixels[i], alpha.pixels[i], 2e-3f);
}

}  // namespace
}  // namespace limn
