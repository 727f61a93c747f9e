#include "raymarch/local/edge_collapse.h"

#include <algorithm>

namespace limn {

CollapsingMesh::CollapsingMesh(LocalTriangles& mesh) : mesh_(mesh), at_(mesh.positions.size()), alive_(mesh.triangles.size(), 1) {
  for (size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t].vertices) at_[v].push_back(static_cast<std::uint32_t>(t));
}

VertexFan CollapsingMesh::fan_of(std::uint32_t v) const {
  VertexFan fan;
  fan.triangles = at_[v];
  std::vector<std::uint32_t> ahead, behind;
  for (const std::uint32_t t : fan.triangles) {
    const auto& corners = mesh_.triangles[t].vertices;
    const size_t k = corner_of(t, v);
    ahead.push_back(corners[(k + 1) % 3]), behind.push_back(corners[(k + 2) % 3]);
  }
  std::sort(ahead.begin(), ahead.end()), std::sort(behind.begin(), behind.end());
  // An edge that has one triangle, or three, or two on the same side.
  fan.closed = ahead == behind && std::adjacent_find(ahead.begin(), ahead.end()) == ahead.end();
  fan.ring = std::move(ahead);
  return fan;
}

size_t CollapsingMesh::corner_of(std::uint32_t t, std::uint32_t v) const {
  const auto& corners = mesh_.triangles[t].vertices;
  return corners[0] == v ? 0 : corners[1] == v ? 1 : 2;
}

bool CollapsingMesh::has_vertex(std::uint32_t t, std::uint32_t v) const {
  const auto& corners = mesh_.triangles[t].vertices;
  return std::find(corners.begin(), corners.end(), v) != corners.end();
}

glm::dvec3 CollapsingMesh::area_of(const std::array<std::uint32_t, 3>& v) const {
  return glm::cross(position(v[1]) - position(v[0]), position(v[2]) - position(v[0]));
}

double CollapsingMesh::height_of(const std::array<std::uint32_t, 3>& v) const {
  double longest = 0.0;
  for (size_t k = 0; k < 3; ++k) longest = std::max(longest, glm::distance(position(v[k]), position(v[(k + 1) % 3])));
  return glm::length(area_of(v)) / (longest * longest);
}

double CollapsingMesh::fit_of(const std::array<std::uint32_t, 3>& vertices, const std::array<glm::dvec3, 3>& normals) const {
  const glm::dvec3 area = area_of(vertices);
  const double length = glm::length(area);
  if (!(length > 0.0)) return -1.0;
  double least = 1.0;
  for (const glm::dvec3& normal : normals) least = std::min(least, glm::dot(area, normal) / length);
  return least;
}

bool CollapsingMesh::is_linked(std::uint32_t v, std::uint32_t u, const VertexFan& fan) const {
  const VertexFan other = fan_of(u);
  std::vector<std::uint32_t> ring = other.ring;
  if (!other.closed) {
    for (const std::uint32_t t : other.triangles)
      for (const std::uint32_t w : mesh_.triangles[t].vertices) ring.push_back(w);
    std::sort(ring.begin(), ring.end());
    ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
  }
  const auto shared = std::count_if(fan.ring.begin(), fan.ring.end(),
                                    [&](std::uint32_t w) { return w != u && std::binary_search(ring.begin(), ring.end(), w); });
  return shared == 2 && std::binary_search(fan.ring.begin(), fan.ring.end(), u) && v != u;
}

void CollapsingMesh::collapse(std::uint32_t v, std::uint32_t u, const VertexFan& fan) {
  for (const std::uint32_t t : fan.triangles) {
    auto& corners = mesh_.triangles[t].vertices;
    if (has_vertex(t, u)) {
      alive_[t] = 0;
      for (const std::uint32_t w : corners) std::erase(at_[w], t);
      continue;
    }
    corners[corner_of(t, v)] = u;
    at_[u].push_back(t);
  }
  at_[v].clear();
}

void CollapsingMesh::compact() {
  std::vector<std::uint32_t> number(mesh_.positions.size(), 0);
  std::vector<glm::dvec3> kept;
  for (size_t v = 0; v < number.size(); ++v) {
    number[v] = static_cast<std::uint32_t>(kept.size());
    if (!at_[v].empty()) kept.push_back(mesh_.positions[v]);
  }
  std::vector<LocalTriangle> triangles;
  for (size_t t = 0; t < alive_.size(); ++t) {
    if (!alive_[t]) continue;
    triangles.push_back(mesh_.triangles[t]);
    for (std::uint32_t& v : triangles.back().vertices) v = number[v];
  }
  mesh_.positions = std::move(kept);
  mesh_.triangles = std::move(triangles);
}

}  // namespace limn
