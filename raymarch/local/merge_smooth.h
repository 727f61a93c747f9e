#pragma once
// Internal: fewer triangles where a mesh is curved and smooth, so that a local mesh is coarse away from the border that asks for it.

#include "raymarch/local/local_triangles.h"

namespace limn {

/// A coarser mesh with some of the same vertices: those that have one normal are merged with a neighbour as long as all facets look within
/// 30 degrees of the normals at their corners, and triangles stay wide. Creases, and meshes with colours, stay as they are.
LocalTriangles merge_smooth(LocalTriangles mesh);

}  // namespace limn
