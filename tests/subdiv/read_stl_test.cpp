// STL: text in any case, binary files whatever they begin with, vertices welded.
#include "subdiv/read_stl.h"

#include <gtest/gtest.h>

#include "mesh_encodings.h"

namespace limn {
namespace {

using test::has;
using test::kMostElements;
using test::refusal;
using test::warns;

Mesh read(const std::string& bytes) { return parse_stl(bytes, "file", kMostElements); }

const std::string kFacet = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
const std::string kOther = "facet normal 0 0 1\nouter loop\nvertex 1 0 0\nvertex 1 1 0\nvertex -0 1 0\nendloop\nendfacet\n";

TEST(Stl, EqualCornersBecomeOneVertexInTheOrderOfTheFile) {
  const Mesh mesh = read("solid\n" + kFacet + kOther + "endsolid\n");
  EXPECT_EQ(mesh.positions, (std::vector<glm::dvec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}));
  EXPECT_EQ(mesh.corner_vertices, (std::vector<std::int32_t>{0, 1, 2, 1, 3, 2})) << "-0 is 0";
  const Mesh sphere = test::sphere(3);
  EXPECT_EQ(read(test::ascii_stl(sphere)).vertex_count(), sphere.vertex_count());
  EXPECT_EQ(read(test::binary_stl(sphere)).vertex_count(), sphere.vertex_count());
}

TEST(Stl, TextIsReadInAnyCaseWithAnySpaces) {
  const std::string text = "solid a\n" + kFacet + kOther + "endsolid a\n";
  std::string capitals, wide, carriage;
  for (const char c : text) {
    capitals += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    wide += c == ' ' ? std::string(" \t  ") : c == '\n' ? std::string("\r\n\n  ") : std::string(1, c);
    carriage += c == '\n' ? '\r' : c;
  }
  for (const std::string& other : {capitals, wide, carriage, "\xEF\xBB\xBF" + text, "\n\n " + text})
    EXPECT_EQ(read(other).face_count(), 2u);
  EXPECT_EQ(read("solid facet vertex endsolid 1 2\n" + kFacet + "endsolid solid\n").face_count(), 1u) << "a name of keywords";
  std::string strange = kFacet;
  strange.replace(strange.find("0 0 1"), 5, "nan -1.#IND 7");
  EXPECT_EQ(read("solid a\n" + strange + "endsolid\n").face_count(), 1u) << "normals are not kept";
  std::string square = kFacet;
  square.insert(square.find("endloop"), "vertex -1 1 0\n");
  EXPECT_EQ(read("solid a\n" + square + "endsolid\n").face_sizes, std::vector<std::int32_t>{4});
}

TEST(Stl, SolidsAreGroups) {
  const Mesh mesh =
      read("solid left wing\n" + kFacet + "endsolid left wing\nsolid nothing\nendsolid\nsolid right\n" + kOther + "end solid\n");
  EXPECT_EQ(mesh.group_names, (std::vector<std::string>{"left wing", "right"}));
  EXPECT_EQ(mesh.face_groups, (std::vector<std::int32_t>{0, 1}));
  EXPECT_EQ(mesh.vertex_count(), 4u);
  EXPECT_TRUE(read("solid one\n" + kFacet + kOther + "endsolid\n").group_names.empty());
}

TEST(Stl, BinaryFilesAreToldByTheirSize) {
  const Mesh sphere = test::sphere(1);
  const std::string good = test::binary_stl(sphere);
  std::string named = good;
  named.replace(0, 14, "solid facet no");
  EXPECT_EQ(read(named).face_count(), sphere.face_count());
  std::string colored = good;
  colored.replace(0, 12, "COLOR=abcdef");
  colored[84 + 48] = '\x1f';
  EXPECT_EQ(read(colored).corner_vertices, read(good).corner_vertices);
  const Mesh longer = read(good + "made by somebody");
  EXPECT_EQ(longer.face_count(), sphere.face_count());
  EXPECT_TRUE(warns(longer, {"16 bytes after", std::to_string(sphere.face_count())}));
  EXPECT_EQ(read(named + std::string(7, '\0')).face_count(), sphere.face_count());
  std::string uncounted = good;
  uncounted.replace(80, 4, std::string(4, '\0'));
  EXPECT_EQ(read(uncounted).face_count(), sphere.face_count());
  EXPECT_TRUE(warns(read(uncounted), {"announces 0", std::to_string(sphere.face_count())}));
}

TEST(Stl, FaultsAreNamed) {
  EXPECT_TRUE(has(refusal(parse_stl, "solid a\n" + kFacet + kOther), "breaks off"));
  EXPECT_TRUE(has(refusal(parse_stl, "solid a\n" + kFacet + kOther), "2 whole facets"));
  EXPECT_TRUE(has(refusal(parse_stl, "solid a\n" + kFacet + "endsolid a\nrubbish\n"), "file:10"));
  EXPECT_TRUE(has(refusal(parse_stl, "solid a\n" + kFacet + "vertex 0 0 0\n"), "file:9"));
  EXPECT_TRUE(has(refusal(parse_stl, "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 zero 0\n"), "file:4"));
  EXPECT_TRUE(has(refusal(parse_stl, "solid a\nfacet normal 0 0 1\nvertex 0 0 0\n"), "'outer loop'"));
  EXPECT_TRUE(has(refusal(parse_stl, "solid a\nendsolid a\n"), "no faces"));
  EXPECT_TRUE(has(refusal(parse_stl, "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"), "not an STL"));
  const std::string good = test::binary_stl(test::sphere(1));
  EXPECT_TRUE(has(refusal(parse_stl, good.substr(0, good.size() - 60)), "breaks off"));
  std::string endless = good;
  endless.replace(80, 4, "\xFF\xFF\xFF\xFF");
  EXPECT_TRUE(has(refusal(parse_stl, endless), "4294967295"));
  std::string broken = good;
  const float nan = std::nanf("");
  std::memcpy(broken.data() + 84 + 12, &nan, sizeof nan);
  EXPECT_TRUE(has(refusal(parse_stl, broken), "not a finite number"));
  EXPECT_TRUE(has(refusal(parse_stl, broken), "facet 1"));
}

}  // namespace
}  // namespace limn
