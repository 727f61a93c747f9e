#pragma once
// Internal: the surfaces that local meshes stand for, and the coarse meshes that they are refined from.

#include <memory>

#include "raymarch/local/local_triangles.h"
#include "raymarch/surface/limit_map.h"
#include "subdiv/tessellate.h"

namespace limn {

/// A coarse mesh, its triangles, and the surface.
struct LocalStart {
  Mesh mesh{};  ///< Of which materials and groups are taken.
  LocalTriangles triangles{};
  LocalSource source{};
  std::vector<LimitPiece> patches{};  ///< What LocalTriangle::patch counts; its corners are not read. Empty for fields.
};

/// Of a field in render space, from its cage (subdiv/tessellate.h; null: it is looked for). `steady`: for a path, along which merged facets
/// would flicker; smooth parts stay as fine as the cage. Throws InputError as that does.
LocalStart start_from_field(const Field& field, std::shared_ptr<const FieldCage> cage, std::int64_t max_bytes, bool steady);

/// Of a cage whose limit surface stands in render space by `render_from_cage`. Empty triangles where it cannot be refined locally: where
/// more than two faces share an edge, or faces have no limit surface of their own. Throws InputError as refine() does.
LocalStart start_from_cage(const Mesh& cage, Scheme scheme, const Affine& render_from_cage, std::int64_t max_bytes,
                           const std::string& file);

/// False where an edge is passed twice in the same direction: such a surface has no two sides there.
bool is_oriented(const LocalTriangles& mesh);

}  // namespace limn
