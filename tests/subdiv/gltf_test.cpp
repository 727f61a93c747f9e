// glTF, made here as JSON with its data in base64: what is drawn of it, and what is refused with which reason.

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "sdf/error.h"
#include "subdiv/import.h"
#include "subdiv/read_gltf.h"
#include "tests/temporary_folder.h"

namespace limn {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

std::string base64(const std::string& bytes) {
  const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (size_t k = 0; k < 3; ++k) bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : letters[bits >> (18 - 6 * k) & 63];
  }
  return text;
}

template <class T>
std::string bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

/// A document with one buffer, to which views and accessors are added.
struct Maker {
  Json root = {{"asset", {{"version", "2.0"}}}, {"bufferViews", Json::array()}, {"accessors", Json::array()}};
  std::string data;

  int view(const std::string& bytes) {
    data.resize((data.size() + 3) / 4 * 4);
    root["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", data.size()}, {"byteLength", bytes.size()}});
    data += bytes;
    return static_cast<int>(root["bufferViews"].size()) - 1;
  }
  template <class T>
  int accessor(const std::vector<T>& values, int component, const std::string& type, size_t parts, bool normalized = false) {
    Json about = {{"bufferView", view(bytes_of(values))}, {"componentType", component}, {"count", values.size() / parts}, {"type", type}};
    if (normalized) about["normalized"] = true;
    root["accessors"].push_back(about);
    return static_cast<int>(root["accessors"].size()) - 1;
  }
  int points(const std::vector<float>& xyz) { return accessor(xyz, 5126, "VEC3", 3); }
  int indices(const std::vector<std::uint16_t>& list) { return accessor(list, 5123, "SCALAR", 1); }
  /// A mesh of these primitives at the next node, of the first scene.
  void draw(const Json& primitives, const Json& node = Json::object()) {
    root["meshes"].push_back({{"primitives", primitives}});
    Json placed = node;
    placed["mesh"] = root["meshes"].size() - 1;
    root["nodes"].push_back(placed);
    root["scenes"][0]["nodes"].push_back(root["nodes"].size() - 1);
  }
  std::string text() {
    if (!root.contains("buffers"))
      root["buffers"] = {{{"byteLength", data.size()}, {"uri", "data:application/octet-stream;base64," + base64(data)}}};
    return root.dump();
  }
};

const std::vector<float> kTriangle = {0, 0, 0, 1, 0, 0, 0, 1, 0};

/// One triangle, a node, a scene.
Maker triangle() {
  Maker maker;
  maker.draw({{{"attributes", {{"POSITION", maker.points(kTriangle)}}}}});
  return maker;
}

class Gltf : public ::testing::Test {
 protected:
  Mesh read(const std::string& text) { return load_mesh(folder_.write("model.gltf", text)); }
  Mesh read(Maker maker) { return read(maker.text()); }
  testing::AssertionResult refused(const std::string& text, const std::string& part) {
    try {
      read(text);
      return testing::AssertionFailure() << "was read";
    } catch (const InputError& error) {
      const std::string message = error.what();
      if (message.find(part) == std::string::npos) return testing::AssertionFailure() << "no '" << part << "' in: " << message;
      if (message.find("model.gltf") == std::string::npos) return testing::AssertionFailure() << "no file in: " << message;
      return testing::AssertionSuccess();
    }
  }
  testing::AssertionResult refused(Maker maker, const std::string& part) { return refused(maker.text(), part); }
  static testing::AssertionResult warned(const Mesh& mesh, const std::string& part) {
    for (const std::string& warning : mesh.warnings) {
      if (warning.find(part) != std::string::npos) return testing::AssertionSuccess();
    }
    return testing::AssertionFailure() << "no warning says '" << part << "'";
  }

  TemporaryFolder folder_;
};

