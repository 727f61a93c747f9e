// Edges and quads that would cut creases and corners off: dual contouring puts one vertex into each cell that the surface crosses, and a
// crease that crosses only the corner of a cell is not noticed there.

#include <algorithm>
#include <array>
#include <numeric>
#include <optional>

#include "subdiv/polygon.h"
#include "subdiv/snap_vertex.h"
#include "subdiv/surface_snap.h"

namespace limn {
namespace {

/// Quads that have a feature among their vertices or beside them: a crease that is missed for a face or two goes on there.
std::vector<size_t> quads_along_creases(const Mesh& mesh, const std::vector<std::int32_t>& first, const std::vector<char>& feature) {
  std::vector<char> near = feature;
  std::vector<size_t> quads;
  for (const int round : {0, 1}) {
    const std::vector<char> marked = near;
    for (size_t f = 0; f < mesh.face_count(); ++f) {
      const auto corners = face_corners(mesh, first[f], f);
      if (std::none_of(corners.begin(), corners.end(), [&](std::int32_t v) { return marked[static_cast<size_t>(v)] != 0; })) continue;
      for (const std::int32_t v : corners) near[static_cast<size_t>(v)] = 1;
      if (round == 1 && corners.size() == 4) quads.push_back(f);
    }
  }
  return quads;
}

struct EdgeAcross {
  size_t a, b;
};

/// Edges of these quads between vertices on two sides of a crease, each once.
std::vector<EdgeAcross> edges_across(const Field& field, const Mesh& mesh, const std::vector<std::int32_t>& first,
                                     const std::vector<size_t>& quads, const std::vector<char>& feature, std::vector<glm::dvec3>& normals) {
  std::vector<char> asked(mesh.vertex_count(), 0);
  for (const size_t f : quads)
    for (const std::int32_t v : face_corners(mesh, first[f], f)) asked[static_cast<size_t>(v)] = !feature[static_cast<size_t>(v)];
  std::vector<std::uint32_t> which;
  for (size_t v = 0; v < asked.size(); ++v)
    if (asked[v]) which.push_back(static_cast<std::uint32_t>(v));
  normals.assign(mesh.vertex_count(), glm::dvec3(0.0));
  const std::vector<double> reach(mesh.vertex_count(), 0.0);
  visit_groups(field, mesh.positions, reach, std::move(which), [&](LocalField& local, std::span<const std::uint32_t> members) {
    const std::vector<glm::dvec3> found = local.unit_gradients(members_of(mesh.positions, members));
    for (size_t i = 0; i < members.size(); ++i) normals[members[i]] = found[i];
  });
  std::vector<EdgeAcross> across;
  for (const size_t f : quads) {
    const auto corners = face_corners(mesh, first[f], f);
    for (size_t i = 0; i < 4; ++i) {
      const auto a = static_cast<size_t>(corners[i]), b = static_cast<size_t>(corners[(i + 1) % 4]);
      // The face on the other side has the edge the other way round.
      if (a < b && asked[a] && asked[b] && glm::dot(normals[a], normals[b]) <= kCreaseCosine) across.push_back({a, b});
    }
  }
  return across;
}

struct Move {
  size_t vertex = 0;
  glm::dvec3 to{0.0};
};

/// For each edge of a group, which of its ends belongs onto the crease that crosses it.
std::vector<std::optional<Move>> moves_onto_creases(LocalField& local, const Mesh& mesh, const std::vector<glm::dvec3>& normals,
                                                    const std::vector<EdgeAcross>& edges) {
  std::vector<Surroundings> around;
  std::vector<SnapTask> tasks, ends;
  for (const auto& [a, b] : edges) {
    const glm::dvec3 outward = normals[a] + normals[b];
    around.push_back({{mesh.positions[a], mesh.positions[b]},
                      glm::distance(mesh.positions[a], mesh.positions[b]),
                      glm::length(outward) > 0.0 ? glm::normalize(outward) : outward});
  }
  for (size_t e = 0; e < edges.size(); ++e) tasks.push_back({0.5 * (around[e].middles[0] + around[e].middles[1]), &around[e]});
  const std::vector<Snapped> crossings = snap(local, tasks);
  struct Pull {
    size_t edge = 0, nearer = 0;
  };
  std::vector<Pull> pulls;
  for (size_t e = 0; e < edges.size(); ++e) {
    if (!crossings[e].feature) continue;
    const auto [a, b] = edges[e];
    const std::vector<glm::dvec3>& at = around[e].middles;
    // The end must not slide along the crease, which would fold its faces: straight to the line where the two sides meet.
    const size_t nearer = glm::distance(at[0], crossings[e].position) <= glm::distance(at[1], crossings[e].position) ? 0 : 1;
    pulls.push_back({e, nearer});
    ends.push_back({meet_planes(at, {normals[a], normals[b]}, at[nearer]), &around[e]});
  }
  const std::vector<Snapped> to = snap(local, ends);
  std::vector<std::optional<Move>> moves(edges.size());
  for (size_t k = 0; k < pulls.size(); ++k) {
    const auto [e, nearer] = pulls[k];
    if (to[k].feature && glm::distance(to[k].position, around[e].middles[nearer]) < 0.75 * around[e].edge_length)
      moves[e] = {nearer == 0 ? edges[e].a : edges[e].b, to[k].position};
  }
  return moves;
}

void pull_onto_creases(const Field& field, Mesh& mesh, const std::vector<std::int32_t>& first, SnapResult& snapped) {
  std::vector<glm::dvec3> normals;
  const std::vector<EdgeAcross> across =
      edges_across(field, mesh, first, quads_along_creases(mesh, first, snapped.feature), snapped.feature, normals);
  std::vector<glm::dvec3> middles;
  std::vector<double> reach;
  for (const auto& [a, b] : across) {
    middles.push_back(0.5 * (mesh.positions[a] + mesh.positions[b]));
    reach.push_back(kSnapReach * glm::distance(mesh.positions[a], mesh.positions[b]));
  }
  std::vector<std::optional<Move>> moves(across.size());
  std::vector<std::uint32_t> all(across.size());
  std::iota(all.begin(), all.end(), 0u);
  visit_groups(field, middles, reach, std::move(all), [&](LocalField& local, std::span<const std::uint32_t> members) {
    const std::vector<std::optional<Move>> found = moves_onto_creases(local, mesh, normals, members_of(across, members));
    for (size_t i = 0; i < members.size(); ++i) moves[members[i]] = found[i];
  });
  // One after another: a vertex that was moved is the crease's for its other edges, too.
  for (size_t e = 0; e < across.size(); ++e) {
    const auto [a, b] = across[e];
    if (!moves[e] || snapped.feature[a] || snapped.feature[b]) continue;
    mesh.positions[moves[e]->vertex] = moves[e]->to;
    snapped.feature[moves[e]->vertex] = 1;
  }
}

/// A quad that lies across a corner of three faces, and which of its vertices belongs there.
struct CutCorner {
  int moved = -1;
  glm::dvec3 to{0.0};
};

using Quad = std::array<glm::dvec3, 4>;

/// How far the triangles of a quad lie off the surface, by the better of its diagonals.
double off_surface(LocalField& local, const Quad& q) {
  const auto middle = [&](size_t a, size_t b, size_t c) { return (q[a] + q[b] + q[c]) / 3.0; };
  const std::vector<double> off = local.distances_off(std::array{middle(0, 1, 2), middle(0, 2, 3), middle(1, 2, 3), middle(1, 3, 0)});
  return std::min(off[0] + off[1], off[2] + off[3]);
}

constexpr double kOff = 1e-3;  // Of an edge.

glm::dvec3 middle_of(const Quad& q) { return 0.25 * (q[0] + q[1] + q[2] + q[3]); }

double mean_edge(const Quad& quad) {
  double length = 0.0;
  for (size_t i = 0; i < 4; ++i) length += 0.25 * glm::distance(quad[i], quad[(i + 1) % 4]);
  return length;
}

/// Flat and on the surface: one look is enough.
bool lies_on_surface(const Quad& q, double middle_off) {
  const glm::dvec3 n0 = glm::cross(q[1] - q[0], q[2] - q[0]), n1 = glm::cross(q[2] - q[0], q[3] - q[0]);
  return glm::dot(n0, n1) > 0.99 * glm::length(n0) * glm::length(n1) && middle_off <= 0.25 * kOff * mean_edge(q);
}

CutCorner cut_corner(LocalField& local, const Quad& quad) {
  CutCorner cut;
  const double length = mean_edge(quad);
  const double before = off_surface(local, quad);
  if (!(before > kOff * length)) return cut;
  const glm::dvec3 outward = glm::cross(quad[2] - quad[0], quad[3] - quad[1]);
  const double size = glm::length(outward);
  // All sides that the quad's corners lie on: a little way from each of them towards the others.
  Surroundings around{{}, length, size > 0.0 ? outward / size : glm::dvec3(0.0)};
  std::vector<glm::dvec3> normals, beside;
  for (size_t i = 0; i < 4; ++i) {
    for (size_t j = 0; j < 4; ++j) {
      if (i != j) beside.push_back(quad[i] + 0.05 * (quad[j] - quad[i]));
    }
  }
  for (const Landing& landing : local.project(beside)) {
    if (!landing.reached) continue;
    around.middles.push_back(landing.position);
    normals.push_back(direction_of(landing.gradient));
  }
  if (around.middles.empty()) return cut;
  const Snapped found = snap(local, meet_planes(around.middles, normals, middle_of(quad)), around);
  if (!found.feature) return cut;
  double best = 0.1 * before;
  for (int i = 0; i < 4; ++i) {
    Quad moved = quad;
    moved[static_cast<size_t>(i)] = found.position;
    const double off = off_surface(local, moved);
    if (off < best && glm::distance(quad[static_cast<size_t>(i)], found.position) < length) best = off, cut = {i, found.position};
  }
  return cut;
}

/// Of the quads with a vertex that `moved` marks; then it marks the vertices that were moved, whose neighbours may now lie across the
/// corner.
void pull_onto_corners(const Field& field, Mesh& mesh, const std::vector<std::int32_t>& first, SnapResult& snapped,
                       std::vector<char>& moved) {
  std::vector<Quad> quads;
  std::vector<size_t> faces;
  std::vector<glm::dvec3> middles;
  std::vector<double> reach;
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    const auto corners = face_corners(mesh, first[f], f);
    const auto is_moved = [&](std::int32_t v) { return moved[static_cast<size_t>(v)] != 0; };
    if (corners.size() != 4 || std::none_of(corners.begin(), corners.end(), is_moved)) continue;
    Quad quad;
    for (size_t i = 0; i < 4; ++i) quad[i] = mesh.positions[static_cast<size_t>(corners[i])];
    quads.push_back(quad), faces.push_back(f);
    middles.push_back(middle_of(quad));
    reach.push_back(kSnapReach * std::max(glm::distance(quad[0], quad[2]), glm::distance(quad[1], quad[3])));
  }
  std::vector<CutCorner> cut(quads.size());
  std::vector<std::uint32_t> all(quads.size());
  std::iota(all.begin(), all.end(), 0u);
  visit_groups(field, middles, reach, std::move(all), [&](LocalField& local, std::span<const std::uint32_t> members) {
    const std::vector<double> off = local.distances_off(members_of(middles, members));
    for (size_t i = 0; i < members.size(); ++i)
      if (!lies_on_surface(quads[members[i]], off[i])) cut[members[i]] = cut_corner(local, quads[members[i]]);
  });
  moved.assign(mesh.vertex_count(), 0);
  for (size_t k = 0; k < cut.size(); ++k) {
    if (cut[k].moved < 0) continue;
    const auto corners = face_corners(mesh, first[faces[k]], faces[k]);
    if (std::any_of(corners.begin(), corners.end(), [&](std::int32_t v) { return moved[static_cast<size_t>(v)] != 0; })) continue;
    const auto v = static_cast<size_t>(corners[static_cast<size_t>(cut[k].moved)]);
    mesh.positions[v] = cut[k].to;
    snapped.feature[v] = moved[v] = 1;
  }
}

/// Whether a quad's two triangles meet in a crease: they turn there, and each lies on its own side of the surface.
bool creases_along_diagonal(LocalField& local, const Quad& q) {
  const glm::dvec3 n0 = glm::cross(q[1] - q[0], q[2] - q[0]), n1 = glm::cross(q[2] - q[0], q[3] - q[0]);
  const double size0 = glm::length(n0), size1 = glm::length(n1);
  // The normal of a sliver is rounding.
  if (std::min(size0, size1) <= 1e-3 * std::max(size0, size1) || glm::dot(n0, n1) > kCreaseCosine * size0 * size1) return false;
  const auto lies_on_side = [&](const glm::dvec3& middle, const glm::dvec3& normal, double size) {
    return glm::dot(local.unit_gradient(middle), normal) > kCreaseCosine * size;
  };
  return lies_on_side((q[0] + q[1] + q[2]) / 3.0, n0, size0) && lies_on_side((q[0] + q[2] + q[3]) / 3.0, n1, size1);
}

/// The marked quads as two triangles each, from their first corner to their third.
void split(Mesh& mesh, const std::vector<char>& which) {
  std::vector<std::int32_t> sizes, corners;
  sizes.reserve(mesh.face_count());
  corners.reserve(mesh.corner_vertices.size());
  auto next = mesh.corner_vertices.begin();
  for (size_t f = 0; f < which.size(); ++f) {
    const std::int32_t size = mesh.face_sizes[f];
    if (which[f]) {
      sizes.insert(sizes.end(), {3, 3});
      corners.insert(corners.end(), {next[0], next[1], next[2], next[0], next[2], next[3]});
    } else {
      sizes.push_back(size);
      corners.insert(corners.end(), next, next + size);
    }
    next += size;
  }
  mesh.face_sizes = std::move(sizes);
  mesh.corner_vertices = std::move(corners);
}

}  // namespace

