#pragma once
// The same mesh in every format and encoding that is read, written here and not by the program.

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "sdf/error.h"
#include "subdiv/read_obj.h"
#include "subdiv/read_off.h"
#include "subdiv/read_ply.h"
#include "subdiv/read_stl.h"
#include "test_meshes.h"

namespace limn::test {

using Parser = Mesh (*)(std::string_view, const std::string&, std::int64_t);

constexpr std::int64_t kMostElements = 10'000'000;

template <class T>
void put(std::string& bytes, T value, bool swapped = false) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  if (swapped) std::reverse(raw, raw + sizeof value);
  bytes.append(raw, sizeof value);
}

inline void each_face(const Mesh& mesh, const std::function<void(std::span<const std::int32_t>)>& use) {
  size_t first = 0;
  for (const std::int32_t size : mesh.face_sizes) {
    use(std::span(mesh.corner_vertices).subspan(first, static_cast<size_t>(size)));
    first += static_cast<size_t>(size);
  }
}

inline std::string ply_header(const Mesh& mesh, const char* format) {
  return fmt::format(
      "ply\nformat {} 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\nelement face {}\n"
      "property list uchar int vertex_indices\nend_header\n",
      format, mesh.vertex_count(), mesh.face_count());
}

inline std::string ascii_ply(const Mesh& mesh) {
  std::string text = ply_header(mesh, "ascii");
  for (const glm::dvec3& p : mesh.positions) text += fmt::format("{} {} {}\n", p.x, p.y, p.z);
  each_face(mesh, [&](auto face) { text += fmt::format("{} {}\n", face.size(), fmt::join(face, " ")); });
  return text;
}

inline std::string binary_ply(const Mesh& mesh, bool big_endian = false) {
  std::string bytes = ply_header(mesh, big_endian ? "binary_big_endian" : "binary_little_endian");
  for (const glm::dvec3& p : mesh.positions)
    for (int i = 0; i < 3; ++i) put(bytes, p[i], big_endian);
  each_face(mesh, [&](auto face) {
    put(bytes, static_cast<unsigned char>(face.size()));
    for (const std::int32_t v : face) put(bytes, v, big_endian);
  });
  return bytes;
}

inline std::string big_ply(const Mesh& mesh) { return binary_ply(mesh, true); }
inline std::string little_ply(const Mesh& mesh) { return binary_ply(mesh, false); }

inline std::string ascii_off(const Mesh& mesh) {
  std::string text = fmt::format("OFF\n{} {} 0\n", mesh.vertex_count(), mesh.face_count());
  for (const glm::dvec3& p : mesh.positions) text += fmt::format("{} {} {}\n", p.x, p.y, p.z);
  each_face(mesh, [&](auto face) { text += fmt::format("{} {}\n", face.size(), fmt::join(face, " ")); });
  return text;
}

inline std::string text_obj(const Mesh& mesh) {
  std::string text;
  for (const glm::dvec3& p : mesh.positions) text += fmt::format("v {} {} {}\n", p.x, p.y, p.z);
  each_face(mesh, [&](auto face) {
    text += "f";
    for (const std::int32_t v : face) text += fmt::format(" {}", v + 1);
    text += "\n";
  });
  return text;
}

inline std::string ascii_stl(const Mesh& mesh) {
  std::string text = "solid made here\n";
  each_face(mesh, [&](auto face) {
    text += "facet normal 0 0 0\n outer loop\n";
    for (const std::int32_t v : face) {
      const glm::dvec3& p = mesh.positions[static_cast<size_t>(v)];
      text += fmt::format("  vertex {} {} {}\n", p.x, p.y, p.z);
    }
    text += " endloop\nendfacet\n";
  });
  return text + "endsolid made here\n";
}

inline std::string binary_stl(const Mesh& mesh) {
  std::string bytes(80, ' ');
  put(bytes, static_cast<std::uint32_t>(mesh.face_count()));
  each_face(mesh, [&](auto face) {
    bytes.append(12, '\0');
    for (const std::int32_t v : face)
      for (int i = 0; i < 3; ++i) put(bytes, static_cast<float>(mesh.positions[static_cast<size_t>(v)][i]));
    bytes.append(2, '\0');
  });
  return bytes;
}

struct Encoding {
  const char* name;
  std::string (*write)(const Mesh&);
  Parser parse;
  bool triangles_only;  ///< STL: triangles, single precision, vertices in the order in which facets meet them.
};
inline constexpr Encoding kEncodings[] = {
    {"ply ascii", ascii_ply, parse_ply, false},    {"ply little endian", little_ply, parse_ply, false},
    {"ply big endian", big_ply, parse_ply, false}, {"off", ascii_off, parse_off, false},
    {"obj", text_obj, parse_obj, false},           {"stl ascii", ascii_stl, parse_stl, true},
    {"stl binary", binary_stl, parse_stl, true}};

/// What a message of InputError says; empty where the text is read.
inline std::string refusal(Parser parse, const std::string& bytes) {
  try {
    validate(parse(bytes, "file", kMostElements), "file");
    return {};
  } catch (const InputError& error) {
    return error.what();
  }
}

inline bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// Whether one of the mesh's warnings holds all of the parts.
inline bool warns(const Mesh& mesh, const std::vector<std::string>& parts) {
  return std::any_of(mesh.warnings.begin(), mesh.warnings.end(), [&](const std::string& warning) {
    return std::all_of(parts.begin(), parts.end(), [&](const std::string& part) { return has(warning, part); });
  });
}

}  // namespace limn::test
