#include "subdiv/surface_snap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "sdf/parallel.h"
#include "subdiv/polygon.h"
#include "subdiv/snap_vertex.h"

namespace limn {
namespace {

/// A side that looks away from a vertex's faces by more (148 degrees) is the other one of a wall.
constexpr double kWallCosine = -0.85;

/// Sampled off the surface, and therefore stricter (10 degrees).
const double kPlainlySmoothCosine = std::cos(10.0 * std::numbers::pi / 180.0);

/// On a smooth surface a thousandth of an edge does not turn the normal by 5 degrees.
const double kSameSideCosine = std::cos(5.0 * std::numbers::pi / 180.0);

/// Which vertices are brought onto the surface: their numbers, and for each vertex its place among them, -1 for the others.
struct Moving {
  std::vector<std::uint32_t> vertices;
  std::vector<std::int32_t> place;
};

Moving moving_vertices(const Mesh& mesh, const std::vector<char>* which) {
  Moving moving{{}, std::vector<std::int32_t>(mesh.vertex_count(), -1)};
  for (size_t v = 0; v < mesh.vertex_count(); ++v) {
    if (which != nullptr && !(*which)[v]) continue;
    moving.place[v] = static_cast<std::int32_t>(moving.vertices.size());
    moving.vertices.push_back(static_cast<std::uint32_t>(v));
  }
  return moving;
}

/// One corner of a face, as its vertex has it: the face's place among those that are looked at, and which of its corners.
struct FaceCorner {
  std::uint32_t face = 0, corner = 0;
};

/// For each moving vertex the corners that it is of faces, in the order of the faces: those of the k-th are list[first[k]] up to
/// list[first[k + 1]].
struct CornersOfVertices {
  std::vector<std::uint32_t> faces{}, first{};
  std::vector<FaceCorner> list{};