void follow_creases(const Field& field, Mesh& mesh, SnapResult& snapped) {
  const std::vector<std::int32_t> first = first_corners(mesh);
  const std::vector<glm::dvec3> before = mesh.positions;
  pull_onto_creases(field, mesh, first, snapped);
  // At first those beside creases, then those beside vertices that were moved: what a quad finds depends on nothing but its corners.
  std::vector<char> moved = snapped.feature;
  for (int round = 0; round < 3; ++round) pull_onto_corners(field, mesh, first, snapped, moved);
  for (size_t v = 0; v < moved.size(); ++v) moved[v] = mesh.positions[v] != before[v];
  unfold(field, mesh, snapped, 4, &moved);
}

void turn_quads_along_creases(const Field& field, Mesh& mesh, const std::vector<char>& feature) {
  const std::vector<std::int32_t> first = first_corners(mesh);
  std::vector<size_t> faces;
  std::vector<glm::dvec3> middles;
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    if (mesh.face_sizes[f] != 4) continue;
    const auto corners = face_corners(mesh, first[f], f);
    if (std::none_of(corners.begin(), corners.end(), [&](std::int32_t v) { return feature[static_cast<size_t>(v)] != 0; })) continue;
    faces.push_back(f);
    for (const size_t i : {size_t{0}, size_t{1}})
      middles.push_back(0.5 * (mesh.positions[static_cast<size_t>(corners[i])] + mesh.positions[static_cast<size_t>(corners[i + 2])]));
  }
  std::vector<double> off(middles.size());
  visit_groups(field, middles, 0.0, [&](LocalField& local, std::span<const std::uint32_t> members) {
    const std::vector<double> found = local.distances_off(members_of(middles, members));
    for (size_t i = 0; i < members.size(); ++i) off[members[i]] = found[i];
  });
  for (size_t k = 0; k < faces.size(); ++k) {
    // Quads are cut from their first corner to their third.
    const auto begin = mesh.corner_vertices.begin() + first[faces[k]];
    if (off[2 * k + 1] < 0.5 * off[2 * k]) std::rotate(begin, begin + 1, begin + 4);
  }
}

