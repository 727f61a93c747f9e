#pragma once
// Internal: what rays and lines meet where everything is a mesh: given ones, and fine ones of limit surfaces.

#include <memory>

#include "raymarch/lines/mesh_tree.h"
#include "raymarch/lines/surface_curves.h"

namespace limn {

/// Faces and edges of a mesh that touch do not hide each other: exact lines lie nearer by this, px at their depth.
inline constexpr double kExactNearer_px = 1e-4;
/// The same as a share of what rays from other lines are lifted off by.
inline constexpr double kExactLiftShare = 1e-3;
/// Its steps are straight and known to rounding.
void make_exact(SurfaceCurve& curve);

/// Triangles in solver space, and one view of them. Safe from many threads.
class MeshLayers {
 public:
  /// Cages are refined until their edges are about `edge_px` long.
  /// `smooth`: the triangles stand for a smooth surface.
  MeshLayers(const LineTask& task, const std::vector<size_t>& objects, double edge_px, bool smooth);

  const MeshTree& tree() const { return *tree_; }

  /// What lies between the sample, lifted off by more than the mesh lies beside the surface, and the eye.
  LayersSeen before(const CurveSample& sample) const;
  /// Marks the places where the curve goes through other parts than its own: CurveSample::pierced.
  void pierce(SurfaceCurve& curve) const;
  /// Where parts go through each other.
  std::vector<SurfaceCurve> intersections() const;

 private:
  LineClass class_of(const PartMeeting& meeting) const;
  CurveSample sample_of(const PartMeeting& meeting) const;
  void pierce_exactly(SurfaceCurve& curve) const;
  /// Where rays from a sample start.
  glm::dvec3 lifted(const CurveSample& sample) const;
  double reach_to_eye(const glm::dvec3& p) const;
  /// The part that the curve runs on: what most of a few short rays through it hit.
  std::uint32_t part_of(const SurfaceCurve& curve) const;
  std::optional<std::uint32_t> triangle_under(const CurveSample& sample) const;
  bool on_own_sheet(const CurveSample& a, const CurveSample& b, double share, std::uint32_t triangle, bool otherwise) const;
  bool goes_through(const CurveSample& sample, const glm::dvec3& way, double at, const glm::dvec3& normal) const;

  Camera camera_;
  double extent_;
  bool smooth_;
  std::vector<int> materials_{};  ///< Of the scene's objects.
  LineClass edge_of_materials_;   ///< What an intersection of two materials counts as.
  std::shared_ptr<const MeshTree> tree_;
};

/// What meshes add to curves that were traced: where these go through other sheets, where parts go through each other, and the counting.
void add_mesh_layers(const std::shared_ptr<const MeshLayers>& layers, LineContribution& out);

}  // namespace limn