  CornersOfVertices(const Mesh& mesh, const std::vector<std::int32_t>& first_corner, const Moving& moving)
      : first(moving.vertices.size() + 1, 0) {
    const auto place = [&moving](std::int32_t v) { return moving.place[static_cast<size_t>(v)]; };
    for (size_t f = 0; f < mesh.face_count(); ++f) {
      bool any = false;
      for (const std::int32_t v : face_corners(mesh, first_corner[f], f)) {
        if (place(v) < 0) continue;
        ++first[static_cast<size_t>(place(v)) + 1];
        any = true;
      }
      if (any) faces.push_back(static_cast<std::uint32_t>(f));
    }
    std::partial_sum(first.begin(), first.end(), first.begin());
    list.resize(first.back());
    std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
    for (std::uint32_t k = 0; k < faces.size(); ++k) {
      const auto corners = face_corners(mesh, first_corner[faces[k]], faces[k]);
      for (std::uint32_t i = 0; i < corners.size(); ++i)
        if (place(corners[i]) >= 0) list[next[static_cast<size_t>(place(corners[i]))]++] = {k, i};
    }
  }
};

std::vector<Surroundings> surroundings_of(const Mesh& mesh, const Moving& moving) {
  const std::vector<std::int32_t> first_corner = first_corners(mesh);
  const CornersOfVertices corners(mesh, first_corner, moving);
  const auto corners_of = [&](std::uint32_t k) { return face_corners(mesh, first_corner[corners.faces[k]], corners.faces[k]); };
  std::vector<glm::dvec3> middles(corners.faces.size()), areas(corners.faces.size());
  parallel_parts(corners.faces.size(), size_t{256}, [&](const IndexRange<size_t>& range) {
    std::vector<glm::dvec3> points;
    for (size_t k = range.begin(); k < range.end(); ++k) {
      gather_corners(mesh, corners_of(static_cast<std::uint32_t>(k)), points);
      glm::dvec3 middle(0.0);
      for (const glm::dvec3& p : points) middle += p;
      middles[k] = middle / static_cast<double>(points.size());
      areas[k] = vector_area(points);
    }
  });
  std::vector<Surroundings> around(moving.vertices.size());
  parallel_parts(around.size(), size_t{256}, [&](const IndexRange<size_t>& range) {
    for (size_t k = range.begin(); k < range.end(); ++k) {
      Surroundings& at = around[k];
      at.middles.reserve(corners.first[k + 1] - corners.first[k]);
      for (std::uint32_t i = corners.first[k]; i < corners.first[k + 1]; ++i) {
        const auto [face, corner] = corners.list[i];
        const auto vertices = corners_of(face);
        const auto position = [&](size_t c) { return mesh.positions[static_cast<size_t>(vertices[c % vertices.size()])]; };
        at.middles.push_back(middles[face]);
        at.edge_length += glm::distance(position(corner), position(size_t{corner} + 1));
        at.outward += areas[face];
      }
      if (at.middles.empty()) continue;
      at.edge_length /= static_cast<double>(at.middles.size());
      const double length = glm::length(at.outward);
      at.outward = length > 0.0 ? at.outward / length : glm::dvec3(0.0);
    }
  });
  return around;
}

/// In a thin wall the nearest sheet may be the wrong one, whose outside is the other way. Along the outward direction the right one is
/// where the field turns from negative to positive; the crossing nearest to `start` within one edge length is taken.
bool project_along(LocalField& field, glm::dvec3& point, const Surroundings& around) {
  constexpr int kSteps = 24;
  const double step = around.edge_length / kSteps;
  const auto at = [&](double t) { return point + t * around.outward; };
  double best = 2.0 * around.edge_length;
  double previous = field.value(at(-around.edge_length));
  for (int i = -kSteps + 1; i <= kSteps; ++i) {
    const double value = field.value(at(i * step));
    if (previous < 0.0 && value >= 0.0) {
      double in = (i - 1) * step, out = i * step;
      for (int k = 0; k < 60; ++k) {
        const double middle = 0.5 * (in + out);
        (field.value(at(middle)) < 0.0 ? in : out) = middle;
      }
      if (std::abs(out) < std::abs(best)) best = out;
    }
    previous = value;
  }
  if (best > around.edge_length) return false;
  point = at(best);
  return true;
}

/// Onto the sheet of the surface that looks the same way as the faces around the vertex.
bool project(LocalField& field, glm::dvec3& point, const Surroundings& around) {
  const glm::dvec3 start = point;
  const bool reached = field.project(point);
  if (reached && glm::dot(field.unit_gradient(point), around.outward) > -0.1) return true;
  glm::dvec3 along = start;
  if (!project_along(field, along, around)) return reached;
  point = along;
  return true;
}

/// Points of the surface a fraction of the way to the faces' middles, with their normals; true where the normals differ as at a crease.
bool sample_sides(LocalField& field, const glm::dvec3& x, const Surroundings& around, double fraction, std::vector<glm::dvec3>& points,
                  std::vector<glm::dvec3>& normals) {
  points.clear(), normals.clear();
  for (const glm::dvec3& middle : around.middles) {
    glm::dvec3 p = x + fraction * (middle - x);
    if (!field.project(p)) continue;
    const glm::dvec3 normal = field.unit_gradient(p);
    // The other side of a thin wall is no side of this vertex; that of a knife edge is.
    if (normal == glm::dvec3(0.0) || glm::dot(normal, around.outward) < kWallCosine) continue;
    points.push_back(p), normals.push_back(normal);
  }
  for (size_t i = 1; i < normals.size(); ++i)
    for (size_t j = 0; j < i; ++j)
      if (glm::dot(normals[i], normals[j]) < kCreaseCosine) return true;
  return false;
}

/// The gradient half way to the faces' middles turns less than a crease does, without any projection: most vertices are let off with this.
bool is_plainly_smooth(LocalField& field, const glm::dvec3& x, const Surroundings& around) {
  std::array<glm::dvec3, 8> points, gradients;
  std::array<double, 8> values;
  const size_t n = around.middles.size();
  if (n > points.size()) return false;
  for (size_t i = 0; i < n; ++i) points[i] = 0.5 * (x + around.middles[i]);
  field.gradients(std::span(points.data(), n), std::span(values.data(), n), std::span(gradients.data(), n));
  for (size_t i = 0; i < n; ++i) {
    const double length = glm::length(gradients[i]);
    if (!(length > 0.0) || !std::isfinite(length)) return false;
    gradients[i] /= length;
    for (size_t j = 0; j < i; ++j)
      if (glm::dot(gradients[i], gradients[j]) < kPlainlySmoothCosine) return false;
  }
  return true;
}

}  // namespace

Snapped snap(LocalField& field, const glm::dvec3& start, const Surroundings& around) {
  glm::dvec3 plain = start;
  const bool reached = project(field, plain, around);
  if (reached && is_plainly_smooth(field, start, around)) return {plain, false};
  std::vector<glm::dvec3> points, normals;
  glm::dvec3 x = start;
  bool creased = false;
  for (const double fraction : {0.5, 0.2, 0.05, 0.01, 1e-3, 1e-5, 1e-7}) {
    creased = sample_sides(field, x, around, fraction, points, normals);
    if (!creased) break;
    const glm::dvec3 next = meet_planes(points, normals, x);
    // Planes that nearly agree meet far away: that is no crease of this vertex. Half way along an edge or a diagonal that was refined, a
    // crease across it may be as far as its half, which is one and a half of the new edges.
    if (!(glm::distance(next, start) < 1.5 * around.edge_length)) {
      creased = false;
      break;
    }
    x = next;
  }
  if (creased) return {x, true};
  return {reached ? plain : start, false};
}

namespace {

void snap_some(const Field& field, Mesh& mesh, const std::vector<char>* which, SnapResult& result) {
  const Moving moving = moving_vertices(mesh, which);
  if (moving.vertices.empty()) return;
  const std::vector<Surroundings> around = surroundings_of(mesh, moving);
  std::vector<double> reach(mesh.vertex_count(), 0.0), left(around.size(), 0.0);
  for (size_t k = 0; k < around.size(); ++k) reach[moving.vertices[k]] = kSnapReach * around[k].edge_length;
  const std::vector<glm::dvec3> starts = mesh.positions;
  visit_groups(field, starts, reach, moving.vertices, [&](LocalField& local, std::span<const std::uint32_t> members) {
    for (const std::uint32_t v : members) {
      const auto k = static_cast<size_t>(moving.place[v]);
      const Snapped snapped = snap(local, starts[v], around[k]);
      mesh.positions[v] = snapped.position;
      result.feature[v] = snapped.feature;
      left[k] = local.distance_off(snapped.position);
    }
  });
  for (const double value : left) result.worst_value = std::max(result.worst_value, value);
}

}  // namespace

void snap_vertices(const Field& field, Mesh& mesh, const std::vector<char>& which, SnapResult& snapped) {
  snap_some(field, mesh, &which, snapped);
}

SnapResult snap_to_surface(const Field& field, Mesh& mesh) {
  SnapResult result{std::vector<char>(mesh.vertex_count(), 0), 0.0};
  snap_some(field, mesh, nullptr, result);
  return result;
}

std::vector<glm::vec3> field_normals(const Field& field, const Mesh& mesh, const std::vector<char>& feature) {
  std::vector<glm::vec3> normals = face_normals_at_corners(mesh);
  const std::vector<std::int32_t> first = first_corners(mesh);
  const FaceMiddles faces(mesh, first);
  std::vector<std::uint32_t> all(mesh.face_count());
  std::iota(all.begin(), all.end(), 0u);
  visit_groups(field, faces.middles, faces.radii, std::move(all), [&](LocalField& local, std::span<const std::uint32_t> members) {
    for (const std::uint32_t f : members) {
      const auto corners = face_corners(mesh, first[f], f);
      for (size_t i = 0; i < corners.size(); ++i) {
        const auto v = static_cast<size_t>(corners[i]);
        glm::dvec3 normal = local.unit_gradient(mesh.positions[v]);
        // A little way into the face, where one side of a crease has the word. Vertices can lie on a crease by chance, too.
        glm::dvec3 beside = mesh.positions[v] + 1e-3 * (faces.middles[f] - mesh.positions[v]);
        local.project(beside);
        const glm::dvec3 own_side = local.unit_gradient(beside);
        if (feature[v] || glm::dot(normal, own_side) < kSameSideCosine) normal = own_side;
        if (normal != glm::dvec3(0.0)) normals[static_cast<size_t>(first[f]) + i] = glm::vec3(normal);
      }
    }
  });
  return normals;
}

}  // namespace limn