void split_quads_along_creases(const Field& field, Mesh& mesh, const std::vector<char>& feature) {
  const std::vector<std::int32_t> first = first_corners(mesh);
  std::vector<size_t> faces;
  std::vector<Quad> quads;
  std::vector<glm::dvec3> middles;
  std::vector<double> reach;
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    const auto corners = face_corners(mesh, first[f], f);
    if (corners.size() != 4 || feature[static_cast<size_t>(corners[0])] == 0 || feature[static_cast<size_t>(corners[2])] == 0) continue;
    faces.push_back(f);
    Quad& quad = quads.emplace_back();
    for (size_t i = 0; i < 4; ++i) quad[i] = mesh.positions[static_cast<size_t>(corners[i])];
    middles.push_back(middle_of(quad));
    reach.push_back(kSnapReach * std::max(glm::distance(quad[0], quad[2]), glm::distance(quad[1], quad[3])));
  }
  std::vector<char> creased(mesh.face_count(), 0);
  std::vector<std::uint32_t> all(quads.size());
  std::iota(all.begin(), all.end(), 0u);
  visit_groups(field, middles, reach, std::move(all), [&](LocalField& local, std::span<const std::uint32_t> members) {
    for (const std::uint32_t k : members) creased[faces[k]] = creases_along_diagonal(local, quads[k]);
  });
  split(mesh, creased);
}

}  // namespace limn
