#include <cmath>

#include "subdiv/polygon.h"

namespace limn {
namespace {

/// A file's normals made unit; where one is missing or not finite, the face's own.
std::vector<glm::vec3> cleaned_normals(const Mesh& mesh) {
  std::vector<glm::vec3> normals = face_normals_at_corners(mesh);
  for (size_t i = 0; i < normals.size(); ++i) {
    const float length = glm::length(mesh.corner_normals[i]);
    if (length > 1e-20f && std::isfinite(length)) normals[i] = mesh.corner_normals[i] / length;
  }
  return normals;
}

std::vector<glm::vec3> normals_at_corners(const Mesh& mesh, NormalKind kind, bool use_mesh_normals) {
  if (use_mesh_normals && !mesh.corner_normals.empty()) return cleaned_normals(mesh);
  if (kind != NormalKind::flat) return angle_weighted_normals(mesh);
  // A polygon is one facet however it is cut; a mesh of triangles needs no list to say so.
  for (const std::int32_t size : mesh.face_sizes)
    if (size > 3) return face_normals_at_corners(mesh);
  return {};
}

}  // namespace

std::int64_t TriangleMesh::bytes() const {
  const size_t sum = positions.size() * sizeof(glm::dvec3) + triangles.size() * sizeof(glm::uvec3) +
                     corner_normals.size() * sizeof(glm::vec3) + (triangle_faces.size() + triangle_materials.size()) * sizeof(std::int32_t);
  return static_cast<std::int64_t>(sum);
}

TriangleMesh triangulate(const Mesh& mesh, NormalKind kind, bool use_mesh_normals) {
  TriangleMesh result;
  result.positions = mesh.positions;
  const std::vector<glm::vec3> normals = normals_at_corners(mesh, kind, use_mesh_normals);
  std::vector<glm::dvec3> corners;
  std::vector<std::array<std::int32_t, 3>> pieces;
  std::int32_t first = 0;
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    const std::span<const std::int32_t> vertices = face_corners(mesh, first, f);
    gather_corners(mesh, vertices, corners);
    triangulate_polygon(corners, pieces);
    for (const auto& piece : pieces) {
      const auto a = static_cast<size_t>(piece[0]), b = static_cast<size_t>(piece[1]), c = static_cast<size_t>(piece[2]);
      if (zero_area(corners[a], corners[b], corners[c])) {
        ++result.dropped_triangles;
        continue;
      }
      result.triangles.emplace_back(vertices[a], vertices[b], vertices[c]);
      result.triangle_faces.push_back(static_cast<std::int32_t>(f));
      if (!mesh.face_materials.empty()) result.triangle_materials.push_back(mesh.face_materials[f]);
      if (!normals.empty())
        for (const size_t i : {a, b, c}) result.corner_normals.push_back(normals[static_cast<size_t>(first) + i]);
    }
    first += mesh.face_sizes[f];
  }
  return result;
}

}  // namespace limn
