#include "subdiv/import.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "sdf/error.h"
#include "subdiv/mesh_audit.h"
#include "subdiv/refine.h"
#include "test_meshes.h"
#include "tests/temporary_folder.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

class Import : public ::testing::Test {
 protected:
  /// Whether the file is refused with a message of one line that holds `part`.
  static testing::AssertionResult refused(const fs::path& file, const std::string& part) {
    try {
      load_mesh(file);
      return testing::AssertionFailure() << file << " was accepted";
    } catch (const InputError& error) {
      const std::string message = error.what();
      const auto holds = [&](const std::string& text) { return message.find(text) != std::string::npos; };
      const auto lacks = [&](const std::string& what) { return testing::AssertionFailure() << "no " << what << " in: " << message; };
      if (holds("\n")) return testing::AssertionFailure() << "more than one line: " << message;
      if (!holds(file.filename().string())) return lacks(file.filename().string());
      if (!holds(part)) return lacks("'" + part + "'");
      if (error.fault().expected.empty() && !holds("expected")) return lacks("word of what was expected");
      return testing::AssertionSuccess();
    }
  }

  TemporaryFolder folder_;
};

const char* const kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

std::string slurp(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

TEST_F(Import, ObjKeepsPolygonsNamesTagsAndDoublePrecision) {
  const Mesh mesh = load_mesh(folder_.write("all.obj",
                                            "# a pentagon and a triangle\r\nmtllib none.mtl\n"
                                            "v 0.1234567890123456 0 0\nv 1 0 0\nv 1.5 1 0\nv .5 1.5e0 0\nv -0.5 1 0\n"
                                            "vn 0 0 1\n\ng left wing\nusemtl shiny red\nf 1//1 2//1 3//1 \\\n 4//1 5//1\n"
                                            "g right\nusemtl dull\nf -5/7/-1 -4/8/-1 -3/9/-1\n"
                                            "t crease 3/1/0 0 1 2 2.5\nt crease 2/1/0 3 4 10\nt corner 2/2/0 0 3 1.5 10\n"
                                            "t interpolateboundary 1/0/0 2\n"));
  EXPECT_EQ(mesh.face_sizes, (std::vector<std::int32_t>{5, 3}));
  EXPECT_EQ(mesh.corner_vertices, (std::vector<std::int32_t>{0, 1, 2, 3, 4, 0, 1, 2}));
  EXPECT_EQ(mesh.positions[0].x, 0.1234567890123456);
  EXPECT_EQ(mesh.positions[3].y, 1.5);
  EXPECT_EQ(mesh.corner_normals.size(), 8u);
  EXPECT_EQ(mesh.group_names, (std::vector<std::string>{"left wing", "right"}));
  EXPECT_EQ(mesh.face_groups, (std::vector<std::int32_t>{0, 1}));
  EXPECT_EQ(mesh.material_names, (std::vector<std::string>{"shiny red", "dull"}));
  EXPECT_EQ(mesh.face_materials, (std::vector<std::int32_t>{0, 1}));
  ASSERT_EQ(mesh.creases.size(), 3u);
  EXPECT_EQ(mesh.creases[1].vertex_a, 1);
  EXPECT_EQ(mesh.creases[1].vertex_b, 2);
  EXPECT_EQ(mesh.creases[1].sharpness, 2.5f);
  EXPECT_EQ(mesh.creases[2].sharpness, 10.0f);
  ASSERT_EQ(mesh.corners.size(), 2u);
  EXPECT_EQ(mesh.corners[1].sharpness, 10.0f);
  EXPECT_EQ(mesh.boundary, BoundaryRule::edge_only);
}

TEST_F(Import, ObjFacesMayComeBeforeTheirVertices) {
  EXPECT_EQ(load_mesh(folder_.write("late.obj", std::string("f 1 2 3\n") + kTriangle)).face_count(), 1u);
}

TEST_F(Import, ObjPolygonsMayBeLarge) {
  std::ostringstream text;
  for (int i = 0; i < 300; ++i) text << "v " << std::cos(i * 0.0209) << " " << std::sin(i * 0.0209) << " 0\n";
  text << "f";
  for (int i = 1; i <= 300; ++i) text << " " << i;
  EXPECT_EQ(load_mesh(folder_.write("large.obj", text.str())).face_sizes[0], 300);
}

TEST_F(Import, ObjFaultsAreNamedWithTheirLine) {
  const std::string v = kTriangle;
  EXPECT_TRUE(refused(folder_.write("range.obj", v + "f 1 2 4\n"), "range.obj:4"));
  EXPECT_TRUE(refused(folder_.write("back.obj", v + "f -1 -2 -4\n"), "out of range"));
  EXPECT_TRUE(refused(folder_.write("zero.obj", v + "f 0 1 3\n"), "out of range"));
  EXPECT_TRUE(refused(folder_.write("huge.obj", v + "f 1 2 99999999999999999999\n"), "is not a vertex number"));
  EXPECT_TRUE(refused(folder_.write("normal.obj", v + "f 1//x 2//1 3//1\n"), "is not a normal number"));
  EXPECT_TRUE(refused(folder_.write("two.obj", v + "f 1 2\n"), "fewer than 3 corners"));
  EXPECT_TRUE(refused(folder_.write("word.obj", v + "f 1 2 x\n"), "is not a vertex number"));
  EXPECT_TRUE(refused(folder_.write("nan.obj", "v 0 nan 0\n" + v + "f 1 2 3\n"), "nan.obj:1"));
  EXPECT_TRUE(refused(folder_.write("inf.obj", "v 0 0 -inf\n" + v + "f 1 2 3\n"), "finite"));
  EXPECT_TRUE(refused(folder_.write("over.obj", "v 0 0 1e999\n" + v + "f 1 2 3\n"), "not a number"));
  EXPECT_TRUE(refused(folder_.write("short.obj", "v 0 0\n" + v + "f 1 2 3\n"), "three coordinates"));
  EXPECT_TRUE(refused(folder_.write("none.obj", v), "no faces"));
  EXPECT_TRUE(refused(folder_.write("tag.obj", v + "f 1 2 3\nt crease 2/1/0 0 9 1\n"), "crease 1"));
  EXPECT_TRUE(refused(folder_.write("tags.obj", v + "f 1 2 3\nt crease 2/1/0 0\n"), "tag"));
  EXPECT_TRUE(refused(folder_.write("sharp.obj", v + "f 1 2 3\nt corner 1/1/0 0 -2\n"), "sharpness"));
  EXPECT_TRUE(refused(folder_.write("binary.obj", std::string("v 0 0 0\n\0\1\2", 11)), "binary"));
}

TEST_F(Import, WhatIsNoMeshFileIsRefused) {
  EXPECT_TRUE(refused(folder_.file("missing.obj"), "no such file"));
  EXPECT_TRUE(refused(folder_.file("missing.ply"), "no such file"));
  fs::create_directories(folder_.file("folder.obj"));
  EXPECT_TRUE(refused(folder_.file("folder.obj"), "directory"));
  for (const char* extension : {".obj", ".ply", ".stl", ".off", ".gltf", ".glb"}) {
    EXPECT_TRUE(is_mesh_file(std::string("x") + extension));
    EXPECT_TRUE(refused(folder_.write(std::string("empty") + extension, ""), "empty"));
    EXPECT_TRUE(
        refused(folder_.write(std::string("noise") + extension, "\x89PNG this is no mesh at all, whatever its name says\n"), "noise"));
  }
  EXPECT_TRUE(is_mesh_file("X.PLY"));
  EXPECT_FALSE(is_mesh_file("x.fbx"));
  EXPECT_TRUE(refused(folder_.write("model.fbx", "anything"), "extension"));
  EXPECT_TRUE(refused(folder_.write("really.stl", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"), "really.stl"));
}

TEST_F(Import, DamagedPlyOffAndStlAreRefused) {
  const std::string header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  EXPECT_TRUE(
      refused(folder_.write("range.ply",
                            header + "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n"),
              "out of range"));
  EXPECT_TRUE(refused(
      folder_.write("nan.ply",
                    header + "element face 1\nproperty list uchar int vertex_indices\nend_header\nnan 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
      "finite"));
  EXPECT_TRUE(refused(folder_.write("points.ply", header + "end_header\n0 0 0\n1 0 0\n0 1 0\n"), "face"));
  EXPECT_TRUE(refused(folder_.write("range.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 9\n"), "range"));
  EXPECT_TRUE(refused(folder_.write("none.off", "OFF\n0 0 0\n"), "none.off"));
  EXPECT_TRUE(refused(folder_.write("none.stl", "solid nothing\nendsolid nothing\n"), "none.stl"));
}

TEST_F(Import, ElementsBeyondTheLimitAreRefused) {
  ImportSettings settings;
  settings.max_elements = 20;
  write_mesh(test::cube(), folder_.file("cube.ply"));
  write_mesh(test::cube(), folder_.file("cube.obj"));
  EXPECT_THROW(load_mesh(folder_.file("cube.ply"), settings), InputError);
  EXPECT_THROW(load_mesh(folder_.file("cube.obj"), settings), InputError);
}

TEST_F(Import, WrittenMeshesReadBackTheSame) {
  Mesh mesh = test::jittered(test::prism(5), 0.3, 51);
  mesh.creases = {{0, 1, 2.5f}, {5, 6, 10.0f}};
  mesh.corners = {{2, 10.0f}};
  mesh.boundary = BoundaryRule::edge_only;
  mesh.group_names = {"side", "cap"};
  mesh.face_groups = {0, 0, 0, 0, 0, 1, 1};
  mesh.material_names = {"steel"};
  mesh.face_materials.assign(7, 0);
  for (size_t v = 0; v < mesh.vertex_count(); ++v) mesh.vertex_colors.emplace_back(0.1f * static_cast<float>(v), 0.5f, 1.0f);
  for (size_t c = 0; c < mesh.corner_vertices.size(); ++c) mesh.corner_normals.emplace_back(0.0f, 0.6f, 0.8f);
  for (const char* name : {"back.obj", "back.ply"}) {
    write_mesh(mesh, folder_.file(name));
    const Mesh back = load_mesh(folder_.file(name));
    EXPECT_EQ(back.face_sizes, mesh.face_sizes) << name;
    EXPECT_EQ(back.corner_vertices, mesh.corner_vertices) << name;
    const bool obj = std::string(name) == "back.obj";
    for (size_t v = 0; v < mesh.vertex_count(); ++v) {
      EXPECT_LT(glm::distance(back.positions[v], mesh.positions[v]), obj ? 1e-300 : 1e-6) << name;
      EXPECT_LT(glm::length(back.vertex_colors.at(v) - mesh.vertex_colors[v]), obj ? 1e-5f : 0.01f) << name;
    }
    ASSERT_EQ(back.corner_normals.size(), mesh.corner_normals.size()) << name;
    EXPECT_LT(glm::length(back.corner_normals[3] - mesh.corner_normals[3]), 1e-6f);
    if (!obj) continue;
    EXPECT_EQ(back.creases.size(), 2u);
    EXPECT_EQ(back.creases[0].sharpness, 2.5f);
    EXPECT_EQ(back.corners.at(0).vertex, 2);
    EXPECT_EQ(back.boundary, BoundaryRule::edge_only);
    EXPECT_EQ(back.face_groups, mesh.face_groups);
    EXPECT_EQ(back.material_names, mesh.material_names);
  }
  EXPECT_THROW(write_mesh(mesh, folder_.file("back.stl")), InputError);
  EXPECT_FALSE(fs::exists(folder_.file("back.stl")));
}

TEST_F(Import, MutatedFilesAreRefusedOrReadAsValidMeshes) {
  const Mesh mesh = test::sphere(2);
  write_mesh(mesh, folder_.file("good.ply"));
  write_mesh(mesh, folder_.file("good.obj"));
  std::mt19937 random(4711);
  int refused = 0, read = 0;
  for (const char* name : {"good.ply", "good.obj"}) {
    const std::string good = slurp(folder_.file(name));
    for (int round = 0; round < 40; ++round) {
      std::string bad = good;
      const unsigned kind = random() % 4;
      if (kind == 0) bad.resize(1 + random() % bad.size());
      for (unsigned k = 0; k < 1 + random() % 8 && kind == 1; ++k) bad[random() % bad.size()] = static_cast<char>(random());
      for (unsigned k = 0; k < 4 && kind == 2; ++k) bad[random() % 300] = static_cast<char>('0' + random() % 10);
      if (kind == 3) bad.erase(random() % bad.size(), 1 + random() % 40);
      const fs::path file = folder_.write(std::string("bad") + fs::path(name).extension().c_str(), bad);
      ImportSettings settings;
      settings.limits.time = std::chrono::milliseconds(5000);
      settings.limits.memory_bytes = std::int64_t{1} << 30;
      try {
        validate(load_mesh(file, settings), file.string());
        ++read;
      } catch (const InputError&) {
        ++refused;
      }
    }
  }
  EXPECT_EQ(refused + read, 80);
  EXPECT_GT(refused, 20);
  EXPECT_GT(read, 5);
}

TEST_F(Import, APlyThatBreaksOffWithinItsHeaderIsRefusedAtOnce) {
  for (const char* text : {"ply\nformat binary_little_endian 1.0\nelement vertex 642\nproper\nouble y\n", "ply\n", "ply"}) {
    try {
      load_mesh(folder_.write("broken.ply", text));
      FAIL() << "was read: " << text;
    } catch (const InputError& error) {
      EXPECT_EQ(error.fault().field, "header");
    }
  }
}

/// Debian's assimp-testmodels.
fs::path sample(const std::string& name) { return fs::path("/usr/share/assimp/models") / name; }

TEST_F(Import, FilesOfEveryFormatFromElsewhere) {
  struct Case {
    const char* name;
    size_t vertices, faces;
    int open_edges;  // -1: not looked at
  };
  // BoxTextured has 24 vertices for 8 corners: glTF splits them by normal, and nothing is welded by position.
  const Case cases[] = {{"PLY/cube.ply", 8, 6, 0},
                        {"PLY/cube_binary.ply", 8, 12, 0},
                        {"OFF/Cube.off", 8, 6, 0},
                        {"STL/Spider_binary.stl", 722, 1312, -1},  // of 1368 facets 56 have two equal corners
                        {"STL/sphereWithHole.stl", 146, 285, 9},
                        {"glTF2/BoxTextured-glTF/BoxTextured.gltf", 24, 12, 24},
                        {"glTF2/BoxTextured-glTF-Embedded/BoxTextured.gltf", 24, 12, 24},
                        {"glTF2/BoxTextured-glTF-Binary/BoxTextured.glb", 24, 12, 24}};
  for (const Case& c : cases) {
    if (!fs::exists(sample(c.name))) GTEST_SKIP() << "assimp-testmodels is not installed";
    const Mesh mesh = load_mesh(sample(c.name));
    EXPECT_EQ(mesh.vertex_count(), c.vertices) << c.name;
    EXPECT_EQ(mesh.face_count(), c.faces) << c.name;
    int open = 0;
    for (const Edge& edge : build_edges(mesh)) open += edge.face_count == 1;
    if (c.open_edges >= 0) {
      EXPECT_EQ(open, c.open_edges) << c.name;
    }
    for (const glm::dvec3& size = bounds(mesh).size(); const double side : {size.x, size.y, size.z}) EXPECT_GT(side, 0.0) << c.name;
  }
}

TEST_F(Import, DamagedGltfFromElsewhereIsRefused) {
  if (!fs::exists(sample("glTF2"))) GTEST_SKIP() << "assimp-testmodels is not installed";
  // One face of twelve names a vertex that does not exist: it is dropped and counted. Where all do, nothing is left.
  const Mesh eleven = load_mesh(sample("glTF2/IndexOutOfRange/IndexOutOfRange.gltf"));
  EXPECT_EQ(eleven.face_count(), 11u);
  ASSERT_EQ(eleven.warnings.size(), 1u);
  EXPECT_NE(eleven.warnings[0].find("1 face"), std::string::npos) << eleven.warnings[0];
  EXPECT_TRUE(refused(sample("glTF2/IndexOutOfRange/AllIndicesOutOfRange.gltf"), "out of range"));
  EXPECT_TRUE(refused(sample("glTF2/MissingBin/BoxTextured.gltf"), "BoxTextured0.bin"));
  EXPECT_TRUE(refused(sample("glTF2/RecursiveNodes/RecursiveNodes.gltf"), "recursive"));
  EXPECT_TRUE(refused(sample("glTF2/BoxWithInfinites-glTF-Binary/BoxWithInfinites.glb"), "finite"));
  EXPECT_TRUE(refused(sample("OFF/invalid.off"), "breaks off"));
}

TEST_F(Import, GltfMayNotReachOutOfItsFolder) {
  if (!fs::exists(sample("glTF2/BoxTextured-glTF/BoxTextured.gltf"))) GTEST_SKIP() << "assimp-testmodels is not installed";
  std::string text = slurp(sample("glTF2/BoxTextured-glTF/BoxTextured.gltf"));
  const std::string uri = "BoxTextured0.bin";
  const size_t at = text.find(uri);
  ASSERT_NE(at, std::string::npos);
  fs::create_directories(folder_.file("inner"));
  fs::copy_file(sample("glTF2/BoxTextured-glTF/BoxTextured0.bin"), folder_.file(uri));
  std::ofstream(folder_.file("inner/box.gltf")) << std::string(text).insert(at, "../");
  EXPECT_THROW(load_mesh(folder_.file("inner/box.gltf")), InputError);
  fs::copy_file(folder_.file(uri), folder_.path() / "inner" / uri);
  std::ofstream(folder_.file("inner/box.gltf")) << text;
  EXPECT_EQ(load_mesh(folder_.file("inner/box.gltf")).face_count(), 12u);
}

TEST_F(Import, SpotRefinesToTheKnownCounts) {
  const fs::path file = fs::path(LIMN_TEST_DATA) / "spot_control_mesh.obj";
  const Mesh cage = load_mesh(file);
  EXPECT_EQ(cage.vertex_count(), 188u);
  EXPECT_EQ(cage.face_count(), 180u);
  const Mesh mesh = refine(cage, {Scheme::catmark, 2}, file.string());
  EXPECT_EQ(mesh.vertex_count(), 2930u);
  EXPECT_EQ(mesh.face_count(), 2928u);
}

TEST_F(Import, EveryModelLoadsAndTriangulates) {
  int models = 0;
  for (const auto& entry : fs::directory_iterator(LIMN_TEST_DATA)) {
    if (!is_mesh_file(entry.path())) continue;
    ++models;
    const Mesh mesh = load_mesh(entry.path());
    const TriangleMesh triangles = triangulate(mesh, NormalKind::vertex);
    EXPECT_GE(triangles.triangles.size(), mesh.face_count() - static_cast<size_t>(triangles.dropped_triangles)) << entry.path();
    for (const glm::vec3& n : triangles.corner_normals) ASSERT_NEAR(glm::length(n), 1.0f, 1e-5f) << entry.path();
  }
  EXPECT_GE(models, 4);
}

}  // namespace
}  // namespace limn
