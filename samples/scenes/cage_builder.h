#pragma once
// Subdivision cages from rings and bands, extrusions and tubes.

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "subdiv/mesh.h"

namespace limn {

/// A point of a profile that is turned about the y axis.
struct ProfilePoint {
  double radius = 0.0, y = 0.0;
  float sharpness = 0.0f;  ///< Of the crease around the ring; 0 is smooth.
};

/// Faces are given counter-clockwise seen from outside. A removed face leaves a hole until something is joined to its edges.
class CageBuilder {
 public:
  using Loop = std::vector<std::int32_t>;

  std::int32_t vertex(const glm::dvec3& position);
  Loop vertices(std::span<const glm::dvec3> positions);
  const glm::dvec3& position(std::int32_t vertex) const { return positions_[static_cast<size_t>(vertex)]; }

  /// Returns the face's number.
  int face(Loop corners);
  const Loop& corners(int face) const { return faces_[static_cast<size_t>(face)]; }
  void remove(int face) { faces_[static_cast<size_t>(face)].clear(); }

  /// Quads between two loops of the same length, corner i to corner i. `from` runs counter-clockwise seen from the side of `to`.
  /// Returns the number of the first; quad i stands on from[i], from[i + 1].
  int band(const Loop& from, const Loop& to);
  /// The face replaced by a copy moved by `offset` and walls up to it; returns the copy.
  int extrude(int face, const glm::dvec3& offset);
  /// A tube from one face through `sections` (each with as many corners as the faces) to another; both faces go.
  void tube(int from, std::span<const std::vector<glm::dvec3>> sections, int to);

  void crease(std::int32_t a, std::int32_t b, float sharpness);
  void crease_loop(const Loop& loop, float sharpness);

  /// Rings about the y axis joined by bands, closed below and above by polygons: first and last point are the rims of those.
  /// A profile that runs up the outside and down the inside makes a vessel. Angles start at `phase` (radians) and run from +x to -z.
  struct Revolution {
    std::vector<Loop> rings;
    std::vector<int> bands;  ///< First face of each.
    int segments = 0;
  };
  Revolution revolve(std::span<const ProfilePoint> profile, int segments, double phase);

  Mesh mesh() const;

 private:
  std::vector<glm::dvec3> positions_;
  std::vector<Loop> faces_;
  std::vector<Crease> creases_;
};

}  // namespace limn
