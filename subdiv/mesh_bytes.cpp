#include "subdiv/mesh_bytes.h"

#include <cmath>

namespace limn {
namespace {

template <class T>
void put_all(ByteWriter& writer, const std::vector<T>& values) {
  writer.put_span(std::span<const T>(values));
}

void put_names(ByteWriter& writer, const std::vector<std::string>& names) {
  writer.put(static_cast<std::uint64_t>(names.size()));
  for (const std::string& name : names) writer.put_text(name);
}

std::vector<std::string> get_names(ByteReader& reader) {
  const auto count = reader.get<std::uint64_t>();
  std::vector<std::string> names;
  for (std::uint64_t i = 0; i < count; ++i) names.push_back(reader.get_text());
  return names;
}

/// What is sent is not needed any more.
template <class T>
void put_last(ByteWriter& writer, std::vector<T>& values) {
  put_all(writer, values);
  std::vector<T>().swap(values);
}

template <class T>
size_t size_of(const std::vector<T>& values) {
  return sizeof(std::uint64_t) + values.size() * sizeof(T);
}

}  // namespace

void put_mesh(ByteWriter& writer, Mesh&& mesh) {
  // Reserved at once: growing would take up to twice as much. Memory that is reserved and not written yet costs nothing.
  constexpr size_t kNames = size_t{1} << 16;
  writer.reserve(kNames + size_of(mesh.positions) + size_of(mesh.face_sizes) + size_of(mesh.corner_vertices) +
                 size_of(mesh.corner_normals) + size_of(mesh.vertex_colors) + size_of(mesh.face_materials) + size_of(mesh.face_groups) +
                 size_of(mesh.face_smoothing));
  put_last(writer, mesh.positions);
  put_last(writer, mesh.face_sizes);
  put_last(writer, mesh.corner_vertices);
  put_last(writer, mesh.corner_normals);
  put_last(writer, mesh.vertex_colors);
  put_last(writer, mesh.face_materials);
  put_last(writer, mesh.face_groups);
  put_names(writer, mesh.material_names);
  put_names(writer, mesh.group_names);
  put_all(writer, mesh.material_colors);
  put_last(writer, mesh.face_smoothing);
  put_names(writer, mesh.warnings);
}

void put_mesh(ByteWriter& writer, const Mesh& mesh) { put_mesh(writer, Mesh(mesh)); }

Mesh get_mesh(ByteReader& reader) {
  Mesh mesh;
  mesh.positions = reader.get_vector<glm::dvec3>();
  mesh.face_sizes = reader.get_vector<std::int32_t>();
  mesh.corner_vertices = reader.get_vector<std::int32_t>();
  mesh.corner_normals = reader.get_vector<glm::vec3>();
  mesh.vertex_colors = reader.get_vector<glm::vec3>();
  mesh.face_materials = reader.get_vector<std::int32_t>();
  mesh.face_groups = reader.get_vector<std::int32_t>();
  mesh.material_names = get_names(reader);
  mesh.group_names = get_names(reader);
  mesh.material_colors = reader.get_vector<glm::vec3>();
  mesh.face_smoothing = reader.get_vector<std::int32_t>();
  mesh.warnings = get_names(reader);
  return mesh;
}

}  // namespace limn
