#include <algorithm>
#include <cmath>

#include "sdf/parallel.h"
#include "subdiv/polygon.h"

namespace limn {
namespace {

/// The normals that triangles are given, a corner at a time: a file's need no second copy to be made unit.
struct CornerNormals {
  std::span<const glm::vec3> given{};  ///< Of the file.
  std::vector<glm::vec3> own{};        ///< Those of `kind`; of the faces, where some of the given are no directions.

  bool empty() const { return given.empty() && own.empty(); }
  glm::vec3 at(size_t corner) const {
    if (given.empty()) return own[corner];
    const float length = glm::length(given[corner]);
    return is_direction(length) ? given[corner] / length : own[corner];
  }
  static bool is_direction(float length) { return length > 1e-20f && std::isfinite(length); }
};

CornerNormals normals_at_corners(const Mesh& mesh, NormalKind kind, std::span<const glm::vec3> given, const Smoothing& smoothing) {
  if (!given.empty()) {
    const bool good =
        std::all_of(given.begin(), given.end(), [](const glm::vec3& n) { return CornerNormals::is_direction(glm::length(n)); });
    return {given, good ? std::vector<glm::vec3>{} : face_normals_at_corners(mesh)};
  }
  if (kind != NormalKind::flat) return {{}, angle_weighted_normals(mesh, smoothing)};
  // A polygon is one facet however it is cut; a mesh of triangles needs no list to say so.
  for (const std::int32_t size : mesh.face_sizes)
    if (size > 3) return {{}, face_normals_at_corners(mesh)};
  return {};
}

/// A run of faces, and where it starts among the corners and the triangles.
struct FaceRun {
  size_t first_face = 0, last_face = 0;
  size_t first_corner = 0, first_triangle = 0;
};

/// Faces that are fans of triangles with an area each, which need no second look.
using PlainFaces = std::vector<char>;

/// Whether a polygon is a quad that turns the same way by far more than rounding at each of its corners: then it is a fan of two triangles
/// with an area each, whatever triangulate_polygon() and zero_area() round. Most faces of refined meshes are.
bool is_clearly_convex_quad(std::span<const glm::dvec3> corners) {
  constexpr double kClearly = 1e-8;  // of the longest edge's square, where those two ask for 1e-14
  if (corners.size() != 4) return false;
  const glm::dvec3 edges[4] = {corners[1] - corners[0], corners[2] - corners[1], corners[3] - corners[2], corners[0] - corners[3]};
  const glm::dvec3 area = vector_area(corners);
  double longest = 0.0;
  for (const glm::dvec3& edge : edges) longest = std::max(longest, glm::dot(edge, edge));
  const double least = kClearly * longest, least_squared = least * least * glm::dot(area, area);
  for (size_t i = 0; i < 4; ++i) {
    const double turn = glm::dot(glm::cross(edges[i], edges[(i + 1) % 4]), area);
    if (!(turn > 0.0 && turn * turn > least_squared)) return false;
  }
  return std::isfinite(least_squared);
}

/// visit(face, its first corner, its corners' vertices, a triangle as three numbers of them) for each triangle; returns how many have no
/// area and were left out.
template <class Visit>
std::int64_t visit_triangles(const Mesh& mesh, const FaceRun& run, PlainFaces& plain, bool known, const Visit& visit) {
  std::vector<glm::dvec3> corners;
  std::vector<std::array<std::int32_t, 3>> pieces;
  std::int64_t dropped = 0;
  size_t first = run.first_corner;
  for (size_t f = run.first_face; f < run.last_face; ++f) {
    const std::span<const std::int32_t> vertices = face_corners(mesh, static_cast<std::int32_t>(first), f);
    if (!known) {
      gather_corners(mesh, vertices, corners);
      plain[f] = is_clearly_convex_quad(corners);
    }
    if (plain[f]) {
      for (size_t k = 2; k < vertices.size(); ++k) visit(f, first, vertices, size_t{0}, k - 1, k);
      first += vertices.size();
      continue;
    }
    if (known) gather_corners(mesh, vertices, corners);
    triangulate_polygon(corners, pieces);
    bool is_plain = true;
    std::int32_t third = 1;
    for (const auto& piece : pieces) {
      is_plain = is_plain && piece[0] == 0 && piece[1] == third && piece[2] == third + 1;
      ++third;
      const auto a = static_cast<size_t>(piece[0]), b = static_cast<size_t>(piece[1]), c = static_cast<size_t>(piece[2]);
      if (zero_area(corners[a], corners[b], corners[c])) {
        ++dropped;
        is_plain = false;
      } else {
        visit(f, first, vertices, a, b, c);
      }
    }
    plain[f] = is_plain;
    first += vertices.size();
  }
  return dropped;
}

/// Runs of a fixed number of faces, so that threads change nothing; their triangles are counted, which also says where each run's go.
std::vector<FaceRun> runs_of(const Mesh& mesh, PlainFaces& plain, size_t& triangles, std::int64_t& dropped) {
  constexpr size_t kFaces = 8192;
  std::vector<FaceRun> runs;
  size_t corner = 0;
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    if (f % kFaces == 0) runs.push_back({f, std::min(f + kFaces, mesh.face_count()), corner, 0});
    corner += static_cast<size_t>(mesh.face_sizes[f]);
  }
  std::vector<size_t> counts(runs.size(), 0);
  std::vector<std::int64_t> without_area(runs.size(), 0);
  parallel_for(size_t{0}, runs.size(), [&](size_t i) {
    size_t count = 0;
    without_area[i] = visit_triangles(mesh, runs[i], plain, false,
                                      [&count](size_t, size_t, std::span<const std::int32_t>, size_t, size_t, size_t) { ++count; });
    counts[i] = count;
  });
  triangles = 0;
  dropped = 0;
  for (size_t i = 0; i < runs.size(); ++i) {
    runs[i].first_triangle = triangles;
    triangles += counts[i];
    dropped += without_area[i];
  }
  return runs;
}

}  // namespace

