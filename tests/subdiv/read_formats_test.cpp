// What holds for every mesh format: the same mesh comes out of each, what breaks off is refused, what nothing can be drawn of is dropped
// and counted.
#include <gtest/gtest.h>

#include <cmath>

#include "mesh_encodings.h"
#include "subdiv/repair_faces.h"
#include "subdiv/text_cursor.h"

namespace limn {
namespace {

using test::has;
using test::kEncodings;
using test::kMostElements;
using test::refusal;
using test::warns;

/// Vertices anywhere, faces of 3 to 7 corners (or triangles) among them, none there twice.
Mesh random_mesh(std::mt19937& random, bool triangles) {
  Mesh mesh;
  const auto vertices = static_cast<std::int32_t>(8 + random() % 30);
  for (std::int32_t v = 0; v < vertices; ++v) {
    // Single precision, so that STL holds the same numbers.
    const auto coordinate = [&] { return static_cast<double>(std::ldexp(static_cast<float>(random()) - 2e9f, -20)); };
    const double x = coordinate(), y = coordinate(), z = coordinate();
    mesh.positions.emplace_back(x, y, z);
  }
  // Every vertex in its turn begins a face, so that STL meets all of them in this order.
  for (std::int32_t v = 0; v + 7 < vertices; ++v) {
    const auto size = static_cast<std::int32_t>(triangles ? 3 : 3 + random() % 5);
    mesh.face_sizes.push_back(size);
    for (std::int32_t k = 0; k < size; ++k) mesh.corner_vertices.push_back(v + k);
  }
  return mesh;
}

TEST(MeshFormats, RandomMeshesComeOutTheSameOfEveryEncoding) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    for (const test::Encoding& encoding : kEncodings) {
      std::mt19937 random(seed);
      const Mesh mesh = random_mesh(random, encoding.triangles_only);
      const Mesh back = encoding.parse(encoding.write(mesh), "file", kMostElements);
      EXPECT_EQ(back.face_sizes, mesh.face_sizes) << encoding.name << ", seed " << seed;
      EXPECT_EQ(back.corner_vertices, mesh.corner_vertices) << encoding.name << ", seed " << seed;
      EXPECT_TRUE(back.warnings.empty()) << encoding.name << ", seed " << seed << ": " << back.warnings.front();
      // STL has no vertices that no face uses.
      ASSERT_LE(back.vertex_count(), mesh.vertex_count());
      if (!encoding.triangles_only) {
        EXPECT_EQ(back.vertex_count(), mesh.vertex_count());
      }
      for (size_t v = 0; v < back.vertex_count(); ++v)
        ASSERT_EQ(back.positions[v], mesh.positions[v]) << encoding.name << ", seed " << seed;
    }
  }
}

/// Where the last word begins that is not white space: a number cut within itself is another number, which nobody can tell.
size_t last_word(const std::string& text) {
  const size_t end = text.find_last_not_of(" \n");
  return text.find_last_of(" \n", end) + 1;
}

TEST(MeshFormats, CutFilesAreErrors) {
  const Mesh mesh = test::sphere(1);
  for (const test::Encoding& encoding : kEncodings) {
    const std::string whole = encoding.write(mesh);
    ASSERT_EQ(refusal(encoding.parse, whole), "") << encoding.name;
    const bool obj = std::string(encoding.name) == "obj", binary = whole.find('\0') != std::string::npos;
    int refused = 0;
    for (size_t i = 1; i <= 60; ++i) {
      const size_t at = whole.size() * i / 61;
      if (obj || (!binary && at > last_word(whole))) continue;
      EXPECT_NE(refusal(encoding.parse, whole.substr(0, at)), "") << encoding.name << " cut at byte " << at << " of " << whole.size();
      ++refused;
    }
    EXPECT_GE(refused, obj ? 0 : 58) << encoding.name;
    if (!obj && binary) {
      EXPECT_NE(refusal(encoding.parse, whole.substr(0, whole.size() - 1)), "") << encoding.name;
    }
  }
}

