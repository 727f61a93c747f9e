#pragma once
// Meshes of analytic shapes: a cage of the right topology, refined, its vertices brought onto the surface.

#include <memory>
#include <vector>

#include "sdf/field.h"
#include "subdiv/refine.h"

namespace limn {

struct FieldCage;  // subdiv/tessellate.cpp
/// One cage refined once, twice, ...: with all its vertices on the surface. Those of more than 64 MB are not kept.
using FieldCages = std::vector<std::shared_ptr<const FieldCage>>;

/// How a field is meshed.
struct TessellateSettings {
  int level = 3;                           ///< 0..8 refinements of the cage.
  NormalKind normals = NormalKind::limit;  ///< limit: the field's gradient at each corner, taken from that corner's side of a crease.
  std::int64_t max_bytes = std::int64_t{8} << 30;  ///< Refuses (InputError, with the prediction) what would be larger.
  std::shared_ptr<const FieldCage> cage{};         ///< The field's, from find_field_cage(); null: it is looked for.
  FieldCages* refinements = nullptr;               ///< Of `cage`: those that are there are taken, new ones added. May be null.
};

/// Where tessellate() starts from, for several tessellations of one field: a coarse one takes most of its time to find it. Throws
/// InputError as cage_of does.
std::shared_ptr<const FieldCage> find_field_cage(const Field& field);
/// Wall clock, to find it, or to refine the one before it once more.
double time_to_find_ms(const FieldCage& cage);
const Mesh& mesh_of(const FieldCage& cage);

/// A cage of the surface's topology, about 100 faces and more where the shape is rich: dual contouring of a coarse sampling, which is
/// refined until the count of parts and the Euler number are those of the next finer sampling. Throws InputError for unbounded fields.
Mesh cage_of(const Field& field);

/// cage_of, refined `level` times, each vertex brought onto the surface along the gradient after every refinement.
Mesh tessellate(const Field& field, const TessellateSettings& settings);

}  // namespace limn
