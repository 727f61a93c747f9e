#pragma once
// Meshes that are fine where the border of given pictures runs and coarse elsewhere. A coarse mesh of the surface is refined by splitting
// edges: the middle of an edge belongs to both of its triangles, so that no crack can appear, and is brought onto the surface. An edge is
// split where the border would otherwise move by more than the tolerance in one of the pictures (local_demand.h).

#include "raymarch/local/local_triangles.h"

namespace limn {

/// `base` refined for the pictures of `settings`, whose cameras stand in render space. Throws SizeError where the triangles would take
/// more than `max_bytes`.
LocalTriangles refine_locally(LocalTriangles base, const LocalSource& source, const LocalSettings& settings, std::int64_t max_bytes);

/// The triangles as a mesh, with their normals at the corners; materials and groups are those of `base_mesh`'s faces.
Mesh as_mesh(const LocalTriangles& local, const Mesh& base_mesh);

}  // namespace limn
