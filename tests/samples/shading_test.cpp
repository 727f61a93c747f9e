// What a mesh means once it is read, as people ask for it: hard edges, schemes, refined positions, sizes.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "samples/study/key.h"
#include "subdiv/import.h"
#include "tests/samples/run_program.h"

namespace limn {
namespace {

constexpr const char* kCorners = "v -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 1\nv 1 -1 1\nv -1 1 1\nv 1 1 1\n";
constexpr const char* kQuads = "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
constexpr const char* kOctahedron =
    "v 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1\n"
    "f 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\nf 3 1 6\nf 2 3 6\nf 4 2 6\nf 1 4 6\n";

std::string write(const TemporaryFolder& folder, const std::string& name, const std::string& text) {
  const std::string file = folder.file(name);
  std::ofstream(file) << text;
  return file;
}

std::string picture(const TemporaryFolder& folder, const std::string& input, const std::vector<std::string>& more = {}) {
  const std::string file = folder.file("picture.png");
  std::vector<std::string> arguments = {"render", input, "--size", "96x72", "-o", file, "-q"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const RunResult result = run_limn(arguments);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return read_bytes(file);
}

TEST(Shading, TheSmoothAngleIsAnOptionAndAKeyOfScenesAndObjects) {
  const TemporaryFolder folder;
  const std::string cube = write(folder, "cube.obj", std::string(kCorners) + kQuads);
  const std::string usual = picture(folder, cube), smooth = picture(folder, cube, {"--smooth-angle", "180"});
  EXPECT_NE(usual, smooth);
  EXPECT_EQ(picture(folder, cube, {"--smooth-angle", "30"}), usual);
  EXPECT_EQ(picture(folder, cube, {"--normals", "flat"}), usual) << "all edges of a cube are hard";
  const std::string of_scene = write(folder, "a.toml", "[surface]\nsmooth_angle = 180\n[[object]]\nmesh = \"cube.obj\"\n");
  const std::string of_object =
      write(folder, "b.toml", "[surface]\nsmooth_angle = 20\n[[object]]\nmesh = \"cube.obj\"\nsmooth_angle = 180\n");
  EXPECT_EQ(picture(folder, of_scene), smooth);
  EXPECT_EQ(picture(folder, of_object), smooth) << "the object's own comes before the scene's";
  EXPECT_EQ(picture(folder, of_object, {"--smooth-angle", "30"}), usual) << "the call's before both";
  for (const char* wrong : {"-1", "181", "flat"}) {
    const RunResult result = run_limn({"render", cube, "--smooth-angle", wrong});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_NE(result.err.find("--smooth-angle"), std::string::npos) << result.err;
  }
  const RunResult result =
      run_limn({"render", write(folder, "c.toml", "[surface]\nsmooth_angle = 200\n[[object]]\nmesh = \"cube.obj\"\n")});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("c.toml:2:"), std::string::npos) << result.err;
}

TEST(Shading, SmoothingGroupsOfAFileAreKeptAndWrittenAgain) {
  const TemporaryFolder folder;
  Mesh mesh = load_mesh(write(folder, "cube.obj", std::string(kCorners) + kQuads));
  mesh.face_smoothing = {1, 1, 1, 2, 2, 0};
  mesh.holes = {5};
  mesh.crease_method = CreaseMethod::chaikin;
  mesh.triangle_rule = TriangleRule::smooth;
  write_mesh(mesh, folder.file("groups.obj"));
  const std::string text = read_bytes(folder.file("groups.obj"));
  for (const char* line :
       {"\ns 1\nf", "\ns 2\nf", "\ns 0\nf", "\nt hole 1/0/0 5\n", "\nt creasemethod 0/0/1 chaikin\n", "\nt smoothtriangles 0/0/1 smooth\n"})
    EXPECT_NE(text.find(line), std::string::npos) << line;
}

TEST(Shading, SmoothingGroupsOfAllObjectsAreWrittenAndLossesAreSaid) {
  const TemporaryFolder folder;
  const std::string quads = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\n";
  folder.write("smooth.obj", quads + "s 3\nf 1 2 3 4\nf 1 2 6 5\n");
  folder.write("plain.obj", quads + "f 1 2 3 4\nf 1 2 6 5\n");
  const auto scene = [&](const std::string& second) {
    return folder.write(second + ".toml",
                        "[[object]]\nmesh = \"smooth.obj\"\n[[object]]\nmesh = \"" + second + "\"\ntranslate = [2, 0, 0]\n");
  };
  const RunResult both = run_limn({"export", scene("smooth.obj"), "-o", folder.file("both.obj")});
  EXPECT_EQ(both.exit_code, 0) << both.err;
  EXPECT_EQ(both.err.find("not written"), std::string::npos) << both.err;
  EXPECT_NE(read_bytes(folder.path() / "both.obj").find("s 3"), std::string::npos);
  const RunResult one = run_limn({"export", scene("plain.obj"), "-o", folder.file("one.obj")});
  EXPECT_EQ(one.exit_code, 0) << one.err;
  EXPECT_NE(one.err.find("smoothing groups are not written: 1 of 2 objects have none"), std::string::npos) << one.err;
}

TEST(Shading, TrianglesTakeLoopAndAllOthersCatmullClark) {
  const TemporaryFolder folder;
  const std::string cube = write(folder, "cube.obj", std::string(kCorners) + kQuads);
  const std::string octahedron = write(folder, "octahedron.obj", kOctahedron);
  const auto scheme_of = [](const std::string& file, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"info", file, "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const RunResult result = run_limn(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.out.find("\"loop\"") != std::string::npos      ? "loop"
           : result.out.find("\"catmark\"") != std::string::npos ? "catmark"
                                                                 : "none";
  };
  EXPECT_STREQ(scheme_of(octahedron, {}), "none");
  EXPECT_STREQ(scheme_of(octahedron, {"--level", "2"}), "loop");
  EXPECT_STREQ(scheme_of(octahedron, {"--level", "2", "--scheme", "catmark"}), "catmark");
  EXPECT_STREQ(scheme_of(cube, {"--level", "2"}), "catmark");
  EXPECT_STREQ(scheme_of(write(folder, "tagged.obj", std::string(kOctahedron) + "t crease 2/1/0 0 2 3\n"), {}), "loop");
  EXPECT_STREQ(scheme_of(write(folder, "tagged_cube.obj", std::string(kCorners) + kQuads + "t crease 2/1/0 0 1 3\n"), {}), "catmark");
  EXPECT_STREQ(scheme_of(write(folder, "level.toml", "[[object]]\nmesh = \"octahedron.obj\"\nlevel = 1\n"), {}), "loop");
  // 8 triangles twice in four; as quads it would be 24 times four.
  const RunResult result = run_limn({"export", octahedron, "--level", "2", "-o", folder.file("o.ply"), "--json"});
  EXPECT_EQ(result.json()["faces"], 128);
  EXPECT_NE(run_limn({"render", octahedron, "--level", "2", "--size", "16x12", "-o", folder.file("o.png"), "-v"})
                .err.find("'octahedron' is subdivided by loop, level 2"),
            std::string::npos);
}

TEST(Shading, RefinedPositionsAreExportedWhenAskedFor) {
  const TemporaryFolder folder;
  const std::string cube = write(folder, "cube.obj", std::string(kCorners) + kQuads + "t crease 2/1/0 0 1 2.5\n");
  for (const char* name : {"r.obj", "r.ply"})
    ASSERT_EQ(run_limn({"export", cube, "--level", "1", "--refined", "-o", folder.file(name), "-q"}).exit_code, 0);
  const Mesh refined = load_mesh(folder.file("r.obj"));
  // By hand: corners go to 5/9 (Catmull & Clark 1978), middles of faces stay, middles of smooth edges go to 3/4.
  const auto has = [&refined](const glm::dvec3& p) {
    return std::any_of(refined.positions.begin(), refined.positions.end(),
                       [&](const glm::dvec3& q) { return glm::distance(p, q) < 1e-12; });
  };
  EXPECT_TRUE(has(glm::dvec3(5.0 / 9.0)));
  EXPECT_TRUE(has({1.0, 0.0, 0.0}));
  EXPECT_TRUE(has({0.0, 0.75, 0.75}));
  EXPECT_TRUE(has({0.0, -1.0, -1.0})) << "the crease's middle";
  ASSERT_EQ(refined.creases.size(), 2u) << "what is left of the tag";
  EXPECT_EQ(refined.creases[0].sharpness, 1.5f);
  // Refined twice in two steps or in one.
  ASSERT_EQ(run_limn({"export", cube, "--level", "3", "--refined", "-o", folder.file("at_once.obj"), "-q"}).exit_code, 0);
  ASSERT_EQ(run_limn({"export", folder.file("r.obj"), "--level", "2", "--refined", "-o", folder.file("in_steps.obj"), "-q"}).exit_code, 0);
  const Mesh at_once = load_mesh(folder.file("at_once.obj")), in_steps = load_mesh(folder.file("in_steps.obj"));
  ASSERT_EQ(at_once.vertex_count(), in_steps.vertex_count());
  for (const glm::dvec3& p : in_steps.positions) {
    double nearest = 1e30;
    for (const glm::dvec3& q : at_once.positions) nearest = std::min(nearest, glm::distance(p, q));
    ASSERT_LT(nearest, 1e-9);
  }
  for (const std::vector<std::string>& wrong : std::vector<std::vector<std::string>>{
           {"export", "ellipsoid", "--refined"}, {"export", cube, "--level", "1", "--refined", "-o", folder.file("r.vdb")}}) {
    const RunResult result = run_limn(wrong);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_NE(result.err.find("--refined"), std::string::npos) << result.err;
  }
}

TEST(Shading, SizesThatCannotBeDrawnAreOneError) {
  const TemporaryFolder folder;
  for (const char* unit : {"1e30", "1e-30", "1e38", "1e90"}) {
    std::string text;
    for (const char* x : {"-", ""})
      for (const char* y : {"-", ""})
        for (const char* z : {"-", ""}) text += fmt::format("v {}{} {}{} {}{}\n", x, unit, y, unit, z, unit);
    const std::string file = write(folder, "size.obj", text + kQuads);
    for (const std::vector<std::string>& more :
         {std::vector<std::string>{}, {"--surface", "mesh_level_set", "--voxels", "16"}, {"--level", "1"}}) {
      std::vector<std::string> arguments = {"render", file, "--size", "32x24", "-o", folder.file("x.png"), "--json"};
      arguments.insert(arguments.end(), more.begin(), more.end());
      const RunResult result = run_limn(arguments);
      EXPECT_EQ(result.exit_code, 2) << unit;
      EXPECT_EQ(result.err_lines(), 1) << result.err;
      EXPECT_NE(result.err.find("size.obj"), std::string::npos) << result.err;
    }
  }
}

TEST(Shading, AStudyOfOtherNormalsIsAnother) {
  const TemporaryFolder folder;
  const Mesh mesh = load_mesh(write(folder, "cube.obj", std::string(kCorners) + kQuads));
  const auto hash = [](Mesh changed, std::optional<double> angle) {
    SceneInput input;
    input.kind = InputKind::mesh;
    MeshSource source = mesh_source(std::move(changed), std::nullopt, "cube.obj");
    source.smooth_angle_deg = angle;
    input.scene.objects.push_back({.name = "cube", .source = std::move(source)});
    return hash_of_input(input);
  };
  std::vector<std::string> all = {hash(mesh, std::nullopt), hash(mesh, 180.0), hash(mesh, 40.0)};
  Mesh other = mesh;
  other.face_smoothing.assign(6, 1);
  all.push_back(hash(other, std::nullopt));
  other = mesh;
  other.holes = {2};
  all.push_back(hash(other, std::nullopt));
  other = mesh;
  other.crease_method = CreaseMethod::chaikin;
  all.push_back(hash(other, std::nullopt));
  other = mesh;
  other.triangle_rule = TriangleRule::smooth;
  all.push_back(hash(other, std::nullopt));
  std::sort(all.begin(), all.end());
  EXPECT_EQ(std::unique(all.begin(), all.end()), all.end());
  EXPECT_EQ(hash(mesh, 40.0), hash(mesh, 40.0));
}

}  // namespace
}  // namespace limn
