#pragma once
// Internal: closed curves in space, and whether a point lies on one of them.

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <vector>

#include "raymarch/truth/lattice_samples.h"
#include "raymarch/truth/locate.h"

namespace limn {

/// Segments of closed curves by the cubes that they lie in. Many threads may ask at once, where none adds.
class PathIndex {
 public:
  /// `side`: of the cubes, world units.
  explicit PathIndex(double side) : side_(side) {}

  /// A curve, ready to be added.
  class Prepared;
  /// What takes the time, from any thread.
  Prepared prepare(const std::vector<CurvePoint>& points) const;
  void add(const Prepared& path);
  /// Another arm that runs close by has the higher N.V on its other side.
  bool holds(const CurvePoint& point) const;

 private:
  struct PathPoint {
    glm::dvec3 p{0.0}, uphill{0.0};
  };
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  /// Segments in a row that lie in a cube, from one point to the next, and the run before it in the same cube.
  struct Run {
    std::uint32_t begin = 0, end = 0, before = kNone;
  };

  double reach_of(double length) const;
  glm::ivec3 cube_of(const glm::dvec3& p) const { return glm::ivec3(glm::floor(p / side_)); }

  double side_;
  std::vector<PathPoint> points_{};  ///< Of each curve the first one again after its last.
  std::vector<Run> runs_{};
  KeyedValues<std::uint32_t> last_in_{};  ///< Of each cube the last run.
};

class PathIndex::Prepared {
  friend class PathIndex;
  struct CubeRun {
    std::uint64_t cube = 0;
    Run run{};
  };
  std::vector<PathPoint> points_{};
  std::vector<CubeRun> runs_{};
};

}  // namespace limn
