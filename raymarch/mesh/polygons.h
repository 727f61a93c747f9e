#pragma once
// What a mesh surface is made of, for methods that need faces and edges rather than rays.

#include <functional>
#include <mutex>
#include <span>

#include "subdiv/edge_topology.h"
#include "subdiv/mesh.h"

namespace limn {

/// Whether faces or vertices have colours, and these are to be drawn.
inline bool has_colors(const Mesh& mesh) { return mesh.draws_colors && (!mesh.material_colors.empty() || !mesh.vertex_colors.empty()); }

/// The polygons of one surface in render space, and what follows from them whatever the view: made when first asked for, then kept. All
/// members may be called from many threads.
class Polygons {
 public:
  /// `traced` says which normals the surface is traced with; `mesh.corner_normals`, where there are any, are those.
  /// `smoothing`: of vertex normals, where the mesh has none of its own.
  Polygons(Mesh mesh, NormalKind traced, const Smoothing& smoothing = {})
      : mesh_(std::move(mesh)), traced_(traced), smoothing_(smoothing), has_colors_(limn::has_colors(mesh_)) {}
  /// `make` is called once, when somebody asks for the mesh: most pictures of a mesh need its triangles only. `colored`: what it makes
  /// has_colors.
  Polygons(std::function<Mesh()> make, NormalKind traced, const Smoothing& smoothing = {}, bool colored = false)
      : make_(std::move(make)), traced_(traced), smoothing_(smoothing), has_colors_(colored) {}

  /// Whether the mesh is drawn in colours of its own; asking makes nothing.
  bool has_colors() const { return has_colors_; }
  const Mesh& mesh() const;
  /// Unit, one for each corner: the normals that the surface is traced with.
  std::span<const glm::vec3> corner_normals() const;
  /// Unit, one for each vertex, the same for all vertices at one position (bake_smooth_normals).
  std::span<const glm::vec3> smooth_normals() const;
  const EdgeTopology& edges() const;
  /// Triangles as numbers of corners (into mesh().corner_vertices), those without area left out.
  std::span<const glm::uvec3> corner_triangles() const;

 private:
  mutable std::function<Mesh()> make_;
  mutable Mesh mesh_;
  NormalKind traced_;
  Smoothing smoothing_;
  bool has_colors_ = false;
  mutable std::once_flag mesh_made_, corners_made_, smooth_made_, edges_made_, triangles_made_;
  mutable std::vector<glm::vec3> corner_normals_, smooth_normals_;
  mutable EdgeTopology edges_;
  mutable std::vector<glm::uvec3> corner_triangles_;
};

}  // namespace limn
