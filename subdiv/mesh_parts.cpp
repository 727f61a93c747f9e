#include "subdiv/mesh_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "subdiv/polygon.h"

namespace limn {
namespace {

/// An outside is only read from the volume of a part whose holes leave it this sure.
constexpr double kSureShare = 0.1;

using Triangle = std::array<glm::dvec3, 3>;

template <class Visit>
void visit_triangles(const Mesh& mesh, Visit visit) {
  std::vector<glm::dvec3> corners;
  std::int32_t first = 0;
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    gather_corners(mesh, face_corners(mesh, first, f), corners);
    first += mesh.face_sizes[f];
    for (size_t i = 2; i < corners.size(); ++i) visit(f, Triangle{corners[0], corners[i - 1], corners[i]});
  }
}

MeshParts measure(const Mesh& mesh, const Edges& edges) {
  MeshParts found;
  found.parts.resize(static_cast<size_t>(part_of_faces(mesh, found.of_face)));
  for (const Edge& edge : edges) {
    ConnectedPart& part = found.parts[static_cast<size_t>(found.of_face[static_cast<size_t>(edge.face_a)])];
    const bool agree = edge.face_count != 2 || edge.consistent;
    part.consistent = part.consistent && agree;
    part.closed = part.closed && edge.face_count == 2 && agree;
  }
  visit_triangles(mesh, [&](size_t f, const Triangle& t) {
    ConnectedPart& part = found.parts[static_cast<size_t>(found.of_face[f])];
    // About a vertex of its own: about a point far from a small part all digits would cancel.
    if (part.box.empty()) part.point = t[0];
    part.volume += glm::dot(t[0] - part.point, glm::cross(t[1] - part.point, t[2] - part.point)) / 6.0;
    part.area += 0.5 * glm::cross(t[1] - t[0], t[2] - t[0]);
    for (const glm::dvec3& p : t) part.box = include(part.box, p);
  });
  for (ConnectedPart& part : found.parts) part.volume += glm::dot(part.point - part.box.center(), part.area) / 3.0;
  return found;
}

/// Twice the signed area of (a, b, p) in the plane of y and z: the same but for the sign whichever end of the edge comes first, so that the
/// triangles on both sides of it agree on p.
double side_of(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& p) {
  const bool ordered = std::pair(a.y, a.z) < std::pair(b.y, b.z);
  const glm::dvec3 &from = ordered ? a : b, &to = ordered ? b : a;
  const double side = (to.y - from.y) * (p.z - from.z) - (p.y - from.y) * (to.z - from.z);
  return ordered ? side : -side;
}

/// How often the triangle crosses the ray from `p` along x, signed: 1 where it leaves by a face of a solid.
int crossing(const Triangle& t, const glm::dvec3& p) {
  int winding = 0;
  for (size_t i = 0; i < 3; ++i) {
    const glm::dvec3 &a = t[i], &b = t[(i + 1) % 3];
    const bool up = a.z <= p.z && b.z > p.z, down = a.z > p.z && b.z <= p.z;
    if ((up || down) && (up ? side_of(a, b, p) : -side_of(a, b, p)) > 0.0) winding += up ? 1 : -1;
  }
  if (winding == 0) return 0;
  const glm::dvec3 normal = glm::cross(t[1] - t[0], t[2] - t[0]);
  return glm::dot(normal, t[0] - p) * normal.x > 0.0 ? winding : 0;
}

bool holds(const Box& outer, const Box& inner) {
  return glm::all(glm::lessThan(outer.lower, inner.lower)) && glm::all(glm::lessThan(inner.upper, outer.upper));
}

/// The parts of negative volume that lie within the closed parts of positive volume: crossings of a ray from each, for all of them in one
/// pass over the triangles.
void find_cavities(const Mesh& mesh, MeshParts& found) {
  struct Asked {
    ConnectedPart* part;
    int winding = 0;
  };
  std::vector<Asked> asked;
  for (ConnectedPart& part : found.parts) {
    const auto around = [&](const ConnectedPart& other) { return other.closed && other.volume > 0.0 && holds(other.box, part.box); };
    if (part.inverted && part.closed && std::any_of(found.parts.begin(), found.parts.end(), around)) asked.push_back({&part});
  }
  if (asked.empty()) return;
  std::sort(asked.begin(), asked.end(), [](const Asked& a, const Asked& b) { return a.part->point.y < b.part->point.y; });
  visit_triangles(mesh, [&](size_t f, const Triangle& t) {
    const ConnectedPart& part = found.parts[static_cast<size_t>(found.of_face[f])];
    if (!part.closed || !(part.volume > 0.0)) return;
    const auto [low, high] = std::minmax({t[0].y, t[1].y, t[2].y});
    auto at = std::lower_bound(asked.begin(), asked.end(), low, [](const Asked& a, double y) { return a.part->point.y < y; });
    for (; at != asked.end() && at->part->point.y <= high; ++at) at->winding += crossing(t, at->part->point);
  });
  for (const Asked& one : asked) {
    one.part->cavity = one.winding > 0;
    one.part->inverted = !one.part->cavity;
  }
}

}  // namespace

bool ConnectedPart::encloses() const {
  const glm::dvec3 half = 0.5 * (box.upper - box.lower);
  return consistent && glm::dot(half, glm::abs(area)) / 3.0 <= kSureShare * std::abs(volume);
}

bool may_be_inverted(const Mesh& mesh) {
  const MeshParts found = measure(mesh, {});
  return std::any_of(found.parts.begin(), found.parts.end(),
                     [](const ConnectedPart& part) { return part.volume < 0.0 && part.encloses(); });
}

MeshParts find_parts(const Mesh& mesh, const Edges& edges) {
  MeshParts found = measure(mesh, edges);
  for (ConnectedPart& part : found.parts) part.inverted = part.volume < 0.0 && part.encloses();
  find_cavities(mesh, found);
  return found;
}

}  // namespace limn
