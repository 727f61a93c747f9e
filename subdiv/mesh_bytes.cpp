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

}  // namespace

void put_mesh(ByteWriter& writer, const Mesh& mesh) {
  put_all(writer, mesh.positions);
  put_all(writer, mesh.face_sizes);
  put_all(writer, mesh.corner_vertices);
  put_all(writer, mesh.corner_normals);
  put_all(writer, mesh.vertex_colors);
  put_all(writer, mesh.face_materials);
  put_all(writer, mesh.face_groups);
  put_names(writer, mesh.material_names);
  put_names(writer, mesh.group_names);
  put_all(writer, mesh.material_colors);
  put_all(writer, mesh.face_smoothing);
  put_names(writer, mesh.warnings);
}

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
