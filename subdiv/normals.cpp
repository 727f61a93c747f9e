#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "subdiv/polygon.h"

namespace limn {
namespace {

/// Corners that share a normal, as sets.
class CornerSets {
 public:
  explicit CornerSets(size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
  std::int32_t find(std::int32_t i) {
    while (parent_[static_cast<size_t>(i)] != i) {
      std::int32_t& up = parent_[static_cast<size_t>(i)];
      up = parent_[static_cast<size_t>(up)];
      i = up;
    }
    return i;
  }
  void join(std::int32_t a, std::int32_t b) {
    a = find(a), b = find(b);
    // The smaller index wins, so that the sums below run in the order of the corners whatever the order of the edges.
    if (a < b) parent_[static_cast<size_t>(b)] = a;
    if (b < a) parent_[static_cast<size_t>(a)] = b;
  }

 private:
  std::vector<std::int32_t> parent_;
};

/// A face's run along an undirected edge: the corners at the edge's smaller and larger vertex.
struct EdgeUse {
  std::int32_t low, high;
  std::int32_t corner_low, corner_high;
};

std::vector<EdgeUse> sorted_edge_uses(const Mesh& mesh) {
  std::vector<EdgeUse> uses;
  uses.reserve(mesh.corner_vertices.size());
  std::int32_t first = 0;
  for (const std::int32_t size : mesh.face_sizes) {
    for (std::int32_t i = 0; i < size; ++i) {
      const std::int32_t ca = first + i, cb = first + (i + 1) % size;
      const std::int32_t a = mesh.corner_vertices[static_cast<size_t>(ca)], b = mesh.corner_vertices[static_cast<size_t>(cb)];
      uses.push_back(a < b ? EdgeUse{a, b, ca, cb} : EdgeUse{b, a, cb, ca});
    }
    first += size;
  }
  std::sort(uses.begin(), uses.end(), [](const EdgeUse& x, const EdgeUse& y) {
    return std::tie(x.low, x.high, x.corner_low, x.corner_high) < std::tie(y.low, y.high, y.corner_low, y.corner_high);
  });
  return uses;
}

std::vector<std::pair<std::int32_t, std::int32_t>> infinitely_sharp_edges(const Mesh& mesh) {
  std::vector<std::pair<std::int32_t, std::int32_t>> edges;
  for (const Crease& crease : mesh.creases)
    if (crease.sharpness >= kInfiniteSharpness) edges.push_back(std::minmax(crease.vertex_a, crease.vertex_b));
  std::sort(edges.begin(), edges.end());
  return edges;
}

glm::dvec3 unit_or(const glm::dvec3& v, const glm::dvec3& fallback) {
  const double length = glm::length(v);
  return length > 0.0 && std::isfinite(length) ? v / length : fallback;
}

std::vector<glm::dvec3> face_normals(const Mesh& mesh) {
  std::vector<glm::dvec3> normals, corners;
  normals.reserve(mesh.face_count());
  std::int32_t first = 0;
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    gather_corners(mesh, face_corners(mesh, first, f), corners);
    // A face without area has no normal and must not bend its neighbours'.
    normals.push_back(zero_area(corners) ? glm::dvec3(0.0) : unit_or(vector_area(corners), glm::dvec3(0.0)));
    first += mesh.face_sizes[f];
  }
  return normals;
}

CornerSets smooth_corners(const Mesh& mesh) {
  CornerSets sets(mesh.corner_vertices.size());
  const std::vector<EdgeUse> uses = sorted_edge_uses(mesh);
  const auto sharp = infinitely_sharp_edges(mesh);
  for (size_t i = 1; i < uses.size(); ++i) {
    const EdgeUse &a = uses[i - 1], &b = uses[i];
    if (a.low != b.low || a.high != b.high) continue;
    if (std::binary_search(sharp.begin(), sharp.end(), std::pair(a.low, a.high))) continue;
    sets.join(a.corner_low, b.corner_low);
    sets.join(a.corner_high, b.corner_high);
  }
  return sets;
}

}  // namespace

std::vector<glm::vec3> face_normals_at_corners(const Mesh& mesh) {
  const std::vector<glm::dvec3> of_face = face_normals(mesh);
  std::vector<glm::vec3> normals;
  normals.reserve(mesh.corner_vertices.size());
  for (size_t f = 0; f < mesh.face_count(); ++f)
    normals.insert(normals.end(), static_cast<size_t>(mesh.face_sizes[f]), glm::vec3(unit_or(of_face[f], {0.0, 0.0, 1.0})));
  return normals;
}

std::vector<glm::vec3> angle_weighted_normals(const Mesh& mesh) {
  const std::vector<glm::dvec3> of_face = face_normals(mesh);
  CornerSets sets = smooth_corners(mesh);
  std::vector<glm::dvec3> sums(mesh.corner_vertices.size(), glm::dvec3(0.0)), corners;
  std::int32_t first = 0;
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    gather_corners(mesh, face_corners(mesh, first, f), corners);
    for (size_t i = 0; i < corners.size(); ++i) {
      const auto set = static_cast<size_t>(sets.find(first + static_cast<std::int32_t>(i)));
      sums[set] += corner_angle(corners, i, of_face[f]) * of_face[f];
    }
    first += mesh.face_sizes[f];
  }
  std::vector<glm::vec3> normals(mesh.corner_vertices.size());
  size_t corner = 0;
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    const glm::dvec3 own = unit_or(of_face[f], {0.0, 0.0, 1.0});
    for (std::int32_t i = 0; i < mesh.face_sizes[f]; ++i, ++corner) {
      const glm::dvec3& sum = sums[static_cast<size_t>(sets.find(static_cast<std::int32_t>(corner)))];
      // Opposite faces cancel to rounding noise; then a face's own normal is the honest answer.
      normals[corner] = glm::vec3(glm::length(sum) > 1e-9 ? glm::normalize(sum) : own);
    }
  }
  return normals;
}

}  // namespace limn
