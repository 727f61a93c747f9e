// OFF: comments anywhere, faces with colours and over several lines, every kind of vertex.
#include "subdiv/read_off.h"

#include <gtest/gtest.h>

#include <bit>

#include "mesh_encodings.h"
#include "sdf/color.h"

namespace limn {
namespace {

using test::has;
using test::kMostElements;
using test::refusal;
using test::warns;

Mesh read(const std::string& bytes) { return parse_off(bytes, "file", kMostElements); }

const std::string kSquare = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
const std::vector<glm::dvec3> kCorners{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};

TEST(Off, CommentsMayBeAnywhere) {
  const Mesh mesh = read(
      "# by somebody\n#\n\nOFF # the word\n# counts\n4 2 5 # of them\n\n# 4 vertices\n0 0 0#red\n1 0 0\n# between\n1 1 0\n0 1 0 # last\n\n"
      "# 2 facets\n3 0 1 2\n# between\n3 0 2 3 # end\n# more\n");
  EXPECT_EQ(mesh.positions, kCorners);
  EXPECT_EQ(mesh.corner_vertices, (std::vector<std::int32_t>{0, 1, 2, 0, 2, 3}));
  EXPECT_TRUE(mesh.warnings.empty());
}

TEST(Off, FacesMayHaveColoursAndBeOverSeveralLines) {
  for (const char* faces :
       {"3 0 1 2 255 0 0\n3 0 2 3 0 0 255 255\n", "3 0 1 2 0.9 0 0   #red\n3 0 2 3 7 # index\n", "3\n0 1\n2\n3 0\n\n2 3 1 0 0\n"}) {
    const Mesh mesh = read("OFF\n4 2 0\n" + kSquare + faces);
    EXPECT_EQ(mesh.corner_vertices, (std::vector<std::int32_t>{0, 1, 2, 0, 2, 3})) << faces;
    EXPECT_TRUE(mesh.warnings.empty());
  }
}

TEST(Off, TheHeaderMayBeSpreadOrShort) {
  const std::string faces = "4 0 1 2 3\n";
  for (const char* head : {"OFF\n4 1 0\n", "OFF 4 1 0\n", "4 1 0\n", "OFF\n4 1\n", "OFF\n4\n1\n0\n", "off\r\n4 1 0\r\n", "OFF\n\n4 1 12 \n",
                           "\xEF\xBB\xBFOFF\n4 1 0\n"})
    EXPECT_EQ(read(head + kSquare + faces).positions, kCorners) << head;
}

TEST(Off, AListOfEdgesIsReadPastAndOtherRestsAreSaid) {
  const std::string body = kSquare + "4 0 1 2 3\n";
  EXPECT_TRUE(read("OFF\n4 1 2\n" + body + "0 1\n1 2\n").warnings.empty());
  EXPECT_TRUE(warns(read("OFF\n4 1 0\n" + body + "4 3 2 1 0\n"), {"line 8", "1 face"}));
  // Edges as faces with two corners.
  const Mesh mesh = read("OFF\n4 3 0\n" + kSquare + "2 0 1\n4 0 1 2 3\n2 1 2\n");
  EXPECT_EQ(mesh.face_count(), 1u);
  EXPECT_TRUE(warns(mesh, {"2 faces", "fewer than 3 corners"}));
}

TEST(Off, VerticesMayHaveNormalsColoursTextureAndOtherDimensions) {
  const std::string face = "3 0 1 2\n";
  const auto check = [&](const std::string& text) {
    const Mesh mesh = read(text + face);
    EXPECT_EQ(mesh.positions, (std::vector<glm::dvec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}})) << text;
    EXPECT_TRUE(mesh.warnings.empty()) << text;
    return mesh;
  };
  const Mesh normals = check("NOFF\n3 1 0\n0 0 0 0 0 2\n1 0 0 0 0 1\n1 1 0 3 0 4\n");
  EXPECT_EQ(normals.corner_normals.at(2), glm::vec3(0.6f, 0.0f, 0.8f));
  for (const char* colors : {"0 0 0 255 0 128 255\n1 0 0 0 0 0 255\n1 1 0 0 0 0 255\n", "0 0 0 255 0 128\n1 0 0 0 0 0\n1 1 0 0 0 0\n"}) {
    const Mesh mesh = check(std::string("COFF\n3 1 0\n") + colors);
    EXPECT_EQ(mesh.vertex_colors.at(0), glm::vec3(1.0f, 0.0f, linear_from_srgb(128.0f / 255.0f)));
  }
  EXPECT_EQ(check("COFF\n3 1 0\n0 0 0 1 0 0.5 1\n1 0 0 0 0 0 1\n1 1 0 0 0 0 1\n").vertex_colors.at(0),
            glm::vec3(1.0f, 0.0f, linear_from_srgb(0.5f)));
  const Mesh all = check("STCNOFF\n3 1 0\n0 0 0 0 0 1 1 0 0 1 0.5 0.5\n1 0 0 0 0 1 1 0 0 1 0.5 0.5\n1 1 0 0 0 1 1 0 0 1 0.5 0.5\n");
  EXPECT_EQ(all.vertex_colors.size(), 3u);
  EXPECT_EQ(all.corner_normals.size(), 3u);
  check("STOFF\n3 1 0\n0 0 0 7 8\n1 0 0 7 8\n1 1 0 7 8\n");
  check("4OFF\n3 1 0\n0 0 0 1\n2 0 0 2\n0.5 0.5 0 0.5\n");
  check("nOFF\n2\n3 1 0\n0 0\n1 0\n1 1\n");
  check("4nOFF 2\n3 1 0\n0 0 5\n1 0 1\n2 2 2\n");
}

