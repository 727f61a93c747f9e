// Faces that a snapped mesh folds, and evening out its vertices until they lie flat.

#include <algorithm>
#include <numeric>
#include <optional>

#include "sdf/parallel.h"
#include "subdiv/local_field.h"
#include "subdiv/mesh_audit.h"
#include "subdiv/polygon.h"
#include "subdiv/surface_snap.h"

namespace limn {
namespace {

/// A quad bent like a bow tie has the right area as a whole and a corner that is turned over; so has one with a reflex corner.
bool has_reflex_corner(const std::vector<glm::dvec3>& corners, const glm::dvec3& area) {
  const size_t n = corners.size();
  for (size_t i = 0; i < n; ++i) {
    const glm::dvec3 turn = glm::cross(corners[(i + 1) % n] - corners[i], corners[(i + n - 1) % n] - corners[i]);
    if (glm::dot(turn, area) < -1e-3 * glm::dot(area, area)) return true;
  }
  return false;
}

/// The vertices at the other ends of each one's edges: a mesh keeps them while its vertices move.
struct Neighbours {
  std::vector<std::uint32_t> first{}, list{};

  explicit Neighbours(const Mesh& mesh) : first(mesh.vertex_count() + 1, 0) {
    const Edges edges = build_edges(mesh);
    for (const Edge& edge : edges) ++first[static_cast<size_t>(edge.vertex_a) + 1], ++first[static_cast<size_t>(edge.vertex_b) + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    list.resize(first.back());
    std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
    for (const Edge& edge : edges) {
      const auto a = static_cast<size_t>(edge.vertex_a), b = static_cast<size_t>(edge.vertex_b);
      list[next[a]++] = static_cast<std::uint32_t>(b);
      list[next[b]++] = static_cast<std::uint32_t>(a);
    }
  }

  glm::dvec3 mean(const Mesh& mesh, size_t v) const {
    if (first[v] == first[v + 1]) return mesh.positions[v];
    glm::dvec3 sum(0.0);
    for (std::uint32_t i = first[v]; i < first[v + 1]; ++i) sum += mesh.positions[list[i]];
    return sum / static_cast<double>(first[v + 1] - first[v]);
  }
};

/// Those that `moves` names go half way to the middle of their neighbours, all at once.
void move_to_means(Mesh& mesh, const Neighbours& neighbours, const std::vector<char>& moves) {
  std::vector<glm::dvec3> moved = mesh.positions;
  parallel_for(size_t{0}, moves.size(), [&](size_t v) {
    if (moves[v]) moved[v] = 0.5 * (mesh.positions[v] + neighbours.mean(mesh, v));
  });
  mesh.positions = std::move(moved);
}

/// Which of `candidates` lie folded, in their order.
std::vector<std::int32_t> folded_among(const Field& field, const Mesh& mesh, const std::vector<std::int32_t>& first,
                                       const std::vector<std::int32_t>& candidates, bool reflex_too) {
  const FaceMiddles faces(mesh, first);
  std::vector<char> bad(mesh.face_count(), 0);
  const std::vector<std::uint32_t> which(candidates.begin(), candidates.end());
  visit_groups(field, faces.middles, faces.radii, which, [&](LocalField& local, std::span<const std::uint32_t> members) {
    std::vector<glm::dvec3> corners, middles;
    for (const std::uint32_t f : members) middles.push_back(faces.middles[f]);
    const std::vector<Landing> landings = local.project(middles);
    for (size_t i = 0; i < members.size(); ++i) {
      const std::uint32_t f = members[i];
      gather_corners(mesh, face_corners(mesh, first[f], f), corners);
      const glm::dvec3 area = vector_area(corners);
      bad[f] = glm::dot(area, direction_of(landings[i].gradient)) < 0.0 || (reflex_too && has_reflex_corner(corners, area));
    }
  });
  std::vector<std::int32_t> folded;
  std::copy_if(candidates.begin(), candidates.end(), std::back_inserter(folded),
               [&](std::int32_t f) { return bad[static_cast<size_t>(f)]; });
  return folded;
}

std::vector<std::int32_t> all_faces(const Mesh& mesh) {
  std::vector<std::int32_t> faces(mesh.face_count());
  std::iota(faces.begin(), faces.end(), 0);
  return faces;
}

/// Faces with a vertex that has moved: only they can have changed.
std::vector<std::int32_t> faces_touching(const Mesh& mesh, const std::vector<std::int32_t>& first, const std::vector<char>& moved) {
  std::vector<std::int32_t> faces;
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    const auto corners = face_corners(mesh, first[f], f);
    if (std::any_of(corners.begin(), corners.end(), [&](std::int32_t v) { return moved[static_cast<size_t>(v)] != 0; })) {
      faces.push_back(static_cast<std::int32_t>(f));
    }
  }
  return faces;
}

}  // namespace

glm::dvec3 middle_of_face(const Mesh& mesh, std::span<const std::int32_t> corners) {
  glm::dvec3 sum(0.0);
  for (const std::int32_t v : corners) sum += mesh.positions[static_cast<size_t>(v)];
  return sum / static_cast<double>(corners.size());
}

FaceMiddles::FaceMiddles(const Mesh& mesh, const std::vector<std::int32_t>& first)
    : middles(mesh.face_count(), glm::dvec3(0.0)), radii(mesh.face_count(), 0.0) {
  parallel_for(size_t{0}, mesh.face_count(), [&](size_t f) {
    const auto corners = face_corners(mesh, first[f], f);
    middles[f] = middle_of_face(mesh, corners);
    for (const std::int32_t v : corners) radii[f] = std::max(radii[f], glm::distance(mesh.positions[static_cast<size_t>(v)], middles[f]));
  });
}

std::vector<std::int32_t> folded_faces(const Field& field, const Mesh& mesh, bool reflex_too) {
  return folded_among(field, mesh, first_corners(mesh), all_faces(mesh), reflex_too);
}

void unfold(const Field& field, Mesh& mesh, SnapResult& snapped, int rounds, const std::vector<char>* moved) {
  const std::vector<std::int32_t> first = first_corners(mesh);
  std::vector<std::int32_t> candidates = moved != nullptr ? faces_touching(mesh, first, *moved) : all_faces(mesh);
  std::optional<Neighbours> neighbours;
  for (int round = 0; round < rounds; ++round) {
    const std::vector<std::int32_t> folded = folded_among(field, mesh, first, candidates, true);
    if (folded.empty()) return;
    std::vector<char> moves(mesh.vertex_count(), 0);
    for (const std::int32_t f : folded)
      for (const std::int32_t v : face_corners(mesh, first[static_cast<size_t>(f)], static_cast<size_t>(f)))
        // After a few rounds creased vertices take part: the surface matters more than the line.
        if (!snapped.feature[static_cast<size_t>(v)] || round >= rounds / 2) moves[static_cast<size_t>(v)] = 1;
    if (!neighbours) neighbours.emplace(mesh);
    move_to_means(mesh, *neighbours, moves);
    snap_vertices(field, mesh, moves, snapped);
    // A folded face whose vertices all stayed is folded still.
    for (const std::int32_t f : folded)
      for (const std::int32_t v : face_corners(mesh, first[static_cast<size_t>(f)], static_cast<size_t>(f)))
        moves[static_cast<size_t>(v)] = 1;
    candidates = faces_touching(mesh, first, moves);
  }
}

void relax(const Field& field, Mesh& mesh, SnapResult& snapped, int rounds) {
  const Neighbours neighbours(mesh);
  for (int round = 0; round < rounds; ++round) {
    std::vector<char> moves(mesh.vertex_count(), 0);
    for (size_t v = 0; v < moves.size(); ++v) moves[v] = snapped.feature[v] == 0;
    move_to_means(mesh, neighbours, moves);
    snap_vertices(field, mesh, moves, snapped);
  }
}

}  // namespace limn
