#include "samples/input/scene_file.h"

#include <gtest/gtest.h>

#include <numbers>

#include "run_program.h"
#include "sdf/error.h"
#include "sdf/field_program.h"

namespace limn {
namespace {

std::string fault_of(const std::string& text) {
  try {
    parse_scene_file(text, "a.toml");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

double value_at(const SceneObject& object, const glm::dvec3& point) {
  FieldEvaluator evaluator(std::get<Field>(object.source));
  return evaluator.value(point);
}

TEST(SceneFile, ReadsEveryKeyOfTheContract) {
  const TemporaryFolder folder;
  folder.write("cube.obj",
               "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
               "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
  ASSERT_EQ(run_limn({"export", "ellipsoid", "--voxels", "20", "-o", folder.file("egg.vdb"), "-q"}).exit_code, 0);
  const std::string grid = run_limn({"info", folder.file("egg.vdb"), "--json"}).json().at("grids").at(0).at("name");
  const std::string text = R"toml(
[camera]
eye = [3.0, 2.0, 4.0]
target = [0.5, 0.0, 0.0]
up = [0.0, 0.0, 1.0]
fov = 40.0
size = [320, 200]

[[object]]
name = "egg"
shape = "ellipsoid"
radii = [1.0, 0.7, 0.5]
translate = [0.0, 0.2, 0.0]
rotate = [0.0, 1.0, 0.0, 30.0]
scale = 2.0
color = [0.8, 0.5, 0.3]
material = 2

[[object]]
name = "cut"
csg = "difference"
smooth = 0.05
of = [ { shape = "box", half = [1, 1, 1] }, { shape = "sphere", radius = 1.2, translate = [0.5, 0, 0] } ]
scale = [1.0, 2.0, 1.0]

[[object]]
mesh = "cube.obj"
scheme = "loop"
level = 0

[[object]]
vdb = "egg.vdb"
grid = ")toml" + grid + R"toml("
scale = 0.5

[surface]
kind = "level_set"
voxels = 100
half_width = 4
gradient = "cubic"
level = 2
scheme = "bilinear"
normals = "flat"

[border]
method = "rim"
threshold = 0.3
color = [0.1, 0.2, 0.3]
)toml";
  const SceneInput input = parse_scene_file(text, folder.path() / "scene.toml");
  EXPECT_EQ(*input.scene.camera.eye, glm::dvec3(3, 2, 4));
  EXPECT_EQ(*input.scene.camera.target, glm::dvec3(0.5, 0, 0));
  EXPECT_EQ(input.scene.camera.up, glm::dvec3(0, 0, 1));
  EXPECT_DOUBLE_EQ(input.scene.camera.vertical_fov, 40.0 * std::numbers::pi / 180.0);
  EXPECT_EQ(input.scene.camera.width_px, 320);
  EXPECT_EQ(input.scene.camera.height_px, 200);

  ASSERT_EQ(input.scene.objects.size(), 4u);
  const SceneObject& egg = input.scene.objects[0];
  EXPECT_EQ(egg.name, "egg");
  EXPECT_EQ(egg.color, glm::vec3(0.8f, 0.5f, 0.3f));
  EXPECT_EQ(egg.material, 2);
  // Scaled, then turned by 30 degrees about y (x goes to -z), then moved.
  const double turn = 30.0 * std::numbers::pi / 180.0;
  EXPECT_NEAR(value_at(egg, glm::dvec3(2.0 * std::cos(turn), 0.2, -2.0 * std::sin(turn))), 0.0, 1e-9);
  EXPECT_LT(value_at(input.scene.objects[1], {-0.9, 1.8, -0.9}), 0.0);
  EXPECT_GT(value_at(input.scene.objects[1], {0.5, 0.0, 0.0}), 0.0);
  const auto& mesh = std::get<MeshSource>(input.scene.objects[2].source);
  EXPECT_EQ(mesh.mesh->face_count(), 6u);
  EXPECT_EQ(mesh.scheme, Scheme::loop);
  EXPECT_EQ(input.scene.objects[2].level, 0);
  EXPECT_EQ(input.scene.objects[3].world_from_object.linear[0][0], 0.5);

  EXPECT_EQ(input.surface.kind, "level_set");
  EXPECT_EQ(input.surface.voxels, 100);
  EXPECT_EQ(input.surface.half_width_voxels, 4.0);
  EXPECT_EQ(input.surface.gradient, "cubic");
  EXPECT_EQ(input.surface.level, 2);
  EXPECT_EQ(input.surface.scheme, Scheme::bilinear);
  EXPECT_EQ(input.surface.normals, NormalKind::flat);
  ASSERT_EQ(input.borders.size(), 1u);
  EXPECT_EQ(input.borders[0].method, "rim");
  EXPECT_EQ(input.borders[0].parameters.at("threshold").numbers, std::vector<double>{0.3});
}

TEST(SceneFile, PartsOfAFieldHaveMaterialsAndColorsThatTheirPartsInherit) {
  const SceneInput input = parse_scene_file(R"toml(
[[object]]
material = 7
csg = "difference"
of = [
  { csg = "union", material = 2, color = [0.1, 0.2, 0.3], translate = [1, 0, 0], of = [
    { shape = "sphere", radius = 1.0 },
    { shape = "box", half = [1, 1, 1], material = 0, color = "red" } ] },
  { shape = "sphere", radius = 0.5 } ]
)toml",
                                            "a.toml");
  const auto& leaves = std::get<Field>(input.scene.objects[0].source).program().leaves;
  ASSERT_EQ(leaves.size(), 3u);
  EXPECT_EQ(leaves[0].material, 2);
  EXPECT_EQ(leaves[0].color, glm::vec3(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(leaves[1].material, 0);
  EXPECT_EQ(leaves[1].color, glm::vec3(1.0f, 0.0f, 0.0f));
  EXPECT_EQ(leaves[2].material, kNoMaterial);
  EXPECT_FALSE(leaves[2].color);
}

TEST(SceneFile, AWrongMaterialOfAPartIsNamedWithItsPlace) {
  const auto with = [](const std::string& key) {
    return fault_of("[[object]]\ncsg = \"union\"\nof = [ { shape = \"sphere\" },\n  { shape = \"box\", " + key + " } ]\n");
  };
  for (const auto& [key, said] : std::vector<std::pair<std::string, std::string>>{
           {"material = -1", "-1"}, {"material = 1000001", "1000001"}, {"material = \"brass\"", "'brass'"}, {"material = 1.5", "1.5"}}) {
    const std::string fault = with(key);
    EXPECT_NE(fault.find("a.toml:4"), std::string::npos) << fault;
    EXPECT_NE(fault.find("object[0].of[1].material"), std::string::npos) << fault;
    EXPECT_NE(fault.find("0 to 1000000"), std::string::npos) << fault;
    EXPECT_NE(fault.find("got " + said + ","), std::string::npos) << fault;
  }
  const std::string fault = with("color = [1.0, 2.0]");
  EXPECT_NE(fault.find("object[0].of[1].color"), std::string::npos) << fault;
  EXPECT_NE(with("materiel = 1").find("material"), std::string::npos) << with("materiel = 1");
}

TEST(SceneFile, OrthographicCamerasAndVoxelSizesAreReadToo) {
  const SceneInput input =
      parse_scene_file("[camera]\northo = 2.4\n[surface]\nvoxel_size = 0.01\n[[object]]\nshape = \"gyroid\"\n", "a.toml");
  EXPECT_EQ(input.scene.camera.projection, Projection::orthographic);
  EXPECT_EQ(input.scene.camera.ortho_height, 2.4);
  EXPECT_EQ(input.surface.voxel_size, 0.01);
  EXPECT_NE(fault_of("[camera]\northo = 2\nfov = 30\n[[object]]\nshape = \"box\"\n").find("fov"), std::string::npos);
}

TEST(SceneFile, GrowAndShellChangeAFieldByLengths) {
  const SceneInput input = parse_scene_file(
      "[[object]]\nshape = \"sphere\"\nradius = 1\ngrow = 0.25\n[[object]]\nshape = \"sphere\"\nradius = 1\nshell = 0.2\n", "a.toml");
  EXPECT_NEAR(value_at(input.scene.objects[0], {1.25, 0, 0}), 0.0, 1e-12);
  EXPECT_NEAR(value_at(input.scene.objects[1], {1.1, 0, 0}), 0.0, 1e-12);
  EXPECT_GT(value_at(input.scene.objects[1], {0, 0, 0}), 0.0);
}

TEST(SceneFile, FaultsNameFileLineColumnAndTheNearestKey) {
  const std::string fault = fault_of("[camera]\nfov = 30\n\n[[object]]\nshape = \"sphere\"\n  raduis = 2\n");
  EXPECT_NE(fault.find("a.toml:6:3"), std::string::npos) << fault;
  EXPECT_NE(fault.find("object[0].raduis"), std::string::npos) << fault;
  EXPECT_NE(fault.find("'radius'"), std::string::npos) << fault;
  const std::string range = fault_of("[[object]]\nshape = \"sphere\"\nradius = -2\n");
  EXPECT_NE(range.find("a.toml:3:"), std::string::npos) << range;
  EXPECT_NE(range.find("radius"), std::string::npos) << range;
}

TEST(SceneFile, TheFirstUnknownKeyInTheFileIsTheOneReported) {
  const std::string fault = fault_of("[[object]]\nshape = \"sphere\"\nzzz = 1\naaa = 1\n");
  EXPECT_NE(fault.find("zzz"), std::string::npos) << fault;
}

TEST(SceneFile, CommandLineOverridesTheFile) {
  const TemporaryFolder folder;
  const std::string scene = folder.write("a.toml",
                                         "[camera]\nsize = [64, 48]\n[surface]\nkind = \"level_set\"\nvoxels = 20\n[border]\nthreshold = "
                                         "0.9\n[[object]]\nshape = \"sphere\"\n");
  const auto plain = run_limn({"render", scene, "-o", folder.file("a.exr"), "--json"}).json();
  EXPECT_EQ(plain.at("surface").at("kind"), "level_set");
  EXPECT_EQ(plain.at("hits").get<int>() + plain.at("misses").get<int>(), 64 * 48);
  const auto changed =
      run_limn({"render", scene, "-o", folder.file("b.exr"), "--json", "--size", "32x24", "--surface", "mesh", "--level", "1"}).json();
  EXPECT_EQ(changed.at("surface").at("kind"), "mesh");
  EXPECT_EQ(changed.at("hits").get<int>() + changed.at("misses").get<int>(), 32 * 24);
}

}  // namespace
}  // namespace limn
