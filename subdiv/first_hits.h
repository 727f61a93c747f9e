#pragma once
// The nearest hits of a few thousand rays on any number of triangles. The rays are what is arranged, in a lattice, and the triangles pass
// it once: the time grows with the triangles as reading them does, the memory with the rays alone, and no tree is built.

#include <limits>
#include <span>
#include <vector>

#include "sdf/level_set_thin.h"
#include "subdiv/mesh.h"

namespace limn {

struct SegmentRay {
  glm::dvec3 origin{0.0}, direction{0.0, 0.0, 1.0};  ///< Unit.
  double from = 0.0, to = 0.0;                       ///< A hit lies strictly between.
};

struct SegmentHit {
  double t = std::numeric_limits<double>::infinity();  ///< Infinite: nothing is hit.
  std::uint32_t triangle = 0;                          ///< Of equally near ones the lowest.
  bool found() const { return t < std::numeric_limits<double>::infinity(); }
};

/// One hit for each ray, tested in double precision; edges belong to the triangles on both of their sides, so that no ray slips between
/// two. The same for any number of threads.
std::vector<SegmentHit> first_hits(const TriangleMesh& mesh, std::span<const SegmentRay> rays);

/// Walls behind and gaps before points spread evenly over a mesh by area, so that shares of the points are shares of the surface.
struct ThinSamples {
  std::vector<size_t> triangles{};  ///< Where each point lies: the triangle's middle.
  std::vector<double> walls{};      ///< Along the normal inwards to the first triangle that faces the other way; infinite: there is none.
  std::vector<double> gaps{};       ///< The same outwards.
};

/// How many points are looked at, whatever the size of the mesh.
inline constexpr size_t kThinSamples = 1500;
/// Shares of the surface up to this may be thin without a warning, as for fields.
inline constexpr double kThinShare = kThinPlacesShare;

/// Looks no farther than `farthest`. `longest_side`: of the mesh's bounds; a millionth of it is where rays start.
ThinSamples thin_samples(const TriangleMesh& mesh, double longest_side, double farthest);

}  // namespace limn
