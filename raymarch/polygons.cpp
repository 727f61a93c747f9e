#include "raymarch/polygons.h"

#include "subdiv/polygon.h"

namespace limn {

std::span<const glm::vec3> Polygons::corner_normals() const {
  std::call_once(corners_made_, [this] {
    corner_normals_ = traced_ == NormalKind::flat ? face_normals_at_corners(mesh_) : angle_weighted_normals(mesh_);
    for (size_t i = 0; i < mesh_.corner_normals.size(); ++i) {
      const float length = glm::length(mesh_.corner_normals[i]);
      if (length > 1e-20f && std::isfinite(length)) corner_normals_[i] = mesh_.corner_normals[i] / length;
    }
  });
  return corner_normals_;
}

std::span<const glm::vec3> Polygons::smooth_normals() const {
  std::call_once(smooth_made_, [this] { smooth_normals_ = bake_smooth_normals(mesh_); });
  return smooth_normals_;
}

const EdgeTopology& Polygons::edges() const {
  std::call_once(edges_made_, [this] { edges_ = build_edge_topology(mesh_); });
  return edges_;
}

}  // namespace limn
