#include "raymarch/local/crease_crossing.h"

#include <array>
#include <cmath>

#include "subdiv/snap_vertex.h"
#include "subdiv/surface_snap.h"

namespace limn {
namespace {

struct SurfacePoint {
  double share = 0.0;  ///< Of the way along the edge.
  glm::dvec3 position{0.0}, normal{0.0};
};

bool bring(LocalField& field, SurfacePoint& point) {
  const Landing landing = field.project(point.position);
  point.position = landing.position;
  if (!landing.reached) return false;
  point.normal = direction_of(landing.gradient);
  return point.normal != glm::dvec3(0.0);
}

bool beside(LocalField& field, const glm::dvec3& a, const glm::dvec3& b, double share, SurfacePoint& point) {
  point = {share, a + share * (b - a), {}};
  return bring(field, point);
}

using Sides = std::array<SurfacePoint, 2>;

bool differ(const Sides& sides) { return glm::dot(sides[0].normal, sides[1].normal) < kCreaseCosine; }

/// Halves the way between two points of different normals; false where these come to agree, as on a smooth surface that turns.
bool narrow(LocalField& field, const glm::dvec3& a, const glm::dvec3& b, Sides& sides) {
  constexpr int kHalvings = 14;
  for (int k = 0; k < kHalvings; ++k) {
    SurfacePoint middle;
    if (!beside(field, a, b, 0.5 * (sides[0].share + sides[1].share), middle)) return false;
    const bool is_first = glm::dot(sides[0].normal, middle.normal) > glm::dot(middle.normal, sides[1].normal);
    sides[is_first ? 0 : 1] = middle;
  }
  return differ(sides);
}

/// From two points on both sides to where they meet: planes at points ever nearer to it (as in surface_snap.cpp, with two sides that are
/// known, however sharp the wedge between them is).
std::optional<glm::dvec3> meet(LocalField& field, const Sides& from, const glm::dvec3& start, double most) {
  glm::dvec3 at = start;
  Sides sides = from;
  for (const double fraction : {1.0, 0.5, 0.2, 0.2, 0.05, 0.01, 1e-3, 1e-5, 1e-7}) {
    for (size_t s = 0; s < 2 && fraction < 1.0; ++s) {
      sides[s].position = at + fraction * (from[s].position - at);
      if (!bring(field, sides[s])) return {};
    }
    if (!differ(sides)) return {};
    const glm::dvec3 step = meet_planes({sides[0].position, sides[1].position}, {sides[0].normal, sides[1].normal}, at) - at;
    // Planes at curved sides of a sharp wedge meet too far out.
    at += step * std::min(1.0, 0.5 * most / std::max(glm::length(step), 1e-300));
    if (!(glm::distance(at, start) < most)) return {};
  }
  return at;
}

}  // namespace

std::optional<glm::dvec3> crease_crossing(LocalField& field, const glm::dvec3& a, const glm::dvec3& b) {
  constexpr int kSteps = 8;
  const double length = glm::distance(a, b);
  std::optional<glm::dvec3> found;
  double found_share = 0.0;
  SurfacePoint last;
  for (int step = 0; step <= kSteps; ++step) {
    SurfacePoint point;
    if (!beside(field, a, b, kCrossingAtEnd + (1.0 - 2.0 * kCrossingAtEnd) * step / kSteps, point)) return {};
    Sides sides{last, point};
    last = point;
    if (step == 0 || !differ(sides) || !narrow(field, a, b, sides)) continue;
    const double share = sides[0].share;
    if (found && std::abs(share - 0.5) >= std::abs(found_share - 0.5)) continue;
    const std::optional<glm::dvec3> met = meet(field, sides, a + share * (b - a), 3.0 * length);
    if (!met || std::min(glm::distance(*met, a), glm::distance(*met, b)) < kCrossingAtEnd * length) continue;
    found = met, found_share = share;
  }
  return found;
}

}  // namespace limn
