// PLY: what its header may say, what its data may begin with, strips, colours, normals.
#include "subdiv/read_ply.h"

#include <gtest/gtest.h>

#include "mesh_encodings.h"
#include "sdf/color.h"

namespace limn {
namespace {

using test::has;
using test::kMostElements;
using test::put;
using test::refusal;
using test::warns;

Mesh read(const std::string& bytes) { return parse_ply(bytes, "file", kMostElements); }

std::string header(const std::string& elements, const char* format = "ascii") {
  return fmt::format("ply\nformat {} 1.0\n{}end_header\n", format, elements);
}
const std::string kVertices = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
const std::string kFaces = "element face 1\nproperty list uchar int vertex_indices\n";
const std::string kSquare = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

TEST(Ply, HeadersMayHaveSpacesCommentsAndOtherLineEnds) {
  const std::string plain = header(kVertices + kFaces) + kSquare + "4 0 1 2 3\n";
  EXPECT_EQ(read(plain).face_sizes, std::vector<std::int32_t>{4});
  std::string spaced =
      "ply \nformat  ascii\t1.0 \ncomment with # anything\nobj_info 12\nelement  vertex   4 \nproperty  float  x \n"
      "property float\ty\nproperty float z\nelement face 1\nproperty  list  uchar  int  vertex_index \nend_header \n";
  EXPECT_EQ(read(spaced + kSquare + "4 0 1 2 3\n").face_sizes, std::vector<std::int32_t>{4});
  for (const char* end : {"\r\n", "\r"}) {
    std::string other;
    for (const char c : plain) other += c == '\n' ? std::string(end) : std::string(1, c);
    EXPECT_EQ(read(other).face_sizes, std::vector<std::int32_t>{4});
  }
  EXPECT_EQ(read("\xEF\xBB\xBF" + plain).face_count(), 1u);
  std::string uncommented = plain;
  uncommented.insert(uncommented.find("element"), "Created by an old exporter\n");
  EXPECT_TRUE(warns(read(uncommented), {"line 3", "Created"}));
}

/// Binary data may begin with any byte; a line feed among them is no line end.
TEST(Ply, BinaryDataMayBeginWithALineEnd) {
  for (const char* end : {"\n", "\r\n", "\r"})
    for (const char first : {'\n', '\r', ' ', '#'}) {
      Mesh mesh = test::tetrahedron();
      std::memcpy(&mesh.positions[0].x, std::string(1, first).data(), 1);
      std::string bytes = test::binary_ply(mesh), other;
      const size_t data = bytes.find("end_header\n") + 11;
      for (size_t i = 0; i < data; ++i) other += bytes[i] == '\n' ? std::string(end) : std::string(1, bytes[i]);
      const Mesh back = read(other + bytes.substr(data));
      EXPECT_EQ(back.corner_vertices, mesh.corner_vertices);
      EXPECT_EQ(back.positions[0], mesh.positions[0]);
      EXPECT_TRUE(back.warnings.empty());
    }
}

TEST(Ply, EveryTypeIsReadInEitherByteOrder) {
  const std::vector<std::string> types{"char",  "uchar",  "short", "ushort", "int",     "uint",
                                       "float", "double", "int8",  "uint16", "float32", "float64"};
  const auto put_as = [](std::string& bytes, const std::string& type, int value, bool swapped) {
    if (type == "char" || type == "int8") put(bytes, static_cast<std::int8_t>(value));
    if (type == "uchar") put(bytes, static_cast<std::uint8_t>(value));
    if (type == "short") put(bytes, static_cast<std::int16_t>(value), swapped);
    if (type == "ushort" || type == "uint16") put(bytes, static_cast<std::uint16_t>(value), swapped);
    if (type == "int") put(bytes, static_cast<std::int32_t>(value), swapped);
    if (type == "uint") put(bytes, static_cast<std::uint32_t>(value), swapped);
    if (type == "float" || type == "float32") put(bytes, static_cast<float>(value), swapped);
    if (type == "double" || type == "float64") put(bytes, static_cast<double>(value), swapped);
  };
  for (const bool big : {false, true})
    for (const std::string& type : types)
      for (const std::string& count : types) {
        const bool whole_count = !count.starts_with("float") && count != "double";
        std::string bytes =
            header(fmt::format("element thing 2\nproperty {0} a\nproperty list uchar {0} b\nelement vertex 3\nproperty {0} z\n"
                               "property {0} x\nproperty {0} skipped\nproperty {0} y\nelement face 1\n"
                               "property list {1} {0} vertex_indices\n",
                               type, count),
                   big ? "binary_big_endian" : "binary_little_endian");
        for (int i = 0; i < 2; ++i) {
          put_as(bytes, type, 77, big);
          put(bytes, static_cast<unsigned char>(i));
          for (int k = 0; k < i; ++k) put_as(bytes, type, 55, big);
        }
        for (const int value : {3, 1, 9, 2, 6, 4, 9, 5, 6, 7, 9, 8}) put_as(bytes, type, value, big);
        put_as(bytes, count, 3, big);
        for (const int v : {2, 0, 1}) put_as(bytes, type, v, big);
        if (!whole_count) {
          EXPECT_TRUE(has(refusal(parse_ply, bytes), "file:12")) << count;
          continue;
        }
        const Mesh mesh = read(bytes);
        EXPECT_EQ(mesh.positions, (std::vector<glm::dvec3>{{1, 2, 3}, {4, 5, 6}, {7, 8, 6}})) << type << ", " << count << ", " << big;
        EXPECT_EQ(mesh.corner_vertices, (std::vector<std::int32_t>{2, 0, 1})) << type << ", " << count << ", " << big;
        EXPECT_TRUE(mesh.warnings.empty());
      }
}

TEST(Ply, StripsBecomeTrianglesThatFaceOneWay) {
  // Two rows of a grid as one strip each, -1 between them, and a triangle with a repeated corner that leads from one to the other.
  const std::string strips = "element tristrips 1\nproperty list int int vertex_indices\n";
  const std::string points = "element vertex 6\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string six = "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n1 2 0\n";
  const auto all_up = [](const Mesh& mesh) {
    size_t up = 0;
    test::each_face(mesh, [&](auto face) {
      const auto at = [&](size_t i) { return mesh.positions[static_cast<size_t>(face[i])]; };
      up += glm::cross(at(1) - at(0), at(2) - at(0)).z == 1.0;
    });
    return up == mesh.face_count();
  };
  for (const char* list : {"6 0 1 2 3 4 5", "9 0 1 2 3 -1 2 3 4 5", "10 0 1 2 3 3 2 2 3 4 5", "5 -1 0 1 2 3"}) {
    const Mesh mesh = read(header(points + strips) + six + list + "\n");
    EXPECT_EQ(mesh.face_count(), list[0] == '5' ? 2u : 4u) << list;
    EXPECT_TRUE(all_up(mesh)) << list;
    EXPECT_TRUE(mesh.warnings.empty()) << list;
  }
  EXPECT_TRUE(warns(read(header(points + strips) + six + "4 0 1 2 9\n"), {"1 face", "vertex 9 of 6"}));
  const std::string unsigned_strips = "element tristrips 1\nproperty list int uint vertex_indices\n";
  const Mesh restarted = read(header(points + unsigned_strips) + six + "9 0 1 2 3 4294967295 2 3 4 5\n");
  EXPECT_EQ(restarted.face_count(), 4u);
  EXPECT_TRUE(all_up(restarted) && restarted.warnings.empty());
}

TEST(Ply, ColoursAndNormalsAreRead) {
  const std::string elements =
      "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty uchar diffuse_red\nproperty uchar "
      "diffuse_green\nproperty uchar diffuse_blue\nproperty float nx\nproperty float ny\nproperty float nz\n";
  const Mesh mesh =
      read(header(elements + kFaces) + "0 0 0 255 0 128 0 0 2\n1 0 0 0 0 0 0 0 2\n1 1 0 0 0 0 3 0 4\n0 1 0 0 0 0 nan 0 1\n4 0 1 2 3\n");
  EXPECT_EQ(mesh.vertex_colors.at(0), glm::vec3(1.0f, 0.0f, linear_from_srgb(128.0f / 255.0f)));
  EXPECT_EQ(mesh.corner_normals.at(0), glm::vec3(0, 0, 1));
  EXPECT_EQ(mesh.corner_normals.at(2), glm::vec3(0.6f, 0, 0.8f));
  EXPECT_EQ(mesh.corner_normals.at(3), glm::vec3(0)) << "one that is no number is found from the faces";
  const Mesh real =
      read(header("element vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty float r\nproperty float g\n"
                  "property float b\n" +
                  kFaces) +
           "0 0 0 1 0 0.5\n1 0 0 2 0 -1\n1 1 0 0 0 0\n0 1 0 0 0 0\n4 0 1 2 3\n");
  EXPECT_EQ(real.vertex_colors.at(0), glm::vec3(1.0f, 0.0f, linear_from_srgb(0.5f)));
  EXPECT_EQ(real.vertex_colors.at(1), glm::vec3(1.0f, 0.0f, 0.0f));
  for (const char* type : {"float", "double", "int", "uint"}) {
    const std::string colors = fmt::format("property {0} red\nproperty {0} green\nproperty {0} blue\n", type);
    const Mesh bytes = read(header("element vertex 4\nproperty float x\nproperty float y\nproperty float z\n" + colors + kFaces) +
                            "0 0 0 255 0 128\n1 0 0 2 0 1\n1 1 0 0 0 0\n0 1 0 0 0 0\n4 0 1 2 3\n");
    EXPECT_EQ(bytes.vertex_colors.at(0), glm::vec3(1.0f, 0.0f, linear_from_srgb(128.0f / 255.0f))) << type;
  }
}

TEST(Ply, FaultsAreNamed) {
  const std::string good = header(kVertices + kFaces) + kSquare;
  EXPECT_TRUE(has(refusal(parse_ply, header(kVertices) + kSquare), "a point cloud of 4 vertices"));
  EXPECT_TRUE(has(refusal(parse_ply, good + "4 0 1 2\n"), "breaks off"));
  EXPECT_TRUE(has(refusal(parse_ply, good + "4 0 1 2 x\n"), "file:14"));
  EXPECT_TRUE(has(refusal(parse_ply, good + "4 0 1 2 2.5\n"), "not a vertex number"));
  EXPECT_TRUE(has(refusal(parse_ply, header(kVertices + kFaces) + "1.#QNAN 0 0\n" + kSquare), "file:10")) << "PLY has no comments";
  EXPECT_TRUE(has(refusal(parse_ply, good + "-4 0 1 2 3\n"), "not the length of a list"));
  EXPECT_TRUE(has(refusal(parse_ply, good + "4 0 1 2 3 255 0 0\n"), "goes on"));
  EXPECT_TRUE(has(refusal(parse_ply, good + "3 0 1 9\n"), "out of range"));
  EXPECT_TRUE(warns(read(good + "4 0 1 2 3\n4 3 2 1 0\n"), {"bytes after the last element"}));
  EXPECT_TRUE(has(refusal(parse_ply, header("element vertex 4\nproperty float x\n" + kFaces) + kSquare), "no x and y"));
  EXPECT_TRUE(has(refusal(parse_ply, header(kVertices + "element face 1\nproperty float vertex_indices\n") + kSquare + "1\n"), "no list"));
  EXPECT_TRUE(has(refusal(parse_ply, header("property float x\n")), "file:3"));
  EXPECT_TRUE(has(refusal(parse_ply, header("element vertex many\n")), "file:3"));
  EXPECT_TRUE(has(refusal(parse_ply, header("element vertex 4\nproperty long x\n")), "file:4"));
  EXPECT_TRUE(has(refusal(parse_ply, "ply\nformat utf8 1.0\n"), "file:2"));
  EXPECT_TRUE(has(refusal(parse_ply, "ply\nelement vertex 3\n"), "header"));
  EXPECT_TRUE(has(refusal(parse_ply, "polygon\n"), "not a PLY"));
  // The last line of the header is the file's last, and has no end.
  for (const char* format : {"ascii", "binary_little_endian"}) {
    const std::string bare = header("element vertex 0\nproperty float x\nproperty float y\n", format);
    EXPECT_TRUE(has(refusal(parse_ply, bare.substr(0, bare.size() - 1)), "no faces")) << format;
  }
  // What no file can hold takes no memory and no time.
  for (const char* format : {"ascii", "binary_little_endian"}) {
    const std::string many = "element vertex 9000000000000000000\nproperty float x\nproperty float y\n";
    EXPECT_TRUE(has(refusal(parse_ply, header(many, format)), "breaks off")) << format;
    EXPECT_TRUE(has(refusal(parse_ply, header("element none 9000000000000000000\n", format)), "no faces")) << format;
  }
  std::string endless = header(kFaces, "binary_little_endian");
  endless.replace(endless.find("uchar"), 5, "uint");
  put(endless, std::uint32_t{0xFFFFFFFF});
  EXPECT_TRUE(has(refusal(parse_ply, endless), "breaks off"));
}

}  // namespace
}  // namespace limn
