#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <tuple>

#include "sdf/parallel.h"
#include "subdiv/disjoint_sets.h"
#include "subdiv/polygon.h"

namespace limn {
namespace {

/// work(begin, end) for parts of 0..count that share their scratch memory.
template <class Work>
void for_parts(size_t count, const Work& work) {
  constexpr size_t kPart = 4096;
  parallel_for(size_t{0}, (count + kPart - 1) / kPart, [&](size_t part) { work(part * kPart, std::min(count, (part + 1) * kPart)); });
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

std::vector<glm::dvec3> face_normals(const Mesh& mesh, const std::vector<std::int32_t>& first) {
  std::vector<glm::dvec3> normals(mesh.face_count());
  for_parts(mesh.face_count(), [&](size_t begin, size_t end) {
    std::vector<glm::dvec3> corners;
    for (size_t f = begin; f < end; ++f) {
      gather_corners(mesh, face_corners(mesh, first[f], f), corners);
      // A face without area has no normal and must not bend its neighbours'.
      normals[f] = zero_area(corners) ? glm::dvec3(0.0) : unit_or(vector_area(corners), glm::dvec3(0.0));
    }
  });
  return normals;
}

/// Which corners are at each vertex, rising; and of what faces.
struct VertexCorners {
  std::vector<std::int32_t> first;    ///< Of each vertex in `corners`, with one past the end.
  std::vector<std::int32_t> corners;  ///< Numbers of corners.
  std::vector<std::int32_t> faces;    ///< For each corner of the mesh.
};

VertexCorners corners_by_vertex(const Mesh& mesh) {
  VertexCorners result;
  result.first.assign(mesh.vertex_count() + 1, 0);
  for (const std::int32_t v : mesh.corner_vertices) ++result.first[static_cast<size_t>(v) + 1];
  std::partial_sum(result.first.begin(), result.first.end(), result.first.begin());
  result.corners.resize(mesh.corner_vertices.size());
  std::vector<std::int32_t> next(result.first.begin(), result.first.end() - 1);
  for (size_t c = 0; c < mesh.corner_vertices.size(); ++c)
    result.corners[static_cast<size_t>(next[static_cast<size_t>(mesh.corner_vertices[c])]++)] = static_cast<std::int32_t>(c);
  result.faces.reserve(mesh.corner_vertices.size());
  for (size_t f = 0; f < mesh.face_count(); ++f)
    result.faces.insert(result.faces.end(), static_cast<size_t>(mesh.face_sizes[f]), static_cast<std::int32_t>(f));
  return result;
}

/// One face's use of an edge that leaves a vertex.
struct EdgeUse {
  std::int32_t other;   ///< The vertex at the edge's other end.
  std::int32_t corner;  ///< Among the vertex's corners.
};

/// Memory for one vertex: sets of its corners that share a normal.
struct Scratch {
  DisjointSets sets{};
  std::vector<EdgeUse> uses, bridges;
  std::vector<glm::dvec3> sums;
};

/// The normals around one vertex after the other.
class VertexNormals {
 public:
  VertexNormals(const Mesh& mesh, const VertexCorners& at, const std::vector<glm::dvec3>& of_face, const std::vector<std::int32_t>& first,
                const Smoothing& smoothing)
      : mesh_(mesh), at_(at), of_face_(of_face), first_corners_(first), sharp_edges_(infinitely_sharp_edges(mesh)) {
    by_groups_ = smoothing.by_groups && !mesh.face_smoothing.empty();
    everywhere_ = !by_groups_ && smoothing.angle_deg >= 180.0;
    // A little more, so that the angle itself, as of a prism of twelve sides, is smooth whatever rounding says.
    cosine_ = std::cos(smoothing.angle_deg * std::numbers::pi / 180.0) - 1e-9;
  }

  /// The normals at the corners of one vertex.
  void write(size_t vertex, Scratch& scratch, std::vector<glm::vec3>& normals) const {
    const std::span<const std::int32_t> corners = corners_of(vertex);
    find_sets(static_cast<std::int32_t>(vertex), corners, scratch);
    scratch.sums.assign(corners.size(), glm::dvec3(0.0));
    for (size_t i = 0; i < corners.size(); ++i) {
      const auto face = static_cast<size_t>(face_of(corners[i]));
      const std::array<glm::dvec3, 3> around = {position(previous(corners[i])), mesh_.positions[vertex], position(next(corners[i]))};
      scratch.sums[scratch.sets.find(i)] += corner_angle(around, 1, of_face_[face]) * of_face_[face];
    }
    for (size_t i = 0; i < corners.size(); ++i) {
      const glm::dvec3& sum = scratch.sums[scratch.sets.find(i)];
      const glm::dvec3 own = unit_or(of_face_[static_cast<size_t>(face_of(corners[i]))], {0.0, 0.0, 1.0});
      // Opposite faces cancel to rounding noise; then a face's own normal is the honest answer.
      normals[static_cast<size_t>(corners[i])] = glm::vec3(glm::length(sum) > 1e-9 ? glm::normalize(sum) : own);
    }
  }

 private:
  std::span<const std::int32_t> corners_of(size_t vertex) const {
    const auto first = static_cast<size_t>(at_.first[vertex]), last = static_cast<size_t>(at_.first[vertex + 1]);
    return std::span(at_.corners).subspan(first, last - first);
  }
  std::int32_t face_of(std::int32_t corner) const { return at_.faces[static_cast<size_t>(corner)]; }
  std::int32_t previous(std::int32_t corner) const {
    const auto face = static_cast<size_t>(face_of(corner));
    return corner == first_corners_[face] ? first_corners_[face + 1] - 1 : corner - 1;
  }
  std::int32_t next(std::int32_t corner) const {
    const auto face = static_cast<size_t>(face_of(corner));
    return corner + 1 == first_corners_[face + 1] ? first_corners_[face] : corner + 1;
  }
  std::int32_t vertex_of(std::int32_t corner) const { return mesh_.corner_vertices[static_cast<size_t>(corner)]; }
  const glm::dvec3& position(std::int32_t corner) const { return mesh_.positions[static_cast<size_t>(vertex_of(corner))]; }
  bool without_area(std::int32_t face) const { return of_face_[static_cast<size_t>(face)] == glm::dvec3(0.0); }

  bool smooth(std::int32_t face_a, std::int32_t face_b) const {
    if (everywhere_) return true;
    const auto a = static_cast<size_t>(face_a), b = static_cast<size_t>(face_b);
    if (by_groups_) return mesh_.face_smoothing[a] != 0 && mesh_.face_smoothing[a] == mesh_.face_smoothing[b];
    return glm::dot(of_face_[a], of_face_[b]) >= cosine_;
  }

  bool infinitely_sharp(std::int32_t a, std::int32_t b) const {
    return std::binary_search(sharp_edges_.begin(), sharp_edges_.end(), std::pair<std::int32_t, std::int32_t>(std::minmax(a, b)));
  }

  /// The corners on one edge, two unless the mesh is open or not manifold there.
  void join_across(std::span<const EdgeUse> uses, std::span<const std::int32_t> corners, Scratch& scratch) const {
    for (size_t i = 1; i < uses.size(); ++i) {
      // Each with each, but a fan of thousands on one edge with its neighbours only.
      for (size_t j = uses.size() <= 16 ? 0 : i - 1; j < i; ++j) {
        const std::int32_t a = face_of(corners[static_cast<size_t>(uses[i].corner)]),
                           b = face_of(corners[static_cast<size_t>(uses[j].corner)]);
        if (!everywhere_ && !by_groups_ && (without_area(a) || without_area(b)))
          scratch.bridges.push_back(without_area(a) ? EdgeUse{uses[i].corner, uses[j].corner} : EdgeUse{uses[j].corner, uses[i].corner});
        else if (smooth(a, b))
          scratch.sets.join(static_cast<size_t>(uses[i].corner), static_cast<size_t>(uses[j].corner));
      }
    }
  }

  /// A face without area has no angle to its neighbours: those on both its sides are compared as if it were not there.
  void join_over_bridges(std::span<const std::int32_t> corners, Scratch& scratch) const {
    std::vector<EdgeUse>& bridges = scratch.bridges;
    std::sort(bridges.begin(), bridges.end(), by_other);
    for (size_t i = 1; i < bridges.size(); ++i) {
      if (bridges[i].other != bridges[i - 1].other) continue;
      const auto a = static_cast<size_t>(bridges[i - 1].corner), b = static_cast<size_t>(bridges[i].corner);
      const std::int32_t face_a = face_of(corners[a]), face_b = face_of(corners[b]);
      if (!without_area(face_a) && !without_area(face_b) && smooth(face_a, face_b)) scratch.sets.join(a, b);
    }
  }

  void find_sets(std::int32_t vertex, std::span<const std::int32_t> corners, Scratch& scratch) const {
    scratch.sets.reset(corners.size());
    scratch.uses.clear();
    scratch.bridges.clear();
    for (size_t i = 0; i < corners.size(); ++i) {
      scratch.uses.push_back({vertex_of(previous(corners[i])), static_cast<std::int32_t>(i)});
      scratch.uses.push_back({vertex_of(next(corners[i])), static_cast<std::int32_t>(i)});
    }
    std::sort(scratch.uses.begin(), scratch.uses.end(), by_other);
    for (size_t begin = 0, end = 0; begin < scratch.uses.size(); begin = end) {
      const std::int32_t other = scratch.uses[begin].other;
      while (end < scratch.uses.size() && scratch.uses[end].other == other) ++end;
      if (!sharp_edges_.empty() && infinitely_sharp(vertex, other)) continue;
      join_across(std::span(scratch.uses).subspan(begin, end - begin), corners, scratch);
    }
    if (!scratch.bridges.empty()) join_over_bridges(corners, scratch);
  }

  static bool by_other(const EdgeUse& a, const EdgeUse& b) { return std::tie(a.other, a.corner) < std::tie(b.other, b.corner); }

  const Mesh& mesh_;
  const VertexCorners& at_;
  const std::vector<glm::dvec3>& of_face_;
  const std::vector<std::int32_t>& first_corners_;
  std::vector<std::pair<std::int32_t, std::int32_t>> sharp_edges_;
  bool by_groups_ = false, everywhere_ = true;
  double cosine_ = -1.0;
};

}  // namespace

std::vector<glm::vec3> face_normals_at_corners(const Mesh& mesh) {
  const std::vector<glm::dvec3> of_face = face_normals(mesh, first_corners(mesh));
  std::vector<glm::vec3> normals;
  normals.reserve(mesh.corner_vertices.size());
  for (size_t f = 0; f < mesh.face_count(); ++f)
    normals.insert(normals.end(), static_cast<size_t>(mesh.face_sizes[f]), glm::vec3(unit_or(of_face[f], {0.0, 0.0, 1.0})));
  return normals;
}

std::vector<glm::vec3> angle_weighted_normals(const Mesh& mesh, const Smoothing& smoothing) {
  const std::vector<std::int32_t> first = first_corners(mesh);
  const std::vector<glm::dvec3> of_face = face_normals(mesh, first);
  const VertexCorners at = corners_by_vertex(mesh);
  const VertexNormals vertices(mesh, at, of_face, first, smoothing);
  std::vector<glm::vec3> normals(mesh.corner_vertices.size());
  for_parts(mesh.vertex_count(), [&](size_t begin, size_t end) {
    Scratch scratch;
    for (size_t v = begin; v < end; ++v) vertices.write(v, scratch, normals);
  });
  return normals;
}

}  // namespace limn
