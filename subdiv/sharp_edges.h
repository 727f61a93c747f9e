#pragma once
// Edges along which a mesh of triangles is not smooth, and its vertices parted by them.

#include <array>
#include <utility>
#include <vector>

#include "subdiv/mesh.h"

namespace limn {

/// Makes edges of a mesh of triangles creases of infinite sharpness where the normals of their faces differ by more than `angle_deg`, in
/// (0, 180), or both faces run along them the same way.
void mark_creases(double angle_deg, Mesh& triangles);

/// Takes back creases that hang together over less than `length` in all: those of a wave that is to be smoothed away.
void drop_short_creases(double length, Mesh& triangles);

/// Creases, open edges and edges of more than two faces; lower vertex first, rising.
std::vector<std::pair<std::int32_t, std::int32_t>> sharp_edges(const Mesh& triangles);

/// Triangles whose corners share a vertex only where the mesh is smooth between them.
struct SmoothTriangles {
  std::vector<std::array<std::uint32_t, 3>> corners{};  ///< Of each triangle, in the mesh's order: indices into `vertex`.
  /// Of each triangle, for its sides from one corner to the next: the triangle that the mesh smoothly goes on with, or kNoTriangle.
  std::vector<std::array<std::uint32_t, 3>> beyond{};
  std::vector<std::uint32_t> vertex{};  ///< Of the mesh.

  static constexpr std::uint32_t kNoTriangle = 0xffffffffu;
};
SmoothTriangles part_at_sharp_edges(const Mesh& triangles);

}  // namespace limn
