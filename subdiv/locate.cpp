#include "subdiv/cage_topology.h"

namespace limn {
namespace {

/// Corners of a face's own (u, v) domain.
glm::dvec2 corner_uv(Scheme scheme, int corner) {
  if (scheme == Scheme::loop) return corner == 0 ? glm::dvec2(0.0, 0.0) : corner == 1 ? glm::dvec2(1.0, 0.0) : glm::dvec2(0.0, 1.0);
  constexpr double kU[] = {0.0, 1.0, 1.0, 0.0}, kV[] = {0.0, 0.0, 1.0, 1.0};
  return {kU[corner], kV[corner]};
}

glm::dvec2 interpolate(Scheme scheme, const glm::dvec2 corners[4], const glm::dvec2& uv) {
  if (scheme == Scheme::loop) return (1.0 - uv.x - uv.y) * corners[0] + uv.x * corners[1] + uv.y * corners[2];
  return (1.0 - uv.y) * ((1.0 - uv.x) * corners[0] + uv.x * corners[1]) + uv.y * ((1.0 - uv.x) * corners[3] + uv.x * corners[2]);
}

/// Where a child's vertex lies in its parent face: on a corner, in the middle of an edge, or in the middle of the face.
glm::dvec2 in_parent(const Far::TopologyLevel& parents, Scheme scheme, int parent, int child_vertex) {
  const Far::ConstIndexArray vertices = parents.GetFaceVertices(parent), edges = parents.GetFaceEdges(parent);
  const int n = vertices.size();
  for (int i = 0; i < n; ++i)
    if (parents.GetVertexChildVertex(vertices[i]) == child_vertex) return corner_uv(scheme, i);
  for (int i = 0; i < n; ++i)
    if (parents.GetEdgeChildVertex(edges[i]) == child_vertex) return 0.5 * (corner_uv(scheme, i) + corner_uv(scheme, (i + 1) % n));
  return {0.5, 0.5};
}

/// The sub-quad of an n-gon starts at its corner of the parent, u along the parent's edge.
CageLocation in_ngon(const Far::TopologyLevel& parents, const Far::TopologyLevel& children, int parent, int face, const glm::dvec2& uv) {
  const Far::ConstIndexArray siblings = parents.GetFaceChildFaces(parent), vertices = children.GetFaceVertices(face);
  CageLocation at{parent, 0, uv};
  while (at.sub_face + 1 < siblings.size() && siblings[at.sub_face] != face) ++at.sub_face;
  const int corner_vertex = parents.GetVertexChildVertex(parents.GetFaceVertices(parent)[at.sub_face]);
  int start = 0;
  while (start < 3 && vertices[start] != corner_vertex) ++start;
  for (int turn = 0; turn < start; ++turn) at.uv = {at.uv.y, 1.0 - at.uv.x};
  return at;
}

}  // namespace

CageLocation locate_corner(const Far::TopologyRefiner& refiner, Scheme scheme, int face, int corner) {
  const int sides = scheme == Scheme::loop ? 3 : 4;
  const int max_level = refiner.GetMaxLevel();
  CageLocation at{face, 0, {0.0, 0.0}};
  if (max_level == 0) {
    // An n-gon's corner is the origin of its sub-quad of the same number.
    const bool regular = refiner.GetLevel(0).GetFaceVertices(face).size() == sides;
    return regular ? CageLocation{face, 0, corner_uv(scheme, corner)} : CageLocation{face, corner, {0.0, 0.0}};
  }
  at.uv = corner_uv(scheme, corner);
  for (int l = max_level; l > 0; --l) {
    const Far::TopologyLevel &children = refiner.GetLevel(l), &parents = refiner.GetLevel(l - 1);
    const int parent = children.GetFaceParentFace(at.face);
    if (parents.GetFaceVertices(parent).size() != sides) return in_ngon(parents, children, parent, at.face, at.uv);
    glm::dvec2 corners[4];
    const Far::ConstIndexArray vertices = children.GetFaceVertices(at.face);
    for (int i = 0; i < sides; ++i) corners[i] = in_parent(parents, scheme, parent, vertices[i]);
    at.uv = interpolate(scheme, corners, at.uv);
    at.face = parent;
  }
  return at;
}

}  // namespace limn
