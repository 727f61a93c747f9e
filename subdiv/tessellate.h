#pragma once
// Meshes of analytic shapes: a cage of the right topology, refined, its vertices brought onto the surface.

#include "sdf/field.h"
#include "subdiv/refine.h"

namespace limn {

/// How a field is meshed.
struct TessellateSettings {
  int level = 3;                           ///< 0..8 refinements of the cage.
  NormalKind normals = NormalKind::limit;  ///< limit: the field's gradient at each corner, taken from that corner's side of a crease.
  std::int64_t max_bytes = std::int64_t{8} << 30;  ///< Refuses (InputError, with the prediction) what would be larger.
};

/// A cage of the surface's topology, about 100 faces and more where the shape is rich: dual contouring of a coarse sampling, which is
/// refined until the count of parts and the Euler number are those of the next finer sampling. Throws InputError for unbounded fields.
Mesh cage_of(const Field& field);

/// cage_of, refined `level` times, each vertex brought onto the surface along the gradient after every refinement.
Mesh tessellate(const Field& field, const TessellateSettings& settings);

}  // namespace limn
