#pragma once
// What OpenSubdiv is handed: a cage without anything that its topology cannot hold. Included by this folder's .cpp files only.

#include <opensubdiv/far/topologyRefiner.h>

#include <memory>
#include <string>
#include <vector>

#include "sdf/large_pages.h"
#include "subdiv/polygon.h"
#include "subdiv/refine.h"

namespace limn {

namespace Far = OpenSubdiv::Far;

/// A cage made fit for subdivision: corners repeated within a face taken out (but quads with one corner twice stay quads), faces left with
/// fewer than 3 corners and exact copies of faces dropped, unused vertices dropped, tags kept where they name an edge or vertex that is
/// there.
struct CleanCage {
  Mesh mesh;
  std::vector<std::int32_t> face_of;  ///< For each face of `mesh`: the given cage's.
};
CleanCage clean_cage(const Mesh& cage, Scheme scheme, const std::string& file);

/// The base level. Throws InputError where OpenSubdiv cannot hold the topology.
std::unique_ptr<Far::TopologyRefiner> make_refiner(const Mesh& clean, Scheme scheme, const std::string& file);

/// Counts after `level` refinements, from the base level's.
RefinedSize predict_from_base(const Far::TopologyRefiner& base, Scheme scheme, int level, bool has_colors);

/// Vertices that are corners of faces with a surface (BoundaryRule::none leaves faces at open edges out).
std::vector<char> used_vertices(const Far::TopologyLevel& level, bool holes_too = false);

/// Three numbers that OpenSubdiv's refiner can weigh and add.
struct WeightedPoint {
  glm::dvec3 p{0.0};
  void Clear(void* = nullptr) { p = glm::dvec3(0.0); }
  void AddWithWeight(const WeightedPoint& other, double weight) { p += weight * other.p; }
};

using Points = PassingVector<WeightedPoint>;

/// A refined level about to become a Mesh: OpenSubdiv's last level, and what was computed on it.
struct Refined {
  const Far::TopologyRefiner& refiner;
  Points positions;
  Points colors;
  std::vector<glm::vec3> normals;  ///< At the corners of the level's faces, holes among them; or none.
};

/// With the materials, groups and rules of the cage. `level_number`: that of the positions, 0 or the last.
Mesh as_mesh(Refined refined, const Mesh& cage, int level_number, bool keep_holes);

/// The limit at the vertices of a refiner's last level (whose faces are all quads, or triangles for Loop).
struct LimitFrame {
  Points positions, tangent1, tangent2;  ///< Tangents hold where the vertex has one tangent plane.
  /// Where a semi-sharp feature had not worn off: the vertex, and a unit normal for each of its faces in OpenSubdiv's order.
  struct Ring {
    int vertex = 0;
    std::vector<glm::vec3> normals;
  };
  std::vector<Ring> semi_sharp;
};

/// Position and tangents by OpenSubdiv's masks alone, in parallel. `points`: of the vertices of the last level.
void limit_points(const Far::TopologyRefiner& refiner, Scheme scheme, const Points& points, LimitFrame& frame);

/// OpenSubdiv's masks for smooth, creased and corner vertices. Its masks take darts (ends of creases) for smooth vertices and semi-sharp
/// ones for infinitely sharp ones; these two are worked out from the subdivision of their one-rings.
LimitFrame limit_frame(const Far::TopologyRefiner& refiner, Scheme scheme, const Points& points);

/// Unit normals of the limit at the corners of the last level's faces, in the order of its faces; those at `vertices` only if given.
std::vector<glm::vec3> limit_normals(const Far::TopologyRefiner& refiner, Scheme scheme, const Points& points, const LimitFrame& limit,
                                     const std::vector<int>* vertices = nullptr);

/// True where a semi-sharp feature has not yet worn off.
bool still_semi_sharp(const Far::TopologyLevel& level, int vertex);

/// The faces around one vertex: its neighbours along edges and, for quads, across faces, counter-clockwise. A closed ring has as many
/// edges as faces, an open one has one more.
struct OneRing {
  glm::dvec3 center{0.0};
  std::vector<glm::dvec3> edges, diagonals;
  std::vector<float> sharpness;  ///< Of the edges.
  float center_sharpness = 0.0f;
  size_t face_total = 0;
};
OneRing one_ring(const Far::TopologyLevel& level, Scheme scheme, const Points& points, int vertex);

/// Loose fans of several one-rings as one mesh, centre first in each.
struct Fans {
  Mesh mesh;
  std::vector<int> centers;
};
Fans gather_fans(const std::vector<OneRing>& rings, Scheme scheme, CreaseMethod creases);
CreaseMethod crease_method(const Far::TopologyRefiner& refiner);

/// Limit and tangents at the end of one infinitely sharp crease: invariant subspaces of the ring's subdivision matrix.
struct VertexLimit {
  glm::dvec3 position{0.0}, tangent1{0.0}, tangent2{0.0};
};
VertexLimit dart_limit(const OneRing& ring, Scheme scheme);

}  // namespace limn
