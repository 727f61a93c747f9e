#pragma once
// The edges of solids made of flat faces, and which parts of them are seen, from rays cast at polygons one by one.

#include <vector>

#include "raymarch/border/edge_visibility.h"
#include "sdf/camera.h"
#include "subdiv/mesh.h"

namespace limn::test {

/// Convex flat faces, and their edges found anew from equal positions.
struct Solid {
  std::vector<std::vector<glm::dvec3>> faces;
  std::vector<int> materials;
};
struct SolidEdge {
  glm::dvec3 a, b;
  std::vector<size_t> faces;
};

glm::dvec3 normal_of(const std::vector<glm::dvec3>& face);
std::vector<SolidEdge> edges_of(const Solid& solid);
Solid solid_of(const Mesh& mesh, const glm::dvec3& moved = glm::dvec3(0.0));

/// An edge's image and which points of it are seen, kPointsPerPixel of them a pixel, evenly.
inline constexpr double kPointsPerPixel = 32.0;
struct SampledEdge {
  glm::dvec3 a, b;  ///< (x px, y px, Z)
  SolidEdge edge;
  Projection projection = Projection::perspective;
  std::vector<char> seen;
  double place(size_t i) const { return (static_cast<double>(i) + 0.5) / static_cast<double>(seen.size()); }
  glm::dvec2 image(double s) const { return glm::mix(glm::dvec2(a), glm::dvec2(b), s); }
  double length_px() const { return glm::length(glm::dvec2(b - a)); }
  /// Evenly in the image is unevenly along the edge in perspective.
  glm::dvec3 world(double s) const {
    if (projection == Projection::orthographic) return glm::mix(edge.a, edge.b, s);
    const double at_a = (1.0 - s) / a.z, at_b = s / b.z;
    return (at_a * edge.a + at_b * edge.b) / (at_a + at_b);
  }
};

SampledEdge sample_edge(const std::vector<Solid>& solids, const Solid& own, const SolidEdge& edge, const Camera& camera);
/// Runs of points seen, as stretches of the edge.
std::vector<EdgeStretch> runs(const SampledEdge& edge);
/// Seen from a place in the image a fiftieth of a pixel away: rounding may take it for either.
bool seen_nearby(const std::vector<Solid>& solids, const Solid* own, const SolidEdge& edge, const glm::dvec3& point, const Camera& camera);

}  // namespace limn::test
