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
      const auto vertices = corners_of(static_cast<std::uint32_t>(k));
      gather_corners(mesh, vertices, points);
      middles[k] = middle_of_face(mesh, vertices);
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

void snap_some(const Field& field, Mesh& mesh, const std::vector<char>* which, SnapResult& result) {
  const Moving moving = moving_vertices(mesh, which);
  if (moving.vertices.empty()) return;
  const std::vector<Surroundings> around = surroundings_of(mesh, moving);
  std::vector<double> reach(mesh.vertex_count(), 0.0), left(around.size(), 0.0);
  for (size_t k = 0; k < around.size(); ++k) reach[moving.vertices[k]] = kSnapReach * around[k].edge_length;
  const std::vector<glm::dvec3> starts = mesh.positions;
  visit_groups(field, starts, reach, moving.vertices, [&](LocalField& local, std::span<const std::uint32_t> members) {
    std::vector<SnapTask> tasks;
    for (const std::uint32_t v : members) tasks.push_back({starts[v], &around[static_cast<size_t>(moving.place[v])]});
    const std::vector<Snapped> snapped = snap(local, tasks);
    for (size_t i = 0; i < members.size(); ++i) {
      mesh.positions[members[i]] = snapped[i].position;
      result.feature[members[i]] = snapped[i].feature;
      left[static_cast<size_t>(moving.place[members[i]])] = snapped[i].off;
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
    // At each corner, and a little way into the face, where one side of a crease has the word. Vertices can lie on a crease by chance, too.
    std::vector<glm::dvec3> points, beside;
    for (const std::uint32_t f : members) {
      for (const std::int32_t v : face_corners(mesh, first[f], f)) {
        const glm::dvec3& position = mesh.positions[static_cast<size_t>(v)];
        points.push_back(position);
        beside.push_back(position + 1e-3 * (faces.middles[f] - position));
      }
    }
    std::vector<double> values(points.size());
    std::vector<glm::dvec3> gradients(points.size());
    local.gradients(points, values, gradients);
    const std::vector<Landing> landings = local.project(beside);
    size_t k = 0;
    for (const std::uint32_t f : members) {
      const auto corners = face_corners(mesh, first[f], f);
      for (size_t i = 0; i < corners.size(); ++i, ++k) {
        glm::dvec3 normal = direction_of(gradients[k]);
        const glm::dvec3 own_side = direction_of(landings[k].gradient);
        if (feature[static_cast<size_t>(corners[i])] || glm::dot(normal, own_side) < kSameSideCosine) normal = own_side;
        if (normal != glm::dvec3(0.0)) normals[static_cast<size_t>(first[f]) + i] = glm::vec3(normal);
      }
    }
  });
  return normals;
}

}  // namespace limn
