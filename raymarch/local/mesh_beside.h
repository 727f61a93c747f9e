#pragma once
// Internal: what a local level set of a mesh has from the mesh that it is made of: curvature and offset.

#include "raymarch/surface/object_mesh.h"
#include "sdf/level_set.h"

namespace limn {

/// At the mesh's point that is nearest to a hit; empty with the reason where the mesh has none.
CurvatureSource curvature_of_mesh(ObjectMesh mesh);

/// That of the mesh's level set as fine everywhere, which is made when an offset is first asked for. `triangles` in render space.
SurfaceOffset offset_of_mesh(std::shared_ptr<const TriangleMesh> triangles, LevelSetSettings grid, int max_steps);

}  // namespace limn
