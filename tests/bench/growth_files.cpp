// The files of the growth suite, in programs of their own.

#include <fmt/format.h>

#include <assimp/Importer.hpp>
#include <cstring>
#include <fstream>

#include "samples/input/world_model.h"
#include "samples/scenes/scenes.h"
#include "sdf/error.h"
#include "subdiv/import.h"
#include "tests/bench/growth_suite.h"

namespace limn::bench {
namespace {

template <class T>
void put(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

void put_point(std::string& bytes, const glm::vec3& p) { put(bytes, p.x), put(bytes, p.y), put(bytes, p.z); }

/// One of each vertex: glTF knows no other. Where faces disagree the last one's stays.
std::vector<glm::vec3> vertex_normals(const Mesh& mesh) {
  std::vector<glm::vec3> normals(mesh.vertex_count(), glm::vec3(0.0f, 0.0f, 1.0f));
  for (size_t c = 0; c < mesh.corner_normals.size(); ++c) normals[static_cast<size_t>(mesh.corner_vertices[c])] = mesh.corner_normals[c];
  return normals;
}

/// Quads cut in two: glTF has triangles only.
std::string triangle_indices(const Mesh& mesh) {
  std::string bytes;
  size_t first = 0;
  for (const std::int32_t size : mesh.face_sizes) {
    for (size_t k = 2; k < static_cast<size_t>(size); ++k)
      for (const size_t corner : {size_t{0}, k - 1, k}) put(bytes, static_cast<std::uint32_t>(mesh.corner_vertices[first + corner]));
    first += static_cast<size_t>(size);
  }
  return bytes;
}

/// A binary glTF of one primitive (glTF 2.0, sections 3 and 4): positions, normals, triangles.
void write_glb(const Mesh& mesh, const std::filesystem::path& file) {
  std::string data;
  for (const glm::dvec3& p : mesh.positions) put_point(data, glm::vec3(p));
  for (const glm::vec3& n : vertex_normals(mesh)) put_point(data, n);
  const size_t points = 12 * mesh.vertex_count();
  const std::string indices = triangle_indices(mesh);
  data += indices;
  const glm::vec3 lower(bounds(mesh).lower), upper(bounds(mesh).upper);
  const auto vector = [](const glm::vec3& v) { return nlohmann::json{v.x, v.y, v.z}; };
  constexpr int kFloat = 5126, kUnsigned = 5125;
  const nlohmann::json document = {{"asset", {{"version", "2.0"}}},
                                   {"scene", 0},
                                   {"scenes", {{{"nodes", {0}}}}},
                                   {"nodes", {{{"mesh", 0}}}},
                                   {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}, {"NORMAL", 1}}}, {"indices", 2}}}}}}},
                                   {"accessors",
                                    {{{"bufferView", 0},
                                      {"componentType", kFloat},
                                      {"count", mesh.vertex_count()},
                                      {"type", "VEC3"},
                                      {"min", vector(lower)},
                                      {"max", vector(upper)}},
                                     {{"bufferView", 1}, {"componentType", kFloat}, {"count", mesh.vertex_count()}, {"type", "VEC3"}},
                                     {{"bufferView", 2}, {"componentType", kUnsigned}, {"count", indices.size() / 4}, {"type", "SCALAR"}}}},
                                   {"bufferViews",
                                    {{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", points}},
                                     {{"buffer", 0}, {"byteOffset", points}, {"byteLength", points}},
                                     {{"buffer", 0}, {"byteOffset", 2 * points}, {"byteLength", indices.size()}}}},
                                   {"buffers", {{{"byteLength", data.size()}}}}};
  std::string text = document.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::string head;
  const auto chunk = [&head](size_t size, const char* kind) {
    put(head, static_cast<std::uint32_t>(size));
    head.append(kind, 4);
  };
  head.append("glTF", 4);
  put(head, std::uint32_t{2});
  put(head, static_cast<std::uint32_t>(12 + 8 + text.size() + 8 + data.size()));
  chunk(text.size(), "JSON");
  head += text;
  chunk(data.size(), "BIN\0");
  std::ofstream stream(file, std::ios::binary);
  stream << head << data;
  if (!stream.flush()) throw MachineError(file.string() + ": writing failed");
}

void write_files(const std::string& scene, int level, const std::string& stem) {
  const SceneDescriptor* found = find_scene(scene);
  if (found == nullptr) throw InputError({.field = "--scene", .value = scene, .problem = "no such scene", .expected = "limn list scenes"});
  SurfaceSettings settings;
  settings.level = level;
  Scene made = found->make();
  for (SceneObject& object : made.objects) object.level.reset();
  const Mesh mesh = world_mesh(made, settings);
  write_mesh(mesh, stem + ".obj");
  write_mesh(mesh, stem + ".ply");
  write_glb(mesh, stem + ".glb");
  fmt::print("{}\n", mesh.face_count());
}

void read_with_assimp(const std::string& file) {
  Assimp::Importer importer;
  if (importer.ReadFile(file, 0) == nullptr)
    throw InputError({.file = file, .problem = importer.GetErrorString(), .expected = "a mesh that assimp reads"});
}

}  // namespace

bool run_growth_part(int argc, char** argv) {
  if (argc < 3 || std::strcmp(argv[1], "--growth-part") != 0) return false;
  const std::string part = argv[2];
  if (part == "files" && argc == 6) {
    write_files(argv[3], std::atoi(argv[4]), argv[5]);
  } else if (part == "assimp" && argc == 4) {
    read_with_assimp(argv[3]);
  } else {
    throw InputError({.field = "--growth-part", .value = part, .problem = "unknown", .expected = "files SCENE LEVEL STEM, or assimp FILE"});
  }
  return true;
}

}  // namespace limn::bench
