#pragma once
// What OpenSubdiv is handed: a cage without anything that its topology cannot hold. Included by this folder's .cpp files only.

#include <opensubdiv/far/topologyRefiner.h>

#include <memory>
#include <string>
#include <vector>

#include "subdiv/polygon.h"
#include "subdiv/refine.h"

namespace limn {

namespace Far = OpenSubdiv::Far;

/// A cage made fit for subdivision: corners repeated within a face taken out (collapsed quads become triangles), faces left with fewer
/// than 3 corners and exact copies of faces dropped, unused vertices dropped, tags kept where they name an edge or vertex that is there.
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
std::vector<char> used_vertices(const Far::TopologyLevel& level);

/// Three numbers that OpenSubdiv's refiner can weigh and add.
struct WeightedPoint {
  glm::dvec3 p{0.0};
  void Clear(void* = nullptr) { p = glm::dvec3(0.0); }
  void AddWithWeight(const WeightedPoint& other, double weight) { p += weight * other.p; }
};

/// Positions and tangents of the limit at the vertices of the last level.
struct LimitFrame {
  std::vector<WeightedPoint> positions, tangent1, tangent2;
};

/// Where a corner of the last level lies on the cage: its face, for n-gons the sub-quad, and (u, v) as LimitSurface::evaluate takes them.
struct CageLocation {
  int face = 0, sub_face = 0;
  glm::dvec2 uv{0.0};
};
CageLocation locate_corner(const Far::TopologyRefiner& refiner, Scheme scheme, int face, int corner);

/// True where a semi-sharp feature has not yet worn off at the last level, so that the masks for the limit do not apply.
bool still_semi_sharp(const Far::TopologyLevel& level, int vertex);

/// Unit normals of the limit at every corner of the last level's faces, in the order of its faces. `refined` holds the last level's
/// vertices, `limit` their limits, `surface` the limit surface (needed where a vertex is still semi-sharp; may be null elsewhere).
std::vector<glm::vec3> limit_normals(const Far::TopologyRefiner& refiner, Scheme scheme, const std::vector<WeightedPoint>& refined,
                                     const LimitFrame& limit, const LimitSurface* surface);

}  // namespace limn
