// OBJ: the habits of the programs that write it, tags of cages, smoothing groups.
#include "subdiv/read_obj.h"

#include <gtest/gtest.h>

#include "mesh_encodings.h"
#include "sdf/color.h"
#include "subdiv/import.h"
#include "tests/temporary_folder.h"

namespace limn {
namespace {

using test::has;
using test::kMostElements;
using test::refusal;
using test::warns;

Mesh read(const std::string& text) { return parse_obj(text, "file", kMostElements); }

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
const std::vector<glm::dvec3> kCorners{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};

std::string utf16(const std::string& text, bool big_endian) {
  std::string bytes = big_endian ? "\xFE\xFF" : "\xFF\xFE";
  for (const char c : text) bytes += big_endian ? std::string{'\0', c} : std::string{c, '\0'};
  return bytes;
}

TEST(Obj, TextComesInManyEncodings) {
  const std::string text = kSquare + "g name\nf 1 2 3 4\ng other\nf 1 3 2\n";
  std::string carriage = text;
  std::replace(carriage.begin(), carriage.end(), '\n', '\r');
  for (const std::string& other : {"\xEF\xBB\xBF" + text, utf16(text, true), utf16(text, false), carriage, text + std::string(5, '\0')}) {
    const Mesh mesh = read(other);
    EXPECT_EQ(mesh.positions, kCorners);
    EXPECT_EQ(mesh.face_sizes, (std::vector<std::int32_t>{4, 3}));
    EXPECT_EQ(mesh.group_names, (std::vector<std::string>{"name", "other"}));
    EXPECT_TRUE(mesh.warnings.empty());
  }
  // An umlaut and a letter beyond 16 bits, in a name.
  std::string named = utf16(kSquare + "o ", false);
  named += std::string("\xE4\x00\x3D\xD8\x00\xDE\n\0f\0 \0\x31\0 \0\x32\0 \0\x33\0", 22);
  EXPECT_EQ(read(named).group_names.at(0), "\xC3\xA4\xF0\x9F\x98\x80");
}

TEST(Obj, ABackslashAtTheEndOfACommentJoinsNothing) {
  const Mesh mesh = read("# exported to C:\\out\\\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 \\\n3 4\n");
  EXPECT_EQ(mesh.positions, kCorners);
  EXPECT_EQ(mesh.face_sizes, (std::vector<std::int32_t>{4}));
}

TEST(Obj, LinesEndInEveryWayWithinOneFile) {
  const Mesh mesh = read("# by two programs\nv 0 0 0\rv 1 0 0\r\nv 1 1 0\rv 0 1 0\nf 1 2 3\rf 1 3 4\r\n");
  EXPECT_EQ(mesh.positions, kCorners);
  EXPECT_EQ(mesh.face_sizes, (std::vector<std::int32_t>{3, 3}));
}

TEST(Obj, ColoursFollowThePositionUpTo1OrTo255) {
  for (const char* colors : {"1 0 0.5", "255 0 127.5", "1 0 0.5 1"}) {
    const Mesh mesh = read(std::string("v 0 0 0 ") + colors + "\nv 1 0 0 0 0 0\nv 1 1 0 0 0 0\nf 1 2 3\n");
    EXPECT_EQ(mesh.vertex_colors.at(0), glm::vec3(1.0f, 0.0f, linear_from_srgb(0.5f))) << colors;
  }
}

TEST(Obj, NamesThatAreWrittenCannotBecomeStatements) {
  Mesh mesh = test::cube();
  mesh.group_names = {"C:\\parts\\", "a\nv 0 0 0"};
  mesh.face_groups.assign(mesh.face_count(), 0);
  mesh.face_groups.back() = 1;
  const TemporaryFolder folder;
  write_mesh(mesh, folder.path() / "named.obj");
  const Mesh again = load_mesh(folder.path() / "named.obj");
  EXPECT_EQ(again.positions, mesh.positions);
  EXPECT_EQ(again.face_sizes, mesh.face_sizes);
  EXPECT_EQ(again.group_names, (std::vector<std::string>{"C:\\parts_", "a_v 0 0 0"}));
}

TEST(Obj, CommentsMayFollowAnyStatement) {
  const Mesh mesh =
      read("v 0 0 0 # first\nv 1 0 0#second\nv 1 1 0 1.0 # with a weight\nv 0 1 0\nf 1 2 3 4 # face\nf 1 2 3# once more\ng a#b\nf 2 3 4\n");
  EXPECT_EQ(mesh.positions, kCorners);
  EXPECT_EQ(mesh.face_sizes, (std::vector<std::int32_t>{4, 3, 3}));
  EXPECT_EQ(mesh.group_names, (std::vector<std::string>{"a#b", ""}));
}

TEST(Obj, IndicesWithoutTheirElementsAreIgnoredWithOneWarning) {
  const Mesh both = read(kSquare + "f 1/1/1 2/2/2 3/3/3 4/4/4\n");
  EXPECT_TRUE(both.corner_normals.empty());
  ASSERT_EQ(both.warnings.size(), 1u);
  EXPECT_TRUE(warns(both, {"4 corners", "normals and texture coordinates"})) << both.warnings[0];
  EXPECT_TRUE(warns(read(kSquare + "f 1//1 2//2 3//3\n"), {"3 corners", "normals"}));
  EXPECT_TRUE(warns(read(kSquare + "f 1/1 2/2 3/3\n"), {"3 corners", "texture coordinates"}));
  EXPECT_TRUE(warns(read(kSquare + "vn 0 0 1\nf 1//1 2//1 3//9\n"), {"1 of 3 corners"}));
  EXPECT_TRUE(read(kSquare + "vt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\nf 1/ 2/ 3/\n").corner_normals.empty());
  const Mesh good = read(kSquare + "vt 0 0\nvn 0 0 1\nvn 1 0 0\nf 1/1/1 2/1/1 3//-1\n");
  EXPECT_EQ(good.corner_normals, (std::vector<glm::vec3>{{0, 0, 1}, {0, 0, 1}, {1, 0, 0}}));
  EXPECT_TRUE(good.warnings.empty());
  const Mesh bad = read(kSquare + "vn 0 0 1\nvn nan nan nan\nf 1//1 2//2 3//1\n");
  EXPECT_EQ(bad.corner_normals.at(1), glm::vec3(0));
  EXPECT_TRUE(warns(bad, {"1 of 2 normals"}));
}

TEST(Obj, FlatMeshesAndNumbersThatAreNone) {
  const Mesh flat = read("v 0 0\nv 1 0\nv 1 1\nv 0 1\nf 1 2 3 4\n");
  EXPECT_EQ(flat.positions, kCorners);
  EXPECT_TRUE(has(refusal(parse_obj, "v 0 0 0\nv 1 0\nv 1 1 0\nf 1 2 3\n"), "file:2"));
  EXPECT_TRUE(has(refusal(parse_obj, "v 0 0 0\nv 1 0 3.1+e2\nv 1 1 0\nf 1 2 3\n"), "file:2"));
  EXPECT_TRUE(has(refusal(parse_obj, "v 0 0 0\nv 1 0 3.1+e2\nv 1 1 0\nf 1 2 3\n"), "3.1+e2"));
  EXPECT_EQ(read("v 0 0 1e-400\nv 1 0 0\nv 1 1 0\nf 1 2 3\n").positions[0].z, 0.0);
}

TEST(Obj, FilesThatCountFromZeroAreReadSo) {
  const Mesh mesh = read(kSquare + "vn 0 0 1\nf 0//0 1//0 2//0 3//0\n");
  EXPECT_EQ(mesh.corner_vertices, (std::vector<std::int32_t>{0, 1, 2, 3}));
  EXPECT_EQ(mesh.corner_normals.at(0), glm::vec3(0, 0, 1));
  EXPECT_TRUE(warns(mesh, {"from 0"}));
  // The last vertex is named: only the face with the 0 is wrong.
  const Mesh other = read(kSquare + "f 0 1 2\nf 2 3 4\n");
  EXPECT_EQ(other.corner_vertices, (std::vector<std::int32_t>{1, 2, 3}));
  EXPECT_TRUE(warns(other, {"1 face", "line 5"})) << other.warnings.at(0);
}

TEST(Obj, TagsOfCagesAreRead) {
  const std::string faces = "f 1 2 3 4\nf 4 3 2 1\nf 1 2 3\nf 1 1 1\nf 1 3 4\n";
  const Mesh mesh = read(kSquare + faces +
                         "t hole 2/0/0 4 1\nt hole 1/0/0 1\nt creasemethod 0/0/1 chaikin\nt smoothtriangles 0/0/1 smooth\n"
                         "t facevaryinginterpolateboundary 1/0/0 1\nt facevaryingpropagatecorners 1/0/0 1\n"
                         "t faceedit 1/2/3 1 2\nt faceedit 4 5\nt wrinkle\n");
  EXPECT_EQ(mesh.holes, (std::vector<std::int32_t>{1, 3})) << "face 4 is dropped, and 5 moves up";
  EXPECT_EQ(mesh.crease_method, CreaseMethod::chaikin);
  EXPECT_EQ(mesh.triangle_rule, TriangleRule::smooth);
  EXPECT_TRUE(warns(mesh, {"t faceedit", "2 times"}));
  EXPECT_TRUE(warns(mesh, {"t wrinkle", "1 time"}));
  EXPECT_EQ(mesh.warnings.size(), 3u) << "and the face that was dropped";
  const Mesh bare = read(kSquare + "f 1 2 3\nt creasemethod chaikin\nt smoothtriangles smooth\n");
  EXPECT_EQ(bare.crease_method, CreaseMethod::chaikin);
  EXPECT_EQ(bare.triangle_rule, TriangleRule::smooth);
  const Mesh normal = read(kSquare + "f 1 2 3\nt creasemethod chaikin\nt creasemethod 0/0/1 normal\nt smoothtriangles normal\n");
  EXPECT_EQ(normal.crease_method, CreaseMethod::uniform);
  EXPECT_EQ(normal.triangle_rule, TriangleRule::catmark);
  EXPECT_TRUE(has(refusal(parse_obj, kSquare + "f 1 2 3\nt hole 1/0/0 1\n"), "face index out of range"));
  EXPECT_TRUE(has(refusal(parse_obj, kSquare + "f 1 2 3\nt hole 1/0/0 -1\n"), "face index out of range"));
  EXPECT_TRUE(has(refusal(parse_obj, kSquare + "f 1 2 3\nt creasemethod 0/0/1 straight\n"), "file:6"));
  EXPECT_TRUE(has(refusal(parse_obj, kSquare + "f 1 2 3\nt hole 2/0/0 1\n"), "file:6"));
}

TEST(Obj, SmoothingGroupsAreKept) {
  EXPECT_TRUE(read(kSquare + "f 1 2 3\n").face_smoothing.empty());
  const Mesh mesh = read(kSquare + "f 1 2 3\ns 1\nf 1 3 4\ns off\nf 1 2 4\ns 7\ns 0\nf 2 3 4\ns on\nf 4 3 2\n");
  EXPECT_EQ(mesh.face_smoothing, (std::vector<std::int32_t>{0, 1, 0, 0, 1}));
}

TEST(Obj, QuadsWithARepeatedCornerStay) {
  const Mesh mesh = read(kSquare + "f 1 2 3 3\nf 1 3 4 1\n");
  EXPECT_EQ(mesh.face_sizes, (std::vector<std::int32_t>{4, 4}));
  EXPECT_TRUE(mesh.warnings.empty());
}

TEST(Obj, WhatIsNoStatementIsSaid) {
  const Mesh mesh = read("mtllib a.mtl\nvt 0 0\nl 1 2\np 1\ncstype bspline\nusemap off\n" + kSquare + "f 1 2 3\nF 1 2 3\nwhat is this\n");
  EXPECT_TRUE(warns(mesh, {"2 lines", "'F'", "line 12"})) << mesh.warnings.at(0);
  EXPECT_EQ(mesh.warnings.size(), 1u);
  EXPECT_TRUE(warns(read(kSquare + "f 1 2 3\nsurf 0 1 0 1 1 2 3 4\n"), {"1 free-form"}));
}

}  // namespace
}  // namespace limn
