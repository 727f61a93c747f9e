// Parts of a mesh: which are closed, which are turned inside out, and which only look so because they wall a cavity.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "subdiv/mesh_facts.h"
#include "subdiv/polygon.h"

namespace limn {
namespace {

struct Part {
  bool closed = true;
  double volume = 0.0;
  Box box{};
  glm::dvec3 point{0.0};  ///< A vertex of it.
};

/// Angle under which a triangle is seen (Van Oosterom & Strackee 1983), signed.
double solid_angle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
  const double below = la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb;
  return 2.0 * std::atan2(glm::dot(a, glm::cross(b, c)), below);
}

template <class Visit>
void visit_triangles(const Mesh& mesh, Visit visit) {
  std::vector<glm::dvec3> corners;
  std::int32_t first = 0;
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    gather_corners(mesh, face_corners(mesh, first, f), corners);
    first += mesh.face_sizes[f];
    for (size_t i = 2; i < corners.size(); ++i) visit(f, corners[0], corners[i - 1], corners[i]);
  }
}

std::vector<Part> measure_parts(const Mesh& mesh, const std::vector<Edge>& edges, const std::vector<std::int32_t>& part_of, size_t count) {
  std::vector<Part> parts(count);
  for (const Edge& edge : edges)
    if (edge.face_count != 2 || !edge.consistent) parts[static_cast<size_t>(part_of[static_cast<size_t>(edge.face_a)])].closed = false;
  const glm::dvec3 center = bounds(mesh).center();
  visit_triangles(mesh, [&](size_t f, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    Part& part = parts[static_cast<size_t>(part_of[f])];
    part.volume += glm::dot(a - center, glm::cross(b - center, c - center)) / 6.0;
    for (const glm::dvec3& p : {a, b, c}) part.box = include(part.box, p);
    part.point = a;
  });
  return parts;
}

bool holds(const Box& outer, const Box& inner) {
  return glm::all(glm::lessThan(outer.lower, inner.lower)) && glm::all(glm::lessThan(inner.upper, outer.upper));
}

/// Winding number of the parts of positive volume about `point`.
double winding_of_positive(const Mesh& mesh, const std::vector<std::int32_t>& part_of, const std::vector<Part>& parts,
                           const glm::dvec3& point) {
  double sum = 0.0;
  visit_triangles(mesh, [&](size_t f, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    const Part& part = parts[static_cast<size_t>(part_of[f])];
    if (part.closed && part.volume > 0.0) sum += solid_angle(a - point, b - point, c - point);
  });
  return sum / (4.0 * std::numbers::pi);
}

/// Beyond it a part within the box of another is taken to lie in the other: looking at every triangle for each would take too long.
constexpr double kMostSolidAngles = 3e6;

}  // namespace

void count_parts(const Mesh& mesh, const std::vector<Edge>& edges, MeshFacts& facts) {
  std::vector<std::int32_t> part_of;
  facts.parts = part_of_faces(mesh, part_of);
  const std::vector<Part> parts = measure_parts(mesh, edges, part_of, static_cast<size_t>(facts.parts));
  double looked_at = 0.0;
  for (const Part& part : parts) {
    if (!part.closed) continue;
    ++facts.closed_parts;
    facts.volume += part.volume;
    if (!(part.volume < 0.0)) continue;
    bool within = std::any_of(parts.begin(), parts.end(),
                              [&](const Part& other) { return other.closed && other.volume > 0.0 && holds(other.box, part.box); });
    if (within && (looked_at += static_cast<double>(mesh.corner_vertices.size())) < kMostSolidAngles)
      within = winding_of_positive(mesh, part_of, parts, part.point) > 0.5;
    ++(within ? facts.cavities : facts.inverted_parts);
  }
}

}  // namespace limn
