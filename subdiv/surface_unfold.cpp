// Faces that a snapped mesh folds, and evening out its vertices until they lie flat.

#include <algorithm>
#include <numeric>

#include "sdf/parallel.h"
#include "subdiv/local_field.h"
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

/// Faces with a vertex that is marked, in their order.
std::vector<std::int32_t> faces_touching(const Mesh& mesh, const std::vector<std::int32_t>& first, const std::vector<char>& marked) {
  std::vector<char> touches(mesh.face_count(), 0);
  parallel_for(size_t{0}, touches.size(), [&](size_t f) {
    const auto corners = face_corners(mesh, first[f], f);
    touches[f] = std::any_of(corners.begin(), corners.end(), [&](std::int32_t v) { return marked[static_cast<size_t>(v)] != 0; });
  });
  std::vector<std::int32_t> faces;
  for (size_t f = 0; f < touches.size(); ++f)
    if (touches[f]) faces.push_back(static_cast<std::int32_t>(f));
  return faces;
}

/// The vertices at the other ends of the edges of those that are to move, in the order of their numbers; of the others nothing.
struct Neighbours {
  std::vector<std::uint32_t> first{}, end{}, list{};

  Neighbours(const Mesh& mesh, const std::vector<std::int32_t>& first_corner, const std::vector<char>& moves)
      : first(mesh.vertex_count() + 1, 0), end(mesh.vertex_count(), 0) {
    const std::vector<std::int32_t> faces = faces_touching(mesh, first_corner, moves);
    // Each face at an edge tells its ends of each other.
    const auto visit = [&](const auto& see) {
      for (const std::int32_t f : faces) {
        const auto corners = face_corners(mesh, first_corner[static_cast<size_t>(f)], static_cast<size_t>(f));
        for (size_t i = 0; i < corners.size(); ++i) {
          const auto a = static_cast<size_t>(corners[i]), b = static_cast<size_t>(corners[(i + 1) % corners.size()]);
          if (a == b) continue;
          if (moves[a]) see(a, b);
          if (moves[b]) see(b, a);
        }
      }
    };
    visit([&](size_t v, size_t) { ++first[v + 1]; });
    std::partial_sum(first.begin(), first.end(), first.begin());
    list.resize(first.back());
    std::copy(first.begin(), first.end() - 1, end.begin());
    visit([&](size_t v, size_t other) { list[end[v]++] = static_cast<std::uint32_t>(other); });
    parallel_for(size_t{0}, mesh.vertex_count(), [&](size_t v) {
      const auto from = list.begin() + first[v], to = list.begin() + end[v];
      std::sort(from, to);
      end[v] = static_cast<std::uint32_t>(std::unique(from, to) - list.begin());
    });
  }

  glm::dvec3 mean(const Mesh& mesh, size_t v) const {
    if (first[v] == end[v]) return mesh.positions[v];
    glm::dvec3 sum(0.0);
    for (std::uint32_t i = first[v]; i < end[v]; ++i) sum += mesh.positions[list[i]];
    return sum / static_cast<double>(end[v] - first[v]);
  }
};

/// Those that `moves` names go half way to the middle of their neighbours, all at once.
void move_to_means(Mesh& mesh, const std::vector<std::int32_t>& first_corner, const std::vector<char>& moves) {
  const Neighbours neighbours(mesh, first_corner, moves);
  std::vector<glm::dvec3> moved = mesh.positions;
  parallel_for(size_t{0}, moves.size(), [&](size_t v) {
    if (moves[v]) moved[v] = 0.5 * (mesh.positions[v] + neighbours.mean(mesh, v));
  });
  mesh.positions = std::move(moved);
}

