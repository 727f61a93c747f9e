#include <algorithm>
#include <numeric>

#include "raymarch/local/crease_crossing.h"
#include "raymarch/local/local_sources.h"
#include "raymarch/local/merge_flat.h"
#include "raymarch/local/merge_smooth.h"
#include "subdiv/snap_vertex.h"
#include "subdiv/tessellate.h"

namespace limn {
namespace {

/// On a smooth surface a thousandth of an edge does not turn the normal by 5 degrees.
const double kSameSideCosine = std::cos(5.0 * std::numbers::pi / 180.0);
/// How far into a triangle its side of a crease has the word, as a share of the way to its middle.
constexpr double kInside = 1e-3;

glm::dvec3 middle_of(const LocalTriangles& mesh, const LocalTriangle& triangle) {
  return (mesh.positions[triangle.vertices[0]] + mesh.positions[triangle.vertices[1]] + mesh.positions[triangle.vertices[2]]) / 3.0;
}

std::array<glm::dvec3, 2> ends_of(const LocalTriangles& mesh, const LocalEdge& edge) {
  const EdgeSide& side = edge.sides[edge.sides[0].triangle ? 0 : 1];
  const auto k = static_cast<size_t>(side.corner);
  return {mesh.positions[side.triangle->vertices[k]], mesh.positions[side.triangle->vertices[(k + 1) % 3]]};
}

/// The normal a little way from `corner` towards `inside`; zero where there is none.
glm::dvec3 normal_beside(LocalField& field, const glm::dvec3& corner, const glm::dvec3& inside) {
  return direction_of(field.project(corner + kInside * (inside - corner)).gradient);
}

/// Whether an edge's normals on one of its sides differ as those on two sides of a crease do.
bool may_cross(const LocalEdge& edge) {
  return std::any_of(edge.sides.begin(), edge.sides.end(), [](const EdgeSide& side) {
    if (!side.triangle) return false;
    const auto k = static_cast<size_t>(side.corner);
    return glm::dot(side.triangle->normals[k], side.triangle->normals[(k + 1) % 3]) < kCreaseCosine;
  });
}

EdgeMiddle middle_on(LocalField& field, const LocalTriangles& mesh, const LocalEdge& edge) {
  const auto [a, b] = ends_of(mesh, edge);
  Surroundings around;
  around.edge_length = 0.5 * glm::distance(a, b);
  for (const EdgeSide& side : edge.sides) {
    if (!side.triangle) continue;
    around.middles.push_back(middle_of(mesh, *side.triangle));
    for (const glm::dvec3& normal : side.triangle->normals) around.outward += normal;
  }
  const double length = glm::length(around.outward);
  around.outward = length > 0.0 ? around.outward / length : glm::dvec3(0.0);
  std::optional<glm::dvec3> crossing;
  if (may_cross(edge)) crossing = crease_crossing(field, a, b);
  const Snapped snapped = crossing ? Snapped{*crossing, true, 0.0} : snap(field, 0.5 * (a + b), around);
  EdgeMiddle middle{snapped.position, {}, snapped.feature, crossing.has_value()};
  const glm::dvec3 normal = field.unit_gradient(snapped.position);
  middle.normals = {normal, normal};
  for (size_t s = 0; s < 2; ++s) {
    const EdgeSide& side = edge.sides[s].triangle ? edge.sides[s] : edge.sides[1 - s];
    const glm::dvec3 own = normal_beside(field, middle.position, middle_of(mesh, *side.triangle));
    if (own == glm::dvec3(0.0)) continue;
    if (snapped.feature || glm::dot(normal, own) < kSameSideCosine) middle.normals[s] = own, middle.crease = true;
  }
  return middle;
}

void field_middles(const Field& field, const LocalTriangles& mesh, std::span<const LocalEdge> edges, std::span<EdgeMiddle> middles) {
  std::vector<glm::dvec3> points(edges.size());
  std::vector<double> reach(edges.size());
  for (size_t i = 0; i < edges.size(); ++i) {
    const auto [a, b] = ends_of(mesh, edges[i]);
    points[i] = 0.5 * (a + b);
    reach[i] = kSnapReach * glm::distance(a, b);
  }
  std::vector<std::uint32_t> all(edges.size());
  std::iota(all.begin(), all.end(), 0u);
  visit_groups(field, points, reach, std::move(all), [&](LocalField& local, std::span<const std::uint32_t> members) {
    for (const std::uint32_t i : members) middles[i] = middle_on(local, mesh, edges[i]);
  });
}

void crease_normals(const Field& field, std::span<const CreaseCorner> corners, std::span<glm::dvec3> normals) {
  std::vector<glm::dvec3> points(corners.size());
  std::vector<double> reach(corners.size());
  for (size_t i = 0; i < corners.size(); ++i) {
    points[i] = corners[i].position;
    reach[i] = glm::distance(corners[i].position, corners[i].inside);
  }
  std::vector<std::uint32_t> all(corners.size());
  std::iota(all.begin(), all.end(), 0u);
  visit_groups(field, points, reach, std::move(all), [&](LocalField& local, std::span<const std::uint32_t> members) {
    for (const std::uint32_t i : members) {
      const glm::dvec3 own = normal_beside(local, corners[i].position, corners[i].inside);
      if (own != glm::dvec3(0.0)) normals[i] = own;
    }
  });
}

LocalTriangles triangles_of(const Mesh& mesh) {
  const TriangleMesh triangles = triangulate(mesh, NormalKind::vertex, true);
  LocalTriangles result;
  result.positions = triangles.positions;
  for (size_t t = 0; t < triangles.triangles.size(); ++t) {
    LocalTriangle triangle;
    for (int k = 0; k < 3; ++k) {
      triangle.vertices[static_cast<size_t>(k)] = triangles.triangles[t][k];
      triangle.normals[static_cast<size_t>(k)] = glm::dvec3(triangles.corner_normals[3 * t + static_cast<size_t>(k)]);
    }
    triangle.face = triangles.triangle_faces[t];
    result.triangles.push_back(triangle);
  }
  return result;
}

size_t count_folded(const LocalTriangles& mesh) {
  return static_cast<size_t>(std::count_if(mesh.triangles.begin(), mesh.triangles.end(), [&](const LocalTriangle& triangle) {
    const auto position = [&](size_t k) { return mesh.positions[triangle.vertices[k]]; };
    return is_folded({position(0), position(1), position(2)}, triangle.normals);
  }));
}

/// The share of folded facets that a coarse mesh may have, and the level up to which a better one is looked for.
constexpr double kMostFolded = 0.005;
constexpr int kMostStartLevel = 2;

}  // namespace

LocalStart start_from_field(const Field& field, std::shared_ptr<const FieldCage> cage, std::int64_t max_bytes, bool steady) {
  LocalStart start;
  if (!cage) cage = find_field_cage(field);
  // Where the coarsest mesh goes across creases, no splitting of its edges would follow them.
  for (int level = 0; level <= kMostStartLevel; ++level) {
    start.mesh = tessellate(field, {.level = level, .normals = NormalKind::limit, .max_bytes = max_bytes, .cage = cage});
    start.triangles = triangles_of(start.mesh);
    const double folded = static_cast<double>(count_folded(start.triangles));
    if (folded <= kMostFolded * static_cast<double>(start.triangles.triangles.size())) break;
  }
  if (start.mesh.face_materials.empty()) {
    start.triangles = merge_flat(std::move(start.triangles));
    if (!steady) start.triangles = merge_smooth(std::move(start.triangles));
  }
  start.source.has_folds = true;
  // The walls of a tessellated field are resolved from the start; those of a cage may be thin beside its faces.
  start.source.coarse_px = 1.9;
  start.source.middles = [field](const LocalTriangles& mesh, std::span<const LocalEdge> edges, std::span<EdgeMiddle> middles) {
    field_middles(field, mesh, edges, middles);
  };
  start.source.crease_normals = [field](std::span<const CreaseCorner> corners, std::span<glm::dvec3> normals) {
    crease_normals(field, corners, normals);
  };
  return start;
}

}  // namespace limn
