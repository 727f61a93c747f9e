#pragma once
// A smooth surface through the vertices of a mesh that is no cage: the limit surface of a cage that is found for it.

#include <string>

#include "subdiv/mesh.h"

namespace limn {

/// How the surface runs through the mesh.
struct InterpolationSettings {
  /// Edges whose faces' normals differ by more stay sharp, degrees in (0, 180); so do open ones, and those of more than two faces.
  double crease_angle_deg = 40.0;
  /// So near the surface goes by each vertex: over the mesh's longest side, above 0.
  double tolerance = 1e-8;
  /// Waves as short as this are smoothed away first (faired_positions), in mean edges of the mesh; 0: none are.
  double fairing_edges = 0.0;
};

struct InterpolatedMesh {
  Mesh cage{};
  std::vector<glm::dvec3> through{};  ///< Where the limit surface goes by each vertex of the cage: the mesh's vertices, or faired ones.
  double moved = 0.0;                 ///< How far fairing moved a vertex at most, the mesh's units.
};

/// A cage of triangles whose limit surface by Loop's scheme (Scheme::loop) goes through the vertices of `mesh`, which is triangulated
/// first. Vertices at the same position count as one. Its vertices are found by moving them by what the surface is off (Cheng, Fan, Lai,
/// Huang, Wang & Yong 2009, "Loop subdivision surface based progressive interpolation"). Throws InputError, with `file`, for a mesh without
/// faces and for a topology that cannot be subdivided.
InterpolatedMesh interpolating_cage(const Mesh& mesh, const InterpolationSettings& settings = {}, const std::string& file = {});

}  // namespace limn
