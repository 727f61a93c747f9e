#include "raymarch/local/merge_smooth.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "raymarch/local/edge_collapse.h"

namespace limn {
namespace {

const double kLeastFit = std::cos(30.0 * std::numbers::pi / 180.0);
/// Of a triangle, over its longest side.
constexpr double kLeastHeight = 0.2;
/// Each pass merges a fourth of the vertices at most; coarser than all of them make it, edges would be asked to be split again.
constexpr int kMostPasses = 8;

/// The normal at u in the triangles of a fan; nothing where they differ, as where the edge between u and the fan's vertex is a crease.
std::optional<glm::dvec3> normal_at(const CollapsingMesh& mesh, std::uint32_t u, const VertexFan& fan) {
  std::optional<glm::dvec3> normal;
  for (const std::uint32_t t : fan.triangles) {
    if (!mesh.has_vertex(t, u)) continue;
    const glm::dvec3& own = mesh.triangle(t).normals[mesh.corner_of(t, u)];
    if (normal && glm::distance(*normal, own) > kSameVertexNormal) return std::nullopt;
    normal = own;
  }
  return normal;
}

/// Of the triangles that are left when v goes to u, where the normal is `normal`, how well they fit the normals at their corners; -1 where
/// one becomes a needle.
double fit_of(const CollapsingMesh& mesh, std::uint32_t v, std::uint32_t u, const glm::dvec3& normal, const VertexFan& fan) {
  double least = 1.0;
  for (const std::uint32_t t : fan.triangles) {
    if (mesh.has_vertex(t, u)) continue;
    LocalTriangle triangle = mesh.triangle(t);
    const size_t k = mesh.corner_of(t, v);
    triangle.vertices[k] = u, triangle.normals[k] = normal;
    if (mesh.height_of(triangle.vertices) < kLeastHeight) return -1.0;
    least = std::min(least, mesh.fit_of(triangle.vertices, triangle.normals));
    if (least <= kLeastFit) return least;
  }
  return least;
}

struct Target {
  std::uint32_t vertex = 0;
  glm::dvec3 normal{0.0};
};

/// Of a smooth vertex: the neighbour to which it goes best.
std::optional<Target> target_of(const CollapsingMesh& mesh, std::uint32_t v, const VertexFan& fan) {
  if (fan.triangles.size() < 3 || !fan.closed || !normal_at(mesh, v, fan)) return std::nullopt;
  std::optional<Target> best;
  double most = kLeastFit;
  for (const std::uint32_t u : fan.ring) {
    const std::optional<glm::dvec3> normal = normal_at(mesh, u, fan);
    if (!normal) continue;
    const double fit = fit_of(mesh, v, u, *normal, fan);
    if (fit > most && mesh.is_linked(v, u, fan)) best = {u, *normal}, most = fit;
  }
  return best;
}

/// Merges what it can, no two neighbours, so that the surface becomes coarser evenly.
bool merge_once(CollapsingMesh& mesh) {
  std::vector<char> stays(mesh.vertex_count(), 0);
  bool any = false;
  for (std::uint32_t v = 0; v < stays.size(); ++v) {
    if (stays[v] != 0 || mesh.is_merged(v)) continue;
    const VertexFan fan = mesh.fan_of(v);
    const std::optional<Target> target = target_of(mesh, v, fan);
    if (!target) continue;
    for (const std::uint32_t u : fan.ring) stays[u] = 1;
    for (const std::uint32_t t : fan.triangles) mesh.triangle(t).normals[mesh.corner_of(t, v)] = target->normal;
    mesh.collapse(v, target->vertex, fan);
    any = true;
  }
  return any;
}

}  // namespace

LocalTriangles merge_smooth(LocalTriangles triangles) {
  if (!triangles.colors.empty()) return triangles;
  CollapsingMesh mesh(triangles);
  for (int pass = 0; pass < kMostPasses && merge_once(mesh); ++pass) {
  }
  mesh.compact();
  return triangles;
}

}  // namespace limn
