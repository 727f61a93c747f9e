#pragma once
// Triangles arranged for distance, visibility and winding number. Used by the mesh-to-level-set files of this folder.

#include <optional>
#include <span>

#include "subdiv/mesh_level_set.h"

namespace limn {

/// Closest point of the triangle (a, b, c), zero-area ones included (Ericson 2005, section 5.1.5).
glm::dvec3 closest_on_triangle(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);

/// Embree's tree over the triangles, and exact answers at its leaves.
struct ClosestPointData {
  explicit ClosestPointData(const TriangleMesh& mesh);
  ~ClosestPointData();
  ClosestPointData(const ClosestPointData&) = delete;
  ClosestPointData& operator=(const ClosestPointData&) = delete;

  /// The closest triangle within `radius` (of equally close ones the lowest), or nothing.
  /// `likely`: triangles that may be close, which spare the search what lies beyond them; any, or none, give the same answer.
  std::optional<ClosestPoint> within(const glm::dvec3& point, double radius, std::span<const std::uint32_t> likely = {}) const;

  std::vector<glm::dvec3> positions;
  std::vector<glm::uvec3> triangles;
  glm::dvec3 center{0.0};
  double extent = 0.0;
  void* device = nullptr;
  void* scene = nullptr;
};

/// Eight edges of a border, as Winding::BorderEdge has each; those beyond the last are there no times.
struct alignas(64) EdgeGroup {
  double a[3][8], b[3][8];  ///< By axis.
  double times[8];
};

/// The generalised winding number (Jacobson, Kavan & Sorkine-Hornung 2013) by a tree of dipoles (Barill et al. 2018), and the border that
/// makes it change away from the triangles.
class Winding {
 public:
  /// Refers to the mesh. `first_at`: first_at_position of its positions. `times`: how often each triangle is there, as MergedTriangles has
  /// it.
  explicit Winding(const TriangleMesh& mesh);
  Winding(const TriangleMesh& mesh, std::span<const std::uint32_t> first_at, std::vector<std::int32_t> times = {});

  /// How far, in radii of clusters, is far; and by how much the number errs then, at most.
  static constexpr double kFarLook = 2.5, kFarError = 0.03;
  /// Clusters count as dipoles beyond `far` of their radii.
  double number(const glm::dvec3& point, double far = kFarLook) const;

  /// A stretch of the surface's border (corners welded by position, opposite uses cancelled), as its triangles go along it; `multiplicity`
  /// times over, at least once. Mostly each begins where the one before it ends.
  struct BorderEdge {
    glm::dvec3 a{0.0}, b{0.0};
    int multiplicity = 1;
  };
  const std::vector<BorderEdge>& border() const { return border_; }
  bool closed() const { return border_.empty(); }
  const glm::dvec3& corner(std::uint32_t triangle, int i) const { return mesh_.positions[mesh_.triangles[triangle][i]]; }
  /// How often the triangle is there.
  int times(std::uint32_t triangle) const { return times_.empty() ? 1 : times_[triangle]; }
  /// The number but for a whole one, and its gradient away from the triangles.
  struct Potential {
    double part = 0.0;  ///< From -1/2 to 1/2.
    glm::dvec3 gradient{0.0};
  };
  /// They depend on the border alone, and are right to rounding. Eight points take little longer than one; sizes equal.
  void potentials(std::span<const glm::dvec3> points, std::span<Potential> out) const;
  Potential potential(const glm::dvec3& point) const;
  glm::dvec3 gradient(const glm::dvec3& point) const { return potential(point).gradient; }

  /// No gradient within `radius` of `center` is longer than this.
  double gradient_bound(const glm::dvec3& center, double radius) const;
  /// The border, eight edges each.
  const std::vector<EdgeGroup>& border_groups() const { return border_groups_; }

 private:
  struct Node {
    glm::dvec3 center{0.0}, dipole{0.0};
    double radius = 0.0;
    std::uint32_t first = 0, count = 0;  ///< Triangles of a leaf, in order_.
    std::uint32_t left = 0, right = 0;   ///< Both 0 for a leaf.
  };
  struct Builder;
  void find_border(std::span<const std::uint32_t> first_at);

  const TriangleMesh& mesh_;
  std::vector<std::int32_t> times_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;  ///< Triangles, in the order of the leaves.
  std::vector<BorderEdge> border_;
  std::vector<EdgeGroup> border_groups_;
};

/// Origins (multiples of 8) of the blocks of 8^3 nodes that come within `reach` (world) of a triangle, sorted; nodes lie at
/// voxel_size * (i, j, k). Throws InputError once there are more than `max_blocks`.
std::vector<glm::ivec3> blocks_near_triangles(const TriangleMesh& mesh, double voxel_size, double reach, std::int64_t max_blocks);

}  // namespace limn
