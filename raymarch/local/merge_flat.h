#pragma once
// Internal: fewer triangles where a mesh is flat, so that a local mesh does not start finer there than any picture asks.

#include "raymarch/local/local_triangles.h"

namespace limn {

/// The same surface to rounding: vertices within flat parts, and those along straight creases between two flat parts, are merged with a
/// neighbour as long as triangles stay wide enough. Meshes with colours stay as they are.
LocalTriangles merge_flat(LocalTriangles mesh);

}  // namespace limn
