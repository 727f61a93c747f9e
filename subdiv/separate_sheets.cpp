// Cages whose sheets hang together in edges with more than two faces, in infinitely sharp ones or in single vertices, taken apart into
// sheets with open edges.

#include <algorithm>
#include <numeric>

#include "subdiv/opensubdiv_cage.h"
#include "subdiv/opensubdiv_cells.h"

namespace limn {
namespace {

/// A face's corner at a vertex.
struct Item {
  int face = 0, corner = 0;
};

/// The corners at one vertex, in groups that hang together by edges with two faces that are not infinitely sharp.
struct Groups {
  std::vector<Item> items;
  std::vector<int> group;  ///< Of each item.
  int count = 0;
};

bool joins(const Far::TopologyLevel& level, int edge) {
  return !level.IsEdgeNonManifold(edge) && !level.IsEdgeInfSharp(edge) && level.GetEdgeFaces(edge).size() == 2;
}

std::array<int, 2> edges_at(const Far::TopologyLevel& level, const Item& item) {
  const Far::ConstIndexArray edges = level.GetFaceEdges(item.face);
  return {edges[item.corner], edges[(item.corner + edges.size() - 1) % edges.size()]};
}

Groups groups_at(const Far::TopologyLevel& level, int vertex) {
  Groups out;
  const Far::ConstIndexArray faces = level.GetVertexFaces(vertex);
  const Far::ConstLocalIndexArray corners = level.GetVertexFaceLocalIndices(vertex);
  for (int i = 0; i < faces.size(); ++i) out.items.push_back({faces[i], corners[i]});
  std::vector<size_t> parent(out.items.size());
  std::iota(parent.begin(), parent.end(), size_t{0});
  const auto root = [&](size_t i) {
    while (parent[i] != i) i = parent[i];
    return i;
  };
  for (size_t i = 0; i < out.items.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      for (const int a : edges_at(level, out.items[i]))
        for (const int b : edges_at(level, out.items[j]))
          if (a == b && joins(level, a)) parent[root(i)] = root(j);
    }
  }
  std::vector<int> number(parent.size(), -1);
  for (size_t i = 0; i < parent.size(); ++i) {
    int& of_root = number[root(i)];
    if (of_root < 0) of_root = out.count++;
    out.group.push_back(of_root);
  }
  return out;
}

/// How a vertex's rule is kept when its sheets part: as a corner, as what two sharp edges make it, or not at all.
enum class Kept { corner, crease, not_kept };

Kept rule_kept(const Far::TopologyLevel& level, int vertex, const Groups& groups) {
  int sharp = 0;
  for (const int e : level.GetVertexEdges(vertex)) sharp += level.IsEdgeInfSharp(e);
  if (level.IsVertexInfSharp(vertex) || sharp > 2) return Kept::corner;
  if (sharp != 2 || still_semi_sharp(level, vertex)) return Kept::not_kept;
  std::vector<int> sharp_in(static_cast<size_t>(groups.count), 0);
  for (size_t i = 0; i < groups.items.size(); ++i)
    for (const int e : edges_at(level, groups.items[i])) sharp_in[static_cast<size_t>(groups.group[i])] += level.IsEdgeInfSharp(e);
  // Each sheet between the two sharp edges sees both, once.
  return std::all_of(sharp_in.begin(), sharp_in.end(), [](int n) { return n == 2; }) ? Kept::crease : Kept::not_kept;
}

bool ends_crease(const Far::TopologyLevel& level, int vertex) {
  const Far::ConstIndexArray edges = level.GetVertexEdges(vertex);
  return !level.IsVertexInfSharp(vertex) &&
         std::any_of(edges.begin(), edges.end(), [&](int e) { return level.IsEdgeInfSharp(e) && !level.IsEdgeBoundary(e); });
}

void copy_creases(const Far::TopologyLevel& level, const Mesh& clean, const std::vector<std::int32_t>& first, Mesh& mesh) {
  for (int f = 0; f < level.GetNumFaces(); ++f) {
    const Far::ConstIndexArray edges = level.GetFaceEdges(f);
    for (int i = 0; i < edges.size(); ++i) {
      const float sharpness = level.GetEdgeSharpness(edges[i]);
      if (!(sharpness > 0.0f) || level.GetEdgeFaces(edges[i]).size() < 2) continue;
      const auto corner = [&](int k) {
        return mesh.corner_vertices[static_cast<size_t>(first[static_cast<size_t>(f)] + k % edges.size())];
      };
      mesh.creases.push_back({corner(i), corner(i + 1), sharpness});
    }
  }
  mesh.crease_method = clean.crease_method;
}

}  // namespace

SeparatedCage separate_sheets(const Far::TopologyLevel& level, const Mesh& clean, Scheme scheme) {
  SeparatedCage out;
  Mesh& mesh = out.mesh;
  mesh.positions = clean.positions;
  mesh.face_sizes = clean.face_sizes;
  mesh.corner_vertices = clean.corner_vertices;
  mesh.triangle_rule = clean.triangle_rule;
  // Corners get their sharpness one by one, so that the new open edges make none.
  mesh.boundary = BoundaryRule::edge_only;
  out.same_limit.assign(clean.face_count(), 1);
  const std::vector<std::int32_t> first = first_corners(clean);
  for (int v = 0; v < level.GetNumVertices(); ++v) {
    const auto tag = [&](std::int32_t vertex, float sharpness) {
      if (sharpness > 0.0f) mesh.corners.push_back({vertex, sharpness});
    };
    const Groups groups = groups_at(level, v);
    if (groups.count == 1) {
      tag(v, level.GetVertexSharpness(v));
      // A crease that ends here may be cut along at its other end; this end's rule is then another.
      if (ends_crease(level, v))
        for (const Item& item : groups.items) out.same_limit[static_cast<size_t>(item.face)] = 0;
      continue;
    }
    const Kept kept = rule_kept(level, v, groups);
    const auto added = static_cast<std::int32_t>(mesh.vertex_count());
    for (size_t i = 0; i < groups.items.size(); ++i) {
      const auto face = static_cast<size_t>(groups.items[i].face);
      if (kept == Kept::not_kept) out.same_limit[face] = 0;
      if (groups.group[i] > 0)
        mesh.corner_vertices[static_cast<size_t>(first[face] + groups.items[i].corner)] = added + groups.group[i] - 1;
    }
    for (int g = 0; g < groups.count; ++g) {
      if (g > 0) mesh.positions.push_back(clean.positions[static_cast<size_t>(v)]);
      if (kept == Kept::corner) tag(g > 0 ? added + g - 1 : v, kInfiniteSharpness);
    }
  }
  copy_creases(level, clean, first, mesh);
  out.refiner = make_refiner(mesh, scheme, {});
  return out;
}

}  // namespace limn
