#pragma once
// Curvature at the vertices of triangles that stand for a smooth surface, and how it changes, estimated from their normals.

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "subdiv/sharp_edges.h"

namespace limn {

/// At a vertex. The shape operator maps a tangent to how the unit normal changes along it (per unit of length): symmetric and tangential,
/// positive where the surface bends away from its normal.
struct VertexCurvature {
  glm::dvec3 normal{0.0};  ///< Unit; 0 where no triangle has area.
  glm::dmat3 shape{0.0};
  /// Its derivative along each axis of space, tangential: along t that of the normal curvature is the sum of t_k (t, change[k] t).
  std::array<glm::dmat3, 3> change{glm::dmat3(0.0), glm::dmat3(0.0), glm::dmat3(0.0)};
};

/// Of vertices with these positions. Triangles are counter-clockwise seen from outside; those that share vertices are taken as one
/// smooth surface, so that what parts at a crease needs vertices of its own on each side. Least squares over each triangle, weighted at
/// vertices by area (Rusinkiewicz 2004, "Estimating curvatures and their derivatives on triangle meshes"); normals as Max 1999, "Weights
/// for computing vertex normals from facet normals". On a sphere both are exact to rounding.
std::vector<VertexCurvature> vertex_curvature(const std::vector<glm::dvec3>& positions,
                                              const std::vector<std::array<std::uint32_t, 3>>& triangles);

/// Vertices parted at sharp edges, and the curvature at each.
struct SmoothCurvature {
  SmoothTriangles triangles{};
  std::vector<VertexCurvature> vertices{};  ///< Of SmoothTriangles::vertex.
  double mean_edge = 0.0;                   ///< mean_edge() of the mesh.
};
/// Of a mesh of triangles.
SmoothCurvature smooth_curvature(const Mesh& triangles);

/// Between the corners of a triangle: those of its vertices, weighted. `normal` is not made unit.
VertexCurvature curvature_between(const SmoothCurvature& curvature, size_t triangle, const glm::dvec3& weights);

/// The derivative of the normal curvature along a unit tangent.
double change_along(const VertexCurvature& curvature, const glm::dvec3& tangent);

}  // namespace limn