TEST(MeshFormats, TextWithoutItsLastLineEndIsWhole) {
  const Mesh mesh = test::sphere(1);
  for (const test::Encoding& encoding : kEncodings) {
    std::string whole = encoding.write(mesh);
    if (whole.find('\0') != std::string::npos) continue;
    whole.pop_back();
    EXPECT_EQ(encoding.parse(whole, "file", kMostElements).face_count(), mesh.face_count()) << encoding.name;
    for (const std::string& rest : {std::string("\n\n"), std::string("  \n\t\n"), std::string("\r\n"), std::string("\n\0\0\0", 4)}) {
      const Mesh back = encoding.parse(whole + rest, "file", kMostElements);
      EXPECT_EQ(back.face_count(), mesh.face_count()) << encoding.name;
    }
  }
}

TEST(MeshFormats, ACutObjHoldsNoFaceThatItsWholeHasNot) {
  // OBJ has no end: what is cut between two lines is a smaller mesh. A face that lost corners is the last one and has 3 at least.
  const Mesh mesh = test::torus(6, 5, 2.0, 1.0);
  const std::string whole = test::text_obj(mesh);
  int read = 0;
  for (size_t at = 1; at < whole.size(); at += 3) {
    Mesh back;
    try {
      back = parse_obj(std::string_view(whole).substr(0, at), "file", kMostElements);
    } catch (const InputError&) {
      continue;
    }
    ++read;
    ASSERT_LE(back.face_count(), mesh.face_count());
    const size_t kept = back.face_count() - 1;
    ASSERT_GE(back.face_sizes.back(), 3);
    for (size_t c = 0; c < 4 * kept; ++c) ASSERT_EQ(back.corner_vertices[c], mesh.corner_vertices[c]) << "cut at " << at;
  }
  EXPECT_GT(read, 20);
  EXPECT_TRUE(has(refusal(parse_obj, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2"), "file:5")) << "a face cut to two corners";
  EXPECT_TRUE(has(refusal(parse_obj, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nv 1 2"), "file:5")) << "a vertex cut to two coordinates";
}

TEST(MeshFormats, ElementsBeyondTheLimitAreRefusedInEveryFormat) {
  const Mesh mesh = test::sphere(1);
  for (const test::Encoding& encoding : kEncodings) {
    try {
      encoding.parse(encoding.write(mesh), "file", 40);
      ADD_FAILURE() << encoding.name;
    } catch (const InputError& error) {
      EXPECT_TRUE(has(error.what(), "more vertices and corners")) << encoding.name << ": " << error.what();
    }
  }
}

/// A cube whose faces are spoilt: one names a vertex that is not there, two have too few corners, one is there three times.
Mesh spoilt_cube() {
  Mesh mesh = test::cube();
  test::add_face(mesh, {0, 1, 99});
  test::add_face(mesh, {3, 3, 4, 3});
  test::add_face(mesh, {0, 2, 3, 1});  // the first once more
  test::add_face(mesh, {3, 1, 0, 2});  // and again, begun elsewhere
  test::add_face(mesh, {1, 3, 2, 0});  // its back: stays
  test::add_face(mesh, {0, 0, 2, 3});  // a triangle as a quad: stays
  test::add_face(mesh, {5, 5, 5});
  return mesh;
}

TEST(MeshFormats, FacesThatCannotBeDrawnAreDroppedAndCounted) {
  for (const test::Encoding& encoding : kEncodings) {
    if (encoding.triangles_only) continue;
    const Mesh mesh = encoding.parse(encoding.write(spoilt_cube()), "file", kMostElements);
    EXPECT_EQ(mesh.face_sizes, (std::vector<std::int32_t>(8, 4))) << encoding.name;
    EXPECT_EQ(std::vector<std::int32_t>(mesh.corner_vertices.end() - 8, mesh.corner_vertices.end()),
              (std::vector<std::int32_t>{1, 3, 2, 0, 0, 0, 2, 3}))
        << encoding.name;
    EXPECT_EQ(mesh.warnings.size(), 3u) << encoding.name;
    EXPECT_TRUE(warns(mesh, {"1 face", "not there", "of 8", "dropped"})) << encoding.name << ": " << mesh.warnings.at(0);
    EXPECT_TRUE(warns(mesh, {"2 faces", "fewer than 3 corners", "dropped"})) << encoding.name << ": " << mesh.warnings.at(1);
    EXPECT_TRUE(warns(mesh, {"2 faces", "same vertices", "dropped"})) << encoding.name << ": " << mesh.warnings.at(2);
  }
  const Mesh obj = parse_obj(test::text_obj(spoilt_cube()), "file", kMostElements);
  EXPECT_TRUE(warns(obj, {"vertex 100 of 8", "line 15"})) << obj.warnings.at(0);
}

TEST(MeshFormats, WhatBelongsToADroppedFaceGoesWithIt) {
  Mesh mesh = spoilt_cube();
  const auto faces = static_cast<std::int32_t>(mesh.face_count());
  for (std::int32_t f = 0; f < faces; ++f) {
    mesh.face_groups.push_back(f);
    mesh.face_materials.push_back(f + 100);
    mesh.face_smoothing.push_back(f + 200);
    for (std::int32_t c = 0; c < mesh.face_sizes[static_cast<size_t>(f)]; ++c) mesh.corner_normals.emplace_back(f, c, 0);
  }
  mesh.holes = {1, 6, 8, 10, 11};
  repair_faces(mesh, {.file = "file"});
  const std::vector<std::int32_t> kept{0, 1, 2, 3, 4, 5, 10, 11};
  EXPECT_EQ(mesh.face_groups, kept);
  for (size_t i = 0; i < kept.size(); ++i) {
    EXPECT_EQ(mesh.face_materials[i], kept[i] + 100);
    EXPECT_EQ(mesh.face_smoothing[i], kept[i] + 200);
    for (size_t c = 0; c < 4; ++c) EXPECT_EQ(mesh.corner_normals[4 * i + c], glm::vec3(kept[i], c, 0));
  }
  EXPECT_EQ(mesh.holes, (std::vector<std::int32_t>{1, 6, 7}));
}

TEST(MeshFormats, AMeshWithoutAFaceThatCanBeDrawnSaysWhy) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  EXPECT_TRUE(has(refusal(parse_obj, vertices), "a point cloud of 3 vertices"));
  EXPECT_TRUE(has(refusal(parse_obj, vertices + "l 1 2\nl 2 3\n"), "only 2 statements of lines"));
  EXPECT_TRUE(has(refusal(parse_obj, vertices + "f 1 1 2\nf 2 2 2\n"), "file:4"));
  EXPECT_TRUE(has(refusal(parse_off, "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n"), "out of range"));
}

TEST(MeshFormats, AMillionFacesAboutOneVertexAreComparedInNoTime) {
  // Faces that share their smallest vertex are the costly case of looking for repeated ones.
  Mesh mesh;
  mesh.positions.resize(300'001);
  for (std::int32_t v = 1; v < 300'000; ++v) test::add_face(mesh, {0, v, v + 1});
  test::add_face(mesh, {1, 2, 0});
  repair_faces(mesh, {.file = "file"});
  EXPECT_EQ(mesh.face_count(), 299'999u);
  EXPECT_TRUE(warns(mesh, {"1 face", "same vertices"}));
}

TEST(TextCursor, NumbersAndWordsAndLines) {
  TextCursor cursor("  +1.5# a comment\n\t-2e3 7x .5\r\n");
  double value = 0.0;
  EXPECT_TRUE(read_real(cursor, value));
  EXPECT_EQ(value, 1.5);
  EXPECT_FALSE(cursor.skip_in_line());
  EXPECT_TRUE(read_real(cursor, value));
  EXPECT_EQ(value, -2e3);
  EXPECT_FALSE(read_real(cursor, value)) << "a number with a letter behind it";
  EXPECT_EQ(cursor.word(), "7x");
  EXPECT_TRUE(read_real(cursor, value));
  EXPECT_EQ(value, 0.5);
  EXPECT_FALSE(cursor.skip());
  for (const char* bad : {"3.1+e2", "+-1", "1,5", "--1", "0x10", "1e999", "-1e999", "e5", "."}) {
    TextCursor word(bad);
    EXPECT_FALSE(read_real(word, value)) << bad;
  }
  TextCursor tiny("1e-400");
  EXPECT_TRUE(read_real(tiny, value));
  EXPECT_EQ(value, 0.0);
  const std::string_view text = "a\nb\r\nc\rd";
  EXPECT_EQ(line_of(text, text.data()), 1);
  EXPECT_EQ(line_of(text, text.data() + 2), 2);
  EXPECT_EQ(line_of(text, text.data() + 5), 3);
  EXPECT_EQ(line_of(text, text.data() + 7), 4);
}

}  // namespace
}  // namespace limn