TEST_F(Gltf, ScenesNodesAndMeshesAreFoundWhateverIsMissing) {
  Maker maker = triangle();
  maker.draw({{{"attributes", {{"POSITION", 0}}}}}, {{"translation", {10, 0, 0}}});
  // The second node belongs to a second scene.
  maker.root["scenes"] = {{{"nodes", {0}}}, {{"nodes", {1}}}};
  EXPECT_EQ(bounds(read(maker)).upper, glm::dvec3(1, 1, 0));
  maker.root["scene"] = 1;
  EXPECT_EQ(bounds(read(maker)).lower, glm::dvec3(10, 0, 0));
  maker.root["scene"] = "hello";
  EXPECT_EQ(bounds(read(maker)).upper, glm::dvec3(1, 1, 0));
  EXPECT_TRUE(warned(read(maker), "scene"));
  maker.root.erase("scene");
  maker.root.erase("scenes");
  EXPECT_EQ(bounds(read(maker)).upper, glm::dvec3(11, 1, 0));
  maker.root["nodes"][0]["children"] = {1};  // no root any more: drawn once, below its parent
  EXPECT_EQ(read(maker).face_count(), 2u);
  maker.root.erase("nodes");
  EXPECT_EQ(read(maker).face_count(), 2u);
  maker.root["asset"] = Json::object();
  EXPECT_TRUE(warned(read(maker), "version"));
}

TEST_F(Gltf, TransformsAreThoseOfTheFormat) {
  Maker maker = triangle();
  const double h = std::sqrt(0.5);
  // Scaled, then turned by 90 degrees about z, then moved; below a parent that is moved, too.
  maker.root["nodes"] = {{{"children", {1}}, {"translation", {0, 0, 5}}},
                         {{"mesh", 0}, {"scale", {2, 3, 1}}, {"rotation", {0, 0, h, h}}, {"translation", {10, 20, 30}}}};
  const Mesh mesh = read(maker);
  const glm::dvec3 expected[] = {{10, 20, 35}, {10, 22, 35}, {7, 20, 35}};
  for (size_t v = 0; v < 3; ++v) EXPECT_LT(glm::distance(mesh.positions[v], expected[v]), 1e-12) << v;
  // By columns. A reflection turns the corners round, so that the face goes on showing the same side outwards.
  maker = triangle();
  maker.root["nodes"][0]["matrix"] = {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 3, 0, 0, 1};
  const Mesh mirrored = read(maker);
  EXPECT_EQ(mirrored.positions[1], glm::dvec3(2, 0, 0));
  EXPECT_EQ(mirrored.corner_vertices, (std::vector<std::int32_t>{0, 2, 1}));
  maker.root["nodes"][0]["matrix"] = {1, 2, 3};
  EXPECT_TRUE(refused(maker, "nodes[0].matrix"));
  maker.root["nodes"][0] = {{"mesh", 7}};
  EXPECT_TRUE(refused(maker, "no such mesh"));
  maker.root["nodes"][0] = {{"children", {0}}};
  EXPECT_TRUE(refused(maker, "recursive"));
}

TEST_F(Gltf, NormalsTurnWithTheirNode) {
  Maker maker;
  const float s = std::sqrt(0.5f);
  const int normals = maker.points({s, 0, s, s, 0, s, 0, 0, 0});
  maker.draw({{{"attributes", {{"POSITION", maker.points(kTriangle)}, {"NORMAL", normals}}}}}, {{"scale", {2, 1, 1}}});
  const Mesh mesh = read(maker);
  ASSERT_EQ(mesh.corner_normals.size(), 3u);
  // Stretched along x, a normal leans away from x.
  EXPECT_LT(glm::distance(mesh.corner_normals[0], glm::normalize(glm::vec3(0.5f, 0.0f, 1.0f))), 1e-6f);
  EXPECT_EQ(mesh.corner_normals[2], glm::vec3(0.0f));  // none: left to the face
}

TEST_F(Gltf, TrianglesStripsAndFans) {
  Maker maker;
  const int points = maker.points({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 2, 1, 0});
  const Json attributes = {{"POSITION", points}};
  maker.draw({{{"attributes", attributes}, {"mode", 5}, {"indices", maker.indices({0, 1, 2, 3, 3, 4})}},
              {{"attributes", attributes}, {"mode", 6}, {"indices", maker.indices({0, 1, 3, 2})}},
              {{"attributes", attributes}, {"indices", maker.indices({0, 1, 2, 1, 3, 2, 4})}},
              {{"attributes", attributes}, {"mode", 1}},
              {{"attributes", Json::object()}}});
  const Mesh mesh = read(maker);
  // Of the strip's four triangles the two with a repeated corner have no area; all turn the same way.
  EXPECT_EQ(mesh.corner_vertices, (std::vector<std::int32_t>{0, 1, 2, 2, 1, 3, 0, 1, 3, 0, 3, 2, 0, 1, 2, 1, 3, 2}));
  EXPECT_EQ(mesh.vertex_count(), 5u) << "primitives share their vertices";
  EXPECT_TRUE(warned(mesh, "points or lines"));
  EXPECT_TRUE(warned(mesh, "without positions"));
  EXPECT_TRUE(warned(mesh, "1 corner"));
  maker.root["accessors"][0]["count"] = 3;
  EXPECT_TRUE(warned(read(maker), "do not exist"));
}

