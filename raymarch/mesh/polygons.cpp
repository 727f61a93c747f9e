#include "raymarch/mesh/polygons.h"

#include <algorithm>

#include "sdf/once_alone.h"
#include "sdf/parallel.h"
#include "subdiv/polygon.h"

namespace limn {
namespace {

/// Those of some faces, by their corners.
void add_triangles(const Mesh& mesh, const std::vector<std::int32_t>& first, const IndexRange<size_t>& faces,
                   std::vector<glm::uvec3>& out) {
  std::vector<glm::dvec3> corners;
  std::vector<std::array<std::int32_t, 3>> pieces;
  for (size_t f = faces.begin(); f < faces.end(); ++f) {
    gather_corners(mesh, face_corners(mesh, first[f], f), corners);
    triangulate_polygon(corners, pieces);
    for (const auto& piece : pieces) {
      const auto a = static_cast<size_t>(piece[0]), b = static_cast<size_t>(piece[1]), c = static_cast<size_t>(piece[2]);
      if (!zero_area(corners[a], corners[b], corners[c]))
        out.push_back(glm::uvec3(glm::ivec3(first[f]) + glm::ivec3(piece[0], piece[1], piece[2])));
    }
  }
}

}  // namespace

const Mesh& Polygons::mesh() const {
  once_alone(mesh_made_, [this] {
    if (!make_) return;
    mesh_ = make_();
    make_ = {};
  });
  return mesh_;
}

std::span<const glm::vec3> Polygons::corner_normals() const {
  once_alone(corners_made_, [this] {
    const Mesh& mesh = this->mesh();
    corner_normals_ = traced_ == NormalKind::flat ? face_normals_at_corners(mesh) : angle_weighted_normals(mesh, smoothing_);
    for (size_t i = 0; i < mesh.corner_normals.size(); ++i) {
      const float length = glm::length(mesh.corner_normals[i]);
      if (length > 1e-20f && std::isfinite(length)) corner_normals_[i] = mesh.corner_normals[i] / length;
    }
  });
  return corner_normals_;
}

std::span<const glm::vec3> Polygons::smooth_normals() const {
  once_alone(smooth_made_, [this] { smooth_normals_ = bake_smooth_normals(mesh()); });
  return smooth_normals_;
}

const EdgeTopology& Polygons::edges() const {
  once_alone(edges_made_, [this] { edges_ = build_edge_topology(mesh()); });
  return edges_;
}

std::span<const glm::uvec3> Polygons::corner_triangles() const {
  once_alone(triangles_made_, [this] {
    const Mesh& mesh = this->mesh();
    const std::vector<std::int32_t> first = first_corners(mesh);
    constexpr size_t kFaces = 8192;
    std::vector<std::vector<glm::uvec3>> parts((mesh.face_count() + kFaces - 1) / kFaces);
    parallel_each(parts.size(), [&](size_t k) {
      add_triangles(mesh, first, {k * kFaces, std::min((k + 1) * kFaces, mesh.face_count())}, parts[k]);
    });
    size_t count = 0;
    for (const auto& part : parts) count += part.size();
    corner_triangles_.reserve(count);
    for (const auto& part : parts) corner_triangles_.insert(corner_triangles_.end(), part.begin(), part.end());
  });
  return corner_triangles_;
}

}  // namespace limn