/// Numbers of 32 bits, the highest byte first.
struct Binary {
  std::string bytes;
  Binary& whole(std::initializer_list<std::int32_t> values) {
    for (const std::int32_t value : values)
      for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(static_cast<std::uint32_t>(value) >> shift & 255u);
    return *this;
  }
  Binary& real(std::initializer_list<float> values) {
    for (const float value : values) whole({std::bit_cast<std::int32_t>(value)});
    return *this;
  }
};

TEST(Off, BinaryHoldsTheSameAsText) {
  const Mesh plain = read(Binary{"OFF BINARY\n"}
                              .whole({4, 2, 5})
                              .real({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0})
                              .whole({3, 0, 1, 2, 0, 3, 0, 2, 3, 4})
                              .real({1, 0, 0, 1})
                              .bytes);
  EXPECT_EQ(plain.positions, kCorners);
  EXPECT_EQ(plain.corner_vertices, (std::vector<std::int32_t>{0, 1, 2, 0, 2, 3}));
  EXPECT_TRUE(plain.warnings.empty());
  // Every kind of vertex at once, behind a line that ends as Windows ends it.
  const Mesh all = read(Binary{"STCN4nOFF BINARY\r\n"}
                            .whole({2, 3, 1, 0})
                            .real({0, 0, 1, 0, 0, 2, 1, 0, 0.5f, 1, 7, 8})
                            .real({2, 0, 2, 0, 0, 1, 0, 0, 0, 1, 7, 8})
                            .real({0.5f, 0.5f, 0.5f, 3, 0, 4, 0, 0, 0, 1, 7, 8})
                            .whole({3, 0, 1, 2, 0})
                            .bytes);
  EXPECT_EQ(all.positions, (std::vector<glm::dvec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}));
  EXPECT_EQ(all.corner_normals.at(2), glm::vec3(0.6f, 0.0f, 0.8f));
  EXPECT_EQ(all.vertex_colors.at(0), glm::vec3(1.0f, 0.0f, linear_from_srgb(0.5f)));
}

TEST(Off, BinaryCutAnywhereIsAnError) {
  const std::string whole = Binary{"COFF BINARY\n"}
                                .whole({3, 2, 0})
                                .real({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 1, 0, 1, 1, 1, 0, 0, 0, 1, 1})
                                .whole({3, 0, 1, 2, 1, 7, 3, 2, 1, 0, 0})
                                .bytes;
  EXPECT_EQ(read(whole).face_sizes.size(), 2u);
  for (size_t length = 0; length < whole.size(); ++length) EXPECT_FALSE(refusal(parse_off, whole.substr(0, length)).empty()) << length;
  EXPECT_TRUE(warns(read(whole + "more"), {"4 bytes", "2 faces"}));
  EXPECT_TRUE(has(refusal(parse_off, Binary{"OFF BINARY\n"}.whole({-1, 2, 0}).bytes), "no counts"));
  EXPECT_TRUE(has(refusal(parse_off, Binary{"OFF BINARY\n"}.whole({INT32_MAX, 2, 0}).bytes), "2147483647, as its header says"));
  EXPECT_TRUE(
      has(refusal(parse_off, Binary{"OFF BINARY\n"}.whole({1, 1, 0}).real({0, 0, 0}).whole({-3}).bytes), "not a number of corners"));
}