TEST_F(Gltf, QuantizedPositionsAreReadForWhatTheyAre) {
  Maker maker;
  maker.root["extensionsRequired"] = {"KHR_mesh_quantization"};
  // 16-bit corners, as integers under a node's scale, and normalised; 8 bytes apart.
  const std::vector<std::int16_t> raw = {0, 0, 0, 0, 1000, 0, 0, 0, 0, -32767, 0, 0};
  const int plain = maker.accessor(raw, 5122, "VEC3", 4), share = maker.accessor(raw, 5122, "VEC3", 4, true);
  for (int view : {0, 1}) maker.root["bufferViews"][static_cast<size_t>(view)]["byteStride"] = 8;
  const int bytes = maker.accessor(std::vector<std::int8_t>{0, 0, 0, 0, 127, 0, 0, 0, 0, -128, 0, 0}, 5120, "VEC3", 4, true);
  maker.root["bufferViews"][2]["byteStride"] = 4;
  maker.draw({{{"attributes", {{"POSITION", plain}}}}}, {{"scale", {0.001, 0.001, 0.001}}});
  maker.draw({{{"attributes", {{"POSITION", share}}}}});
  maker.draw({{{"attributes", {{"POSITION", bytes}}}}});
  const Mesh mesh = read(maker);
  ASSERT_EQ(mesh.vertex_count(), 9u);
  EXPECT_LT(glm::distance(mesh.positions[1], glm::dvec3(1, 0, 0)), 1e-12);
  EXPECT_LT(glm::distance(mesh.positions[2], glm::dvec3(0, -32.767, 0)), 1e-12);
  EXPECT_LT(glm::distance(mesh.positions[4], glm::dvec3(1000.0 / 32767.0, 0, 0)), 1e-12);
  EXPECT_LT(glm::distance(mesh.positions[5], glm::dvec3(0, -1, 0)), 1e-12);
  EXPECT_LT(glm::distance(mesh.positions[7], glm::dvec3(1, 0, 0)), 1e-12);
  EXPECT_LT(glm::distance(mesh.positions[8], glm::dvec3(0, -1, 0)), 1e-12) << "-128 stands for -1, too";
}

TEST_F(Gltf, SparseAccessorsAndInstances) {
  Maker maker;
  const int indices = maker.view(bytes_of(std::vector<std::uint16_t>{1, 2}));
  const int values = maker.view(bytes_of(std::vector<float>{4, 0, 0, 0, 5, 0}));
  maker.root["accessors"].push_back(
      {{"componentType", 5126},
       {"count", 3},
       {"type", "VEC3"},
       {"sparse", {{"count", 2}, {"indices", {{"bufferView", indices}, {"componentType", 5123}}}, {"values", {{"bufferView", values}}}}}});
  const int moved = maker.points({0, 0, 0, 0, 0, 7});
  maker.draw({{{"attributes", {{"POSITION", 0}}}}},
             {{"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", moved}}}}}}}});
  maker.root["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  const Mesh mesh = read(maker);
  ASSERT_EQ(mesh.vertex_count(), 6u);
  EXPECT_EQ(mesh.positions[1], glm::dvec3(4, 0, 0));
  EXPECT_EQ(mesh.positions[5], glm::dvec3(0, 5, 7));
  maker.root["accessors"][0]["sparse"]["count"] = 3;  // beyond its view
  EXPECT_TRUE(refused(maker, "beyond the end"));
}