std::int64_t TriangleMesh::bytes() const {
  const size_t sum = positions.size() * sizeof(glm::dvec3) + triangles.size() * sizeof(glm::uvec3) +
                     corner_normals.size() * sizeof(glm::vec3) + (triangle_faces.size() + triangle_materials.size()) * sizeof(std::int32_t);
  return static_cast<std::int64_t>(sum);
}

namespace {

TriangleMesh triangles_without_holes(const Mesh& mesh, NormalKind kind, bool use_normals, const Smoothing& smoothing) {
  TriangleMesh result = triangulate(without_holes(mesh), kind, use_normals, smoothing);
  std::vector<std::int32_t> solid;
  size_t hole = 0;
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(mesh.face_count()); ++f) {
    if (hole < mesh.holes.size() && mesh.holes[hole] == f)
      ++hole;
    else
      solid.push_back(f);
  }
  for (std::int32_t& face : result.triangle_faces) face = solid[static_cast<size_t>(face)];
  return result;
}

}  // namespace

TriangleMesh triangulate(const Mesh& mesh, NormalKind kind, std::span<const glm::vec3> corner_normals, const Smoothing& smoothing) {
  if (!mesh.holes.empty()) {
    Mesh with_normals = mesh;
    with_normals.corner_normals.assign(corner_normals.begin(), corner_normals.end());
    return triangles_without_holes(with_normals, kind, !corner_normals.empty(), smoothing);
  }
  TriangleMesh result;
  size_t count = 0;
  PlainFaces plain(mesh.face_count(), 0);
  const std::vector<FaceRun> runs = runs_of(mesh, plain, count, result.dropped_triangles);
  const CornerNormals normals = normals_at_corners(mesh, kind, corner_normals, smoothing);
  // The system clears what is touched first: side by side.
  parallel_invoke(
      [&] {
        result.positions = mesh.positions;
        result.triangles.resize(count);
      },
      [&] {
        if (!normals.empty()) result.corner_normals.resize(3 * count);
        result.triangle_faces.resize(count);
        if (!mesh.face_materials.empty()) result.triangle_materials.resize(count);
      });
  parallel_for(size_t{0}, runs.size(), [&](size_t i) {
    size_t at = runs[i].first_triangle;
    visit_triangles(mesh, runs[i], plain, true,
                    [&](size_t f, size_t first, std::span<const std::int32_t> vertices, size_t a, size_t b, size_t c) {
                      result.triangles[at] = glm::uvec3(vertices[a], vertices[b], vertices[c]);
                      result.triangle_faces[at] = static_cast<std::int32_t>(f);
                      if (!mesh.face_materials.empty()) result.triangle_materials[at] = mesh.face_materials[f];
                      if (!normals.empty()) {
                        result.corner_normals[3 * at] = normals.at(first + a);
                        result.corner_normals[3 * at + 1] = normals.at(first + b);
                        result.corner_normals[3 * at + 2] = normals.at(first + c);
                      }
                      ++at;
                    });
  });
  return result;
}

TriangleMesh triangulate(const Mesh& mesh, NormalKind kind, bool use_mesh_normals, const Smoothing& smoothing) {
  return triangulate(mesh, kind, use_mesh_normals ? std::span(mesh.corner_normals) : std::span<const glm::vec3>{}, smoothing);
}

}  // namespace limn
