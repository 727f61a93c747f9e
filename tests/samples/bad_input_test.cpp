// Whatever is wrong with an input: exit code 2, one line that says what would be right, no output file, existing ones untouched.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>

#include "run_program.h"

namespace limn {
namespace {

constexpr const char* kCube =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
    "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

void expect_refused(const RunResult& result, const std::string& hint) {
  EXPECT_EQ(result.exit_code, 2) << result.err;
  EXPECT_EQ(result.err_lines(), 1) << result.err;
  EXPECT_TRUE(result.out.empty()) << result.out;
  EXPECT_NE(result.err.find(hint), std::string::npos) << "wanted '" << hint << "' in: " << result.err;
}

struct BadFile {
  const char* name;  ///< Of the test.
  const char* file;  ///< Written with `content`.
  std::string content;
  std::string hint;  ///< Must stand in the message.
};

class BadFiles : public testing::TestWithParam<BadFile> {};

TEST_P(BadFiles, AreRefusedInOneLineAndNothingIsWritten) {
  const TemporaryFolder folder;
  const std::string input = folder.write(GetParam().file, GetParam().content);
  folder.write("kept.png", "old picture");
  const auto before = folder.files();
  expect_refused(run_limn({"render", input, "--size", "32x24", "-o", folder.file("kept.png")}, folder.path()), GetParam().hint);
  expect_refused(run_limn({"compare", input, "--size", "32x24", "--voxels", "16"}, folder.path()), GetParam().hint);
  expect_refused(run_limn({"export", input, "--voxels", "16"}, folder.path()), GetParam().hint);
  expect_refused(run_limn({"study", input, "--size", "32x24", "--voxels", "16"}, folder.path()), GetParam().hint);
  EXPECT_EQ(folder.files(), before);
  EXPECT_EQ(read_bytes(folder.path() / "kept.png"), "old picture");
}

std::string with_line(const std::string& text) { return std::string(kCube) + text; }
std::string scene(const std::string& text) { return text + "\n"; }

INSTANTIATE_TEST_SUITE_P(
    Mesh, BadFiles,
    testing::Values(
        BadFile{"empty_obj", "a.obj", "", "empty"}, BadFile{"empty_vdb", "a.vdb", "", "empty"},
        BadFile{"empty_toml", "a.toml", "", "empty"}, BadFile{"empty_ply", "a.ply", "", "empty"},
        BadFile{"no_faces", "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", "face"},
        BadFile{"nan_vertex", "a.obj", with_line("v nan 0 0\nf 1 2 9\n"), "finite"},
        BadFile{"infinite_vertex", "a.obj", with_line("v 0 inf 0\nf 1 2 9\n"), "finite"},
        BadFile{"text_as_obj", "a.obj", "this is no mesh at all\n", "face"},
        BadFile{"text_as_ply", "a.ply", "this is no mesh at all\n", "a.ply"},
        BadFile{"text_as_stl", "a.stl", "this is no mesh at all\n", "a.stl"},
        BadFile{"text_as_glb", "a.glb", "this is no mesh at all\n", "a.glb"},
        BadFile{"text_as_off", "a.off", "this is no mesh at all\n", "a.off"},
        BadFile{"text_as_vdb", "a.vdb", "this is no volume at all\n", "a.vdb"}, BadFile{"unknown_ending", "a.xyz", "0 0 0\n", ".obj"},
        BadFile{"ply_without_faces", "a.ply",
                "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n",
                "a.ply"},
        BadFile{"ply_nan", "a.ply",
                "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
                "property list uchar int vertex_indices\nend_header\n0 0 0\nnan 0 0\n0 1 0\n3 0 1 2\n",
                "a.ply"},
        BadFile{"ply_index", "a.ply",
                "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
                "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n",
                "a.ply"}),
    [](const auto& test) { return test.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Scene, BadFiles,
    testing::Values(
        BadFile{"not_toml", "a.toml", scene("[[object]\nshape ="), "a.toml:1:"},
        BadFile{"no_objects", "a.toml", scene("[camera]\nfov = 30"), "[[object]]"},
        BadFile{"unknown_table", "a.toml", scene("[camra]\n[[object]]\nshape = \"sphere\""), "'camera'"},
        BadFile{"unknown_key", "a.toml", scene("[[object]]\nshape = \"sphere\"\nradus = 2"), "'radius'"},
        BadFile{"key_of_other_kind", "a.toml", scene("[[object]]\nshape = \"sphere\"\nlevel = 2"), "a.toml:3:1"},
        BadFile{"unknown_shape", "a.toml", scene("[[object]]\nshape = \"spere\""), "'sphere'"},
        BadFile{"unknown_csg", "a.toml", scene("[[object]]\ncsg = \"differnce\"\nof = [{shape=\"box\"}]"), "'difference'"},
        BadFile{"csg_of_nothing", "a.toml", scene("[[object]]\ncsg = \"union\"\nof = []"), "of"},
        BadFile{"nested_unknown_key", "a.toml", scene("[[object]]\ncsg = \"union\"\nof = [{shape=\"box\", haf=[1,1,1]}]"), "'half'"},
        BadFile{"two_kinds", "a.toml", scene("[[object]]\nshape = \"box\"\nmesh = \"a.obj\""), "one of"},
        BadFile{"no_kind", "a.toml", scene("[[object]]\nname = \"x\""), "one of"},
        BadFile{"negative_radius", "a.toml", scene("[[object]]\nshape = \"sphere\"\nradius = -1"), "radius"},
        BadFile{"nan_radius", "a.toml", scene("[[object]]\nshape = \"sphere\"\nradius = nan"), "a.toml:3"},
        BadFile{"word_for_number", "a.toml", scene("[[object]]\nshape = \"sphere\"\nradius = \"big\""), "radius"},
        BadFile{"two_numbers_for_three", "a.toml", scene("[[object]]\nshape = \"box\"\nhalf = [1, 2]"), "half"},
        BadFile{"zero_scale", "a.toml", scene("[[object]]\nshape = \"box\"\nscale = 0"), "other than 0"},
        BadFile{"zero_axis", "a.toml", scene("[[object]]\nshape = \"box\"\nrotate = [0, 0, 0, 10]"), "axis"},
        BadFile{"fov_0", "a.toml", scene("[camera]\nfov = 0\n[[object]]\nshape = \"box\""), "180"},
        BadFile{"fov_180", "a.toml", scene("[camera]\nfov = 180\n[[object]]\nshape = \"box\""), "180"},
        BadFile{"size_0", "a.toml", scene("[camera]\nsize = [0, 10]\n[[object]]\nshape = \"box\""), "16384"},
        BadFile{"missing_mesh", "a.toml", scene("[[object]]\nmesh = \"nothing.obj\""), "nothing.obj"},
        BadFile{"missing_vdb", "a.toml", scene("[[object]]\nvdb = \"nothing.vdb\""), "nothing.vdb"},
        BadFile{"unknown_method", "a.toml", scene("[border]\nmethod = \"rimm\"\n[[object]]\nshape = \"box\""), "'rim'"},
        BadFile{"unknown_border_key", "a.toml", scene("[border]\ntreshold = 0.4\n[[object]]\nshape = \"box\""), "'threshold'"},
        BadFile{"unknown_surface", "a.toml", scene("[surface]\nkind = \"levelset\"\n[[object]]\nshape = \"box\""), "'level_set'"}),
    [](const auto& test) { return test.param.name; });

TEST(BadInput, AMissingFileAndAFolderAreToldApart) {
  const TemporaryFolder folder;
  expect_refused(run_limn({"render", folder.file("nothing.obj")}, folder.path()), "no such file");
  expect_refused(run_limn({"render", folder.file("nothing.toml")}, folder.path()), "no such file");
  expect_refused(run_limn({"render", folder.file("nothing.vdb")}, folder.path()), "no such file");
  expect_refused(run_limn({"render", folder.path().string()}, folder.path()), "is a folder");
  std::filesystem::create_directory(folder.path() / "folder.obj");
  expect_refused(run_limn({"render", folder.file("folder.obj")}, folder.path()), "is a folder");
  EXPECT_TRUE(folder.files().empty());
}

TEST(BadInput, TruncatedFilesAreRefused) {
  const TemporaryFolder folder;
  for (const std::string ending : {".ply", ".vdb"}) {
    const std::string whole = folder.file("whole" + ending);
    ASSERT_EQ(run_limn({"export", "ellipsoid", ending == ".vdb" ? "--voxels" : "--level", ending == ".vdb" ? "24" : "1", "-o", whole, "-q"})
                  .exit_code,
              0);
    const std::string bytes = read_bytes(whole);
    for (const double share : {0.1, 0.5, 0.9}) {
      const std::string part =
          folder.write("part" + ending, bytes.substr(0, static_cast<size_t>(share * static_cast<double>(bytes.size()))));
      expect_refused(run_limn({"render", part, "--size", "16x12", "-o", folder.file("out.png")}), "part" + ending);
      EXPECT_FALSE(std::filesystem::exists(folder.file("out.png")));
    }
  }
}

TEST(BadInput, AnUnknownGridIsAnsweredWithTheKnownOnes) {
  const TemporaryFolder folder;
  const std::string volume = folder.file("egg.vdb");
  ASSERT_EQ(run_limn({"export", "ellipsoid", "--voxels", "24", "-o", volume, "-q"}).exit_code, 0);
  const std::string name = run_limn({"info", volume, "--json"}).json().at("grids").at(0).at("name");
  ASSERT_FALSE(name.empty());
  expect_refused(run_limn({"render", volume, "--grid", name + "x"}, folder.path()), name);
}

// One face that cannot be drawn does not cost the others.
TEST(BadInput, AFaceThatNamesNoVertexIsLeftOutWithItsLine) {
  for (const char* face : {"f 1 2 99\n", "f 0 1 2\n", "f -1 -2 -99\n"}) {
    const TemporaryFolder folder;
    const std::string mesh = folder.write("a.obj", with_line(face));
    const auto drawn = run_limn({"render", mesh, "--size", "16x12", "-o", folder.file("a.png")});
    EXPECT_EQ(drawn.exit_code, 0) << drawn.err;
    EXPECT_NE(drawn.err.find("1 face names a vertex that is not there"), std::string::npos) << face << drawn.err;
  }
}

TEST(BadInput, ABandTooThinForTheGradientIsFilledInWithTheWidthItNeedsSaid) {
  const TemporaryFolder folder;
  const std::string volume = folder.file("egg.vdb");
  ASSERT_EQ(run_limn({"export", "ellipsoid", "--voxels", "24", "--half-width", "2", "-o", volume, "-q"}).exit_code, 0);
  const auto filled = run_limn({"render", volume, "--gradient", "cubic", "--size", "16x12", "-o", folder.file("a.png")});
  EXPECT_EQ(filled.exit_code, 0) << filled.err;
  EXPECT_NE(filled.err.find("half width 2.00 voxels; the gradient cubic needs 4.12"), std::string::npos) << filled.err;
  EXPECT_EQ(run_limn({"render", volume, "--gradient", "cell", "--size", "16x12", "-o", folder.file("a.png"), "-q"}).exit_code, 0);
}

TEST(BadInput, ACameraThatCannotBeIsToldWithItsSceneFile) {
  for (const char* camera : {"eye = [0, 0, 0]", "eye = [1, 0, 0]\ntarget = [1e308, 1e308, 0]", "eye = [0, 0, 5]\nup = [0, 0, 1]"}) {
    const TemporaryFolder folder;
    const std::string input = folder.write("a.toml", std::string("[camera]\n") + camera + "\n[[object]]\nshape = \"box\"\n");
    const auto before = folder.files();
    for (const char* command : {"render", "compare", "study"})
      expect_refused(run_limn({command, input, "--size", "32x24"}, folder.path()), "a.toml:camera.");
    EXPECT_EQ(folder.files(), before);
    // The option's value is not the file's.
    expect_refused(run_limn({"render", input, "--size", "32x24", "--eye", "0,0,0", "--target", "0,0,0"}, folder.path()), "limn: --eye: ");
  }
}

TEST(BadInput, OutputsThatCannotBeWrittenAreRefusedBeforeAnyWork) {
  const TemporaryFolder folder;
  folder.write("file", "not a folder");
  expect_refused(run_limn({"render", "ellipsoid", "-o", folder.file("file/a.png")}), "folder");
  expect_refused(run_limn({"render", "ellipsoid", "-o", folder.path().string()}), "is a folder");
  expect_refused(run_limn({"render", "ellipsoid", "-o", folder.file("a.gif")}), ".png");
  expect_refused(run_limn({"render", "ellipsoid", "-o", folder.file("a")}), ".png");
  expect_refused(run_limn({"render", "ellipsoid", "-o", "/proc/limn/a.png"}), "/proc");
  expect_refused(run_limn({"export", "ellipsoid", "-o", folder.file("a.png")}), ".obj");
  expect_refused(run_limn({"compare", "ellipsoid", "-o", folder.file("file")}), "folder");
  expect_refused(run_limn({"study", "ellipsoid", "-o", folder.file("file")}), "folder");
  EXPECT_EQ(folder.files(), std::vector<std::string>{"file"});
}

TEST(BadInput, OneFileCannotTakeTwoPictures) {
  const TemporaryFolder folder;
  const std::string same = (folder.path() / "." / "a.png").string();
  expect_refused(run_limn({"render", "ellipsoid", "-o", folder.file("a.png"), "-o", same}), "twice");
  EXPECT_TRUE(folder.files().empty());
}

TEST(Warnings, OfManyObjectsAlikeIsOneLine) {
  const TemporaryFolder folder;
  folder.write("sheet.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  std::string scene;
  for (int i = 0; i < 40; ++i)
    scene += fmt::format("[[object]]\nname = \"sheet {}\"\nmesh = \"sheet.obj\"\ntranslate = [{}, 0, 0]\n", i, 2 * i);
  const RunResult result =
      run_limn({"render", folder.write("many.toml", scene), "--size", "16x12", "--method", "rim", "-o", folder.file("a.png"), "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json warnings = result.json()["warnings"];
  ASSERT_GE(warnings.size(), 1u);
  EXPECT_LE(warnings.size(), 3u) << warnings.dump();
  EXPECT_NE(warnings[0].get<std::string>().find("sheet 0, sheet 1, sheet 2 and 37 more: "), std::string::npos) << warnings.dump();
}

TEST(BadInput, NoClobberKeepsWhatIsThere) {
  const TemporaryFolder folder;
  folder.write("a.png", "old picture");
  expect_refused(run_limn({"render", "ellipsoid", "--size", "16x12", "--no-clobber", "-o", folder.file("a.png")}), "exists");
  EXPECT_EQ(read_bytes(folder.path() / "a.png"), "old picture");
  EXPECT_EQ(run_limn({"render", "ellipsoid", "--size", "16x12", "-o", folder.file("a.png"), "-q"}).exit_code, 0);
  EXPECT_NE(read_bytes(folder.path() / "a.png"), "old picture");
}

}  // namespace
}  // namespace limn
