#pragma once
// Internal: the surface that a local level set is made of, as far as it bears on one brick: a field or a mesh.

#include <memory>
#include <variant>
#include <vector>

#include "raymarch/local/brick_settings.h"
#include "sdf/field.h"
#include "subdiv/mesh_body.h"

namespace limn {

/// A mesh finds what bears on a brick by its trees.
struct MeshPart {
  std::shared_ptr<const MeshBody> body{};
};

/// A field equals the whole one where the nodes and stencils of a brick ask it; a mesh is always the whole. Places are those of the field,
/// or relative to the mesh's MeshBody::origin().
using SurfacePart = std::variant<Field, MeshPart>;

Box bounds_of(const SurfacePart& part);

/// Asks one part; owns scratch memory, so keep one for each thread.
class PartEvaluator {
 public:
  explicit PartEvaluator(const SurfacePart& part);

  /// False only where the surface does not pass the box.
  bool may_hold_surface(const Box& box);
  /// The same by bounds of the value alone: quick, and for the largest boxes.
  bool may_come_near(const Box& box);
  /// As the whole in the box.
  SurfacePart restricted(const Box& box);
  bool is_inside(const glm::dvec3& point);
  /// See brick_demand.h.
  bool needs_smaller_voxels(const Box& box, double voxel_size, double smaller, const LocalBrickSettings& settings);

 private:
  std::variant<FieldEvaluator, MeshPart> part_;
};

}  // namespace limn