TEST_F(Gltf, InstancesWithAttributesOfTheirOwnAloneAreDrawn) {
  Maker maker;
  const int points = maker.points(kTriangle), ids = maker.points({0, 0, 0, 1, 1, 1});
  maker.draw({{{"attributes", {{"POSITION", points}}}}}, {{"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"_ID", ids}}}}}}}});
  EXPECT_EQ(read(maker).face_count(), 2u);
}

TEST_F(Gltf, FacesThatAreNoneAreDroppedAndSaid) {
  Maker maker;
  const int points = maker.points(kTriangle);
  const int view = maker.view(bytes_of(std::vector<std::uint16_t>{0, 1, 2, 0, 0, 1, 0, 1, 2}));
  maker.root["accessors"].push_back({{"bufferView", view}, {"componentType", 5123}, {"count", 9}, {"type", "SCALAR"}});
  const int indices = static_cast<int>(maker.root["accessors"].size()) - 1;
  maker.draw({{{"attributes", {{"POSITION", points}}}, {"indices", indices}}});
  const Mesh mesh = read(maker);
  EXPECT_EQ(mesh.face_count(), 2u) << "equal faces may be meant: of parts with materials of their own";
  EXPECT_TRUE(warned(mesh, "fewer than 3 corners"));
}

TEST_F(Gltf, NumbersOutOfRangeAreRefusedInWords) {
  std::string text = triangle().text();
  text.insert(text.size() - 1, ", \"extras\": 1e999");
  EXPECT_TRUE(refused(text, "a number out of range"));
}

TEST_F(Gltf, ColoursOfMaterialsAndVerticesAreLinear) {
  Maker maker;
  const int points = maker.points(kTriangle);
  const int colors = maker.accessor(std::vector<std::uint8_t>{255, 0, 0, 255, 0, 51, 0, 255, 0, 0, 255, 0}, 5121, "VEC4", 4, true);
  maker.root["materials"] = {{{"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.25, 2.0, 1.0}}}}, {"name", 42}},
                             {{"extensions", {{"KHR_materials_pbrSpecularGlossiness", {{"diffuseFactor", {0.1, 0.2, 0.3, 1}}}}}}},
                             {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  maker.draw({{{"attributes", {{"POSITION", points}}}, {"material", 0}},
              {{"attributes", {{"POSITION", points}, {"COLOR_0", colors}}}, {"material", 1}},
              {{"attributes", {{"POSITION", points}}}, {"material", 2}},
              {{"attributes", {{"POSITION", points}}}}});
  const Mesh mesh = read(maker);
  EXPECT_EQ(mesh.face_materials, (std::vector<std::int32_t>{0, 1, 2, 3}));
  ASSERT_EQ(mesh.material_colors.size(), 4u);
  EXPECT_EQ(mesh.material_colors[0], glm::vec3(0.5f, 0.25f, 1.0f));
  EXPECT_EQ(mesh.material_colors[1], glm::vec3(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(mesh.material_colors[2], glm::vec3(1.0f));
  ASSERT_EQ(mesh.vertex_colors.size(), mesh.vertex_count());
  EXPECT_EQ(mesh.vertex_count(), 6u);
  EXPECT_EQ(mesh.vertex_colors[0], glm::vec3(1.0f));
  EXPECT_LT(glm::distance(mesh.vertex_colors[4], glm::vec3(0.0f, 0.2f, 0.0f)), 1e-6f);
  EXPECT_TRUE(warned(mesh, "textures"));
  // White all over is no colour of the file's.
  EXPECT_TRUE(read(triangle()).material_colors.empty());
}

TEST_F(Gltf, WrongTypesBesideTheGeometryLoseNothing) {
  Maker maker = triangle();
  maker.root["scenes"][0]["name"] = 42;
  maker.root["nodes"][0]["name"] = Json::array();
  maker.root["nodes"][0]["extensions"] = "none";
  maker.root["materials"] = {{{"pbrMetallicRoughness", Json::array({"no object"})}, {"extensions", 3}}};
  maker.root["meshes"][0]["primitives"][0]["material"] = -1;
  maker.root["meshes"][0]["primitives"][0]["extensions"] = {{"KHR_texture_transform", "no object"}};
  maker.root["extensionsUsed"] = 1;
  maker.root["extensionsRequired"] = "KHR_texture_transform";
  maker.root["accessors"][0]["min"] = "lower";
  EXPECT_EQ(read(maker).face_count(), 1u);
  EXPECT_TRUE(warned(read(maker), "extensionsRequired"));
}

TEST_F(Gltf, WhatIsNotReadIsRefusedByName) {
  for (const char* name : {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "ACME_strange_geometry"}) {
    Maker maker = triangle();
    maker.root["extensionsRequired"] = {name};
    EXPECT_TRUE(refused(maker, name));
  }
  for (const char* name : {"KHR_materials_unlit", "KHR_texture_transform", "KHR_mesh_quantization", "KHR_lights_punctual"}) {
    Maker maker = triangle();
    maker.root["extensionsRequired"] = {name};
    EXPECT_EQ(read(maker).face_count(), 1u) << name;
  }
  // Used and not required: plain data beside the compressed ones are read; where there are none, the name says why.
  Maker maker = triangle();
  maker.root["meshes"][0]["primitives"][0]["extensions"] = {{"KHR_draco_mesh_compression", {{"bufferView", 0}}}};
  EXPECT_EQ(read(maker).face_count(), 1u);
  maker.root["accessors"][0].erase("bufferView");
  EXPECT_TRUE(refused(maker, "Draco"));
  maker = triangle();
  maker.text();
  maker.root["buffers"] = {{{"byteLength", 36}}};
  EXPECT_TRUE(refused(maker, "no data"));
  maker.root["bufferViews"][0]["extensions"] = {{"EXT_meshopt_compression", Json::object()}};
  EXPECT_TRUE(refused(maker, "meshopt"));
  maker = triangle();
  maker.root["asset"]["version"] = "3.0";
  EXPECT_TRUE(refused(maker, "asset.version"));
}

TEST_F(Gltf, BuffersAreFilesOfItsFolderOnly) {
  Maker maker = triangle();
  const auto with_uri = [&](const std::string& uri) {
    maker.root["buffers"] = {{{"byteLength", maker.data.size()}, {"uri", uri}}};
    return maker.text();
  };
  folder_.write("my data%.bin", maker.data);
  fs::create_directories(folder_.file("sub"));
  folder_.write("sub/d.bin", maker.data);
  EXPECT_EQ(read(with_uri("my%20data%25.bin")).face_count(), 1u);
  EXPECT_EQ(read(with_uri("my data%.bin")).face_count(), 1u);
  EXPECT_EQ(read(with_uri("sub/d.bin")).face_count(), 1u);
  EXPECT_EQ(read(with_uri("sub/../sub/d.bin")).face_count(), 1u);
  EXPECT_TRUE(refused(with_uri("other/d.bin"), "no such file"));
  folder_.write("d.bin", maker.data);
  EXPECT_TRUE(refused(with_uri("other/d.bin"), "no such file")) << "no bare name instead";
  EXPECT_TRUE(refused(with_uri("http://example.org/d.bin"), "only files beside"));
  EXPECT_TRUE(refused(with_uri("sub"), "not a regular file"));
  ASSERT_EQ(::mkfifo(folder_.file("pipe.bin").c_str(), 0600), 0);
  EXPECT_TRUE(refused(with_uri("pipe.bin"), "not a regular file"));
  folder_.write("short.bin", maker.data.substr(0, 20));
  EXPECT_TRUE(refused(with_uri("short.bin"), "cut short: 20 bytes of 36"));
  EXPECT_TRUE(refused(with_uri("data:;base64,A*B="), "base64"));
  EXPECT_TRUE(refused(with_uri("/etc/hostname"), "outside the folder"));

  const std::string text = with_uri("../d.bin");
  folder_.write("sub/model.gltf", text);
  try {
    load_mesh(folder_.file("sub/model.gltf"));
    FAIL() << "reached out of its folder";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("outside the folder"), std::string::npos) << error.what();
  }
}

TEST_F(Gltf, AccessorsStayWithinTheirBuffers) {
  const auto wrong = [&](const Json::json_pointer& place, const Json& value, const std::string& part) {
    Maker maker = triangle();
    maker.root[place] = value;
    return refused(maker, part);
  };
  using P = Json::json_pointer;
  EXPECT_TRUE(wrong(P("/accessors/0/count"), 4, "beyond the end of its buffer view"));
  EXPECT_TRUE(wrong(P("/accessors/0/count"), 1e15, "more vertices"));
  EXPECT_TRUE(wrong(P("/accessors/0/count"), -3, "accessors[0].count"));
  EXPECT_TRUE(wrong(P("/accessors/0/byteOffset"), 4, "beyond the end of its buffer view"));
  EXPECT_TRUE(wrong(P("/accessors/0/byteOffset"), 18446744073709551615u, "beyond the end of its buffer view"));
  EXPECT_TRUE(wrong(P("/accessors/0/componentType"), 5124, "componentType"));
  EXPECT_TRUE(wrong(P("/accessors/0/type"), "VEC2", "POSITION"));
  EXPECT_TRUE(wrong(P("/accessors/0/type"), "MAT4", "accessors[0].type"));
  EXPECT_TRUE(wrong(P("/accessors/0/bufferView"), 3, "no such buffer view"));
  EXPECT_TRUE(wrong(P("/bufferViews/0/byteLength"), 100, "beyond the end of its buffer"));
  EXPECT_TRUE(wrong(P("/bufferViews/0/byteStride"), 4, "byteStride"));
  EXPECT_TRUE(wrong(P("/bufferViews/0/buffer"), 9, "no such buffer"));
  EXPECT_TRUE(wrong(P("/meshes/0/primitives"), "none", "meshes[0].primitives"));
  EXPECT_TRUE(wrong(P("/meshes/0/primitives/0/attributes/POSITION"), 8, "no such accessor"));
  EXPECT_TRUE(refused("{\"asset\": {\"version\": \"2.0\"},\n \"nodes\": [ }", "2: damaged"));
}

std::string glb(const std::string& json, const std::string& binary) {
  const auto word = [](std::uint32_t value) { return std::string(reinterpret_cast<const char*>(&value), 4); };
  const std::string padded = json + std::string((4 - json.size() % 4) % 4, ' ');
  const std::string chunks = word(static_cast<std::uint32_t>(padded.size())) + word(0x4E4F534A) + padded +
                             word(static_cast<std::uint32_t>(binary.size())) + word(0x004E4942) + binary;
  return "glTF" + word(2) + word(static_cast<std::uint32_t>(chunks.size() + 12)) + chunks;
}

TEST_F(Gltf, ABinaryFileCutAnywhereIsRefusedAndBytesAfterItAreNot) {
  Maker maker = triangle();
  maker.root["buffers"] = {{{"byteLength", maker.data.size()}}};
  const std::string whole = glb(maker.text(), maker.data);
  EXPECT_EQ(load_mesh(folder_.write("whole.glb", whole)).face_count(), 1u);
  EXPECT_EQ(load_mesh(folder_.write("more.glb", whole + "and more")).face_count(), 1u);
  const auto parse = [&](const std::string& bytes) {
    return parse_gltf(std::as_bytes(std::span(bytes.data(), bytes.size())), folder_.path(), 1000);
  };
  for (size_t size = 1; size < whole.size(); ++size) EXPECT_THROW(parse(whole.substr(0, size)), InputError) << size;
}

TEST_F(Gltf, DamagedBytesAreRefusedOrReadAsValidMeshes) {
  Maker maker = triangle();
  maker.root["buffers"] = {{{"byteLength", maker.data.size()}}};
  const std::string whole = glb(maker.text(), maker.data);
  std::mt19937 random(1729);
  int read_count = 0, refused_count = 0;
  for (int round = 0; round < 3000; ++round) {
    std::string bad = whole;
    for (unsigned k = 0; k < 1 + random() % 3; ++k)
      bad[random() % bad.size()] = static_cast<char>(round % 2 ? '0' + random() % 10 : random());
    try {
      const auto mesh = parse_gltf(std::as_bytes(std::span(bad.data(), bad.size())), folder_.path(), 1000);
      if (mesh) validate(*mesh, "bad.glb");
      ++read_count;
    } catch (const InputError&) {
      ++refused_count;
    }
  }
  EXPECT_GT(read_count, 100) << "seed 1729";
  EXPECT_GT(refused_count, 100) << "seed 1729";
}

}  // namespace
}  // namespace limn
