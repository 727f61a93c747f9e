#pragma once
// Internal: a mesh as a body: which side of it a point lies on, and how far from it the nodes of a level set are.

#include <mutex>

#include "subdiv/band_distance.h"
#include "subdiv/mesh_block.h"
#include "subdiv/mesh_distance.h"
#include "subdiv/mesh_level_set.h"
#include "subdiv/triangle_tree.h"

namespace limn {

/// A mesh that level sets are made from: triangles about the middle of their box (far from it double precision and 32-bit indices would run
/// out), those that lie on one place taken together, facing outwards. Neither copied nor moved: its parts refer to each other.
class MeshBody {
 public:
  /// Throws InputError for a mesh without triangles.
  explicit MeshBody(const TriangleMesh& mesh);
  MeshBody(const MeshBody&) = delete;
  MeshBody& operator=(const MeshBody&) = delete;

  const TriangleMesh& mesh() const { return mesh_; }  ///< Relative to origin(); normals and materials are left out.
  const glm::dvec3& origin() const { return origin_; }
  const Box& bounds() const { return bounds_; }  ///< Relative to origin().
  const Winding& winding() const { return *winding_; }
  /// Embree's tree over the triangles, and one of boxes; made when they are first asked for.
  const ClosestPointData& tree() const;
  const TriangleTree& boxes() const;
  /// Where the border of the surface runs, and how long it is; empty and 0 where it is closed.
  const Box& holes() const { return holes_; }
  double length_of_holes() const { return length_of_holes_; }
  /// That its faces were turned round, that it is open.
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  glm::dvec3 origin_{0.0};
  Box bounds_{};
  TriangleMesh mesh_{};
  std::unique_ptr<const Winding> winding_{};
  std::vector<std::string> warnings_{};
  Box holes_{};
  double length_of_holes_ = 0.0;
  mutable std::once_flag tree_made_{}, boxes_made_{};
  mutable std::unique_ptr<const ClosestPointData> tree_{};
  mutable TriangleTree boxes_{};
};

/// As of its mesh (subdiv/mesh_level_set.h), where several are made of one.
MeshLevelSet level_set_from_mesh(const MeshBody& body, const LevelSetSettings& settings);

/// Bands wider than this have so many triangles in reach of a block that the tree is quicker.
inline constexpr double kScatterReach_voxels = 6.0;

/// Share of an open mesh's area (of some thousand triangles of it) that has inside behind it at this depth; 1 for a closed one. A sheet
/// that is bent a little has inside in its fold alone, and the surface that bounds that is not the sheet: below a half it has none.
double share_with_inside(const MeshBody& body, double depth);

/// Appends that walls are thinner than two voxels and gaps thinner than one: shares of the surface, as the audit measures them.
void warn_of_thin_sheets(const MeshBody& body, double voxel_size, std::vector<std::string>& warnings);

}  // namespace limn