/// Which of `candidates` lie folded, in their order.
std::vector<std::int32_t> folded_among(const Field& field, const Mesh& mesh, const std::vector<std::int32_t>& first,
                                       const std::vector<std::int32_t>& candidates, bool reflex_too) {
  const FaceMiddles faces(mesh, first, candidates);
  std::vector<char> bad(candidates.size(), 0);
  std::vector<std::uint32_t> all(candidates.size());
  std::iota(all.begin(), all.end(), 0u);
  visit_groups(field, faces.middles, faces.radii, std::move(all), [&](LocalField& local, std::span<const std::uint32_t> members) {
    std::vector<glm::dvec3> corners;
    const std::vector<Landing> landings = local.project(members_of(faces.middles, members));
    for (size_t i = 0; i < members.size(); ++i) {
      const auto f = static_cast<size_t>(candidates[members[i]]);
      gather_corners(mesh, face_corners(mesh, first[f], f), corners);
      const glm::dvec3 area = vector_area(corners);
      bad[members[i]] = glm::dot(area, direction_of(landings[i].gradient)) < 0.0 || (reflex_too && has_reflex_corner(corners, area));
    }
  });
  std::vector<std::int32_t> folded;
  for (size_t k = 0; k < candidates.size(); ++k)
    if (bad[k]) folded.push_back(candidates[k]);
  return folded;
}

std::vector<std::int32_t> all_faces(const Mesh& mesh) {
  std::vector<std::int32_t> faces(mesh.face_count());
  std::iota(faces.begin(), faces.end(), 0);
  return faces;
}

}  // namespace

glm::dvec3 middle_of_face(const Mesh& mesh, std::span<const std::int32_t> corners) {
  glm::dvec3 sum(0.0);
  for (const std::int32_t v : corners) sum += mesh.positions[static_cast<size_t>(v)];
  return sum / static_cast<double>(corners.size());
}

FaceMiddles::FaceMiddles(const Mesh& mesh, const std::vector<std::int32_t>& first) : FaceMiddles(mesh, first, all_faces(mesh)) {}

FaceMiddles::FaceMiddles(const Mesh& mesh, const std::vector<std::int32_t>& first, std::span<const std::int32_t> faces)
    : middles(faces.size(), glm::dvec3(0.0)), radii(faces.size(), 0.0) {
  parallel_for(size_t{0}, faces.size(), [&](size_t k) {
    const auto f = static_cast<size_t>(faces[k]);
    const auto corners = face_corners(mesh, first[f], f);
    middles[k] = middle_of_face(mesh, corners);
    for (const std::int32_t v : corners) radii[k] = std::max(radii[k], glm::distance(mesh.positions[static_cast<size_t>(v)], middles[k]));
  });
}

std::vector<std::int32_t> folded_faces(const Field& field, const Mesh& mesh, bool reflex_too) {
  return folded_among(field, mesh, first_corners(mesh), all_faces(mesh), reflex_too);
}

void unfold(const Field& field, Mesh& mesh, SnapResult& snapped, int rounds, const std::vector<char>* moved) {
  const std::vector<std::int32_t> first = first_corners(mesh);
  std::vector<std::int32_t> candidates = moved != nullptr ? faces_touching(mesh, first, *moved) : all_faces(mesh);
  for (int round = 0; round < rounds; ++round) {
    const std::vector<std::int32_t> folded = folded_among(field, mesh, first, candidates, true);
    if (folded.empty()) return;
    std::vector<char> moves(mesh.vertex_count(), 0);
    for (const std::int32_t f : folded)
      for (const std::int32_t v : face_corners(mesh, first[static_cast<size_t>(f)], static_cast<size_t>(f)))
        // After a few rounds creased vertices take part: the surface matters more than the line.
        if (!snapped.feature[static_cast<size_t>(v)] || round >= rounds / 2) moves[static_cast<size_t>(v)] = 1;
    move_to_means(mesh, first, moves);
    snap_vertices(field, mesh, moves, snapped);
    // Only faces with a vertex that has moved can have changed, and a folded face whose vertices all stayed is folded still.
    for (const std::int32_t f : folded)
      for (const std::int32_t v : face_corners(mesh, first[static_cast<size_t>(f)], static_cast<size_t>(f)))
        moves[static_cast<size_t>(v)] = 1;
    candidates = faces_touching(mesh, first, moves);
  }
}

void relax(const Field& field, Mesh& mesh, SnapResult& snapped, int rounds) {
  const std::vector<std::int32_t> first = first_corners(mesh);
  for (int round = 0; round < rounds; ++round) {
    std::vector<char> moves(mesh.vertex_count(), 0);
    for (size_t v = 0; v < moves.size(); ++v) moves[v] = snapped.feature[v] == 0;
    move_to_means(mesh, first, moves);
    snap_vertices(field, mesh, moves, snapped);
  }
}

}  // namespace limn