TEST(Off, LinesAfterTheFacesAreEdgesOrAreSaid) {
  const std::string faces = "OFF\n4 1 5\n" + kSquare + "3 0 1 2\n";
  EXPECT_TRUE(warns(read(faces + "3 0 2 3\n"), {"the last of the 1 faces"}));
  EXPECT_TRUE(read(faces + "0 1\n1 2\n2 0\n2 3\n3 0\n").warnings.empty());
}

TEST(Off, ColoursUnderAPlainWordAreColours) {
  const Mesh mesh = read("OFF\n3 1 0\n0 0 0 255 0 128\n1 0 0 0 0 0\n1 1 0 0 0 0\n3 0 1 2\n");
  EXPECT_EQ(mesh.positions, (std::vector<glm::dvec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}));
  EXPECT_EQ(mesh.vertex_colors.at(0), glm::vec3(1.0f, 0.0f, linear_from_srgb(128.0f / 255.0f)));
  EXPECT_TRUE(warns(mesh, {"3 numbers more than 'OFF' announces"}));
  // Two vertices on a line are no colours.
  EXPECT_EQ(read("OFF\n4 1 0\n0 0 0 1 0 0\n1 1 0 0 1 0\n4 0 1 2 3\n").positions, kCorners);
  // A little too bright is still real.
  EXPECT_EQ(read("COFF\n3 1 0\n0 0 0 1.001 0 0.5 1\n1 0 0 0 0 0 1\n1 1 0 0 0 0 1\n3 0 1 2\n").vertex_colors.at(0),
            glm::vec3(1.0f, 0.0f, linear_from_srgb(0.5f)));
}

TEST(Off, FaultsAreNamed) {
  EXPECT_TRUE(has(refusal(parse_off, "OFF\n4 2 0\n" + kSquare + "4 0 1 2 3\n"), "2, as its header says"));
  EXPECT_TRUE(has(refusal(parse_off, "OFF\n5 1 0\n" + kSquare), "got 4"));
  EXPECT_TRUE(has(refusal(parse_off, "OFF\n4 1 0\n0 0 0\n1 x 0\n"), "file:4"));
  EXPECT_TRUE(has(refusal(parse_off, "OFF\n4 1 0\n" + kSquare + "4 0 1 2 3.5\n"), "file:7"));
  EXPECT_TRUE(has(refusal(parse_off, "OFF\n4 1 0\n" + kSquare + "-3 0 1 2\n"), "not a number of corners"));
  EXPECT_TRUE(has(refusal(parse_off, "OFF\n4 1 0\n" + kSquare + "4 0 1 2 3 red\n"), "not part of a colour"));
  EXPECT_TRUE(has(refusal(parse_off, "OFF\n353535235358 6 0\n0 0 0\n"), "353535235358"));
  EXPECT_TRUE(has(refusal(parse_off, "OFF\n3 353535235358 0\n0 0 0\n1 0 0\n0 1 0\n"), "353535235358"));
  EXPECT_TRUE(has(refusal(parse_off, "OFF\n-1 6 0\n"), "not a count"));
  EXPECT_TRUE(has(refusal(parse_off, "OFF\n"), "header"));
  EXPECT_TRUE(has(refusal(parse_off, "OFF BINARY\n\1\2\3"), "header"));
  EXPECT_TRUE(has(refusal(parse_off, "nOFF 7\n"), "1 to 3 dimensions"));
  EXPECT_TRUE(has(refusal(parse_off, "ply\nformat ascii 1.0\n"), "not an OFF"));
  EXPECT_TRUE(has(refusal(parse_off, "4OFF\n3 1 0\n1 1 1 0\n1 0 0 1\n0 1 0 1\n3 0 1 2\n"), "not a finite number"));
  EXPECT_TRUE(has(refusal(parse_off, "OFF\n4 0 0\n" + kSquare), "a point cloud of 4"));
}

}  // namespace
}  // namespace limn
