#include "raymarch/mesh/polygons.h"

#include "sdf/once_alone.h"
#include "subdiv/polygon.h"

namespace limn {

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
    std::vector<glm::dvec3> corners;
    std::vector<std::array<std::int32_t, 3>> pieces;
    std::int32_t first = 0;
    for (size_t f = 0; f < mesh.face_count(); ++f) {
      gather_corners(mesh, face_corners(mesh, first, f), corners);
      triangulate_polygon(corners, pieces);
      for (const auto& piece : pieces) {
        const auto a = static_cast<size_t>(piece[0]), b = static_cast<size_t>(piece[1]), c = static_cast<size_t>(piece[2]);
        if (!zero_area(corners[a], corners[b], corners[c]))
          corner_triangles_.push_back(glm::uvec3(glm::ivec3(first) + glm::ivec3(piece[0], piece[1], piece[2])));
      }
      first += mesh.face_sizes[f];
    }
  });
  return corner_triangles_;
}

}  // namespace limn
