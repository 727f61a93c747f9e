#include "subdiv/opensubdiv_cells.h"

#include <opensubdiv/far/primvarRefiner.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "subdiv/opensubdiv_cage.h"

namespace limn {
namespace {

/// Around extraordinary vertices and semi-sharp features the patches approximate the limit; each level of isolation brings them nearer,
/// and sharpness wears off by 1 a level, so that 10 levels hold every semi-sharp crease.
constexpr int kSmoothLevels = 8, kSharpLevels = 10;
constexpr int kDeepest = 10;

/// OpenSubdiv 3.5 gives second derivatives of the wrong sign in the triangular patches that lie upside down in their face (it scales them
/// by the cube of what it scales first derivatives by, which is negative there). The change of the first derivatives tells.
void mend_sign(const BfrPatch& patch, double u, double v, LimitPoint& point) {
  constexpr double kStep = 1e-3;
  double step_u = kStep * (1.0 / 3.0 - u), step_v = kStep * (1.0 / 3.0 - v);
  if (std::abs(step_u) + std::abs(step_v) < 0.01 * kStep) step_u = 0.1 * kStep;
  const double uv[2] = {u + step_u, v + step_v};
  LimitPoint near;
  patch.surface.Evaluate(uv, patch.points.data(), 3, &near.position.x, &near.du.x, &near.dv.x);
  const double agreement = glm::dot(near.du - point.du, step_u * point.duu + step_v * point.duv) +
                           glm::dot(near.dv - point.dv, step_u * point.duv + step_v * point.dvv);
  if (agreement >= 0.0) return;
  point.duu = -point.duu, point.duv = -point.duv, point.dvv = -point.dvv;
}

/// A level of a refined cage with its points.
struct Level {
  const Far::TopologyLevel& topology;
  const std::vector<glm::dvec3>& positions;
  Scheme scheme = Scheme::catmark;
  CreaseMethod crease_method = CreaseMethod::uniform;
  TriangleRule triangle_rule = TriangleRule::catmark;
};

std::vector<int> touching_faces(const Far::TopologyLevel& level, int face) {
  std::vector<int> faces;
  for (const int v : level.GetFaceVertices(face))
    for (const int f : level.GetVertexFaces(v))
      if (f != face) faces.push_back(f);
  std::sort(faces.begin(), faces.end());
  faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
  return faces;
}

/// The face, from its corner `start`, and then all faces that touch it: its limit depends on no others, and under the bilinear scheme on
/// itself alone.
Mesh neighbourhood(const Level& level, int face, int start) {
  const Far::TopologyLevel& topology = level.topology;
  std::vector<int> faces{face};
  if (level.scheme != Scheme::bilinear) {
    const std::vector<int> others = touching_faces(topology, face);
    faces.insert(faces.end(), others.begin(), others.end());
  }
  Mesh part;
  std::map<int, std::int32_t> number;
  std::map<int, std::pair<std::int32_t, std::int32_t>> edges;
  for (const int f : faces) {
    const Far::ConstIndexArray vertices = topology.GetFaceVertices(f), of_face = topology.GetFaceEdges(f);
    const int n = vertices.size(), first = f == face ? start : 0;
    part.face_sizes.push_back(n);
    for (int i = 0; i < n; ++i) {
      const int v = vertices[(first + i) % n];
      const auto [entry, added] = number.try_emplace(v, static_cast<std::int32_t>(part.positions.size()));
      if (added) part.positions.push_back(level.positions[static_cast<size_t>(v)]);
      part.corner_vertices.push_back(entry->second);
    }
    for (int i = 0; i < n; ++i) edges[of_face[i]] = {number.at(vertices[i]), number.at(vertices[(i + 1) % n])};
  }
  for (const auto& [edge, ends] : edges)
    if (topology.GetEdgeSharpness(edge) > 0.0f && !topology.IsEdgeBoundary(edge))
      part.creases.push_back({ends.first, ends.second, topology.GetEdgeSharpness(edge)});
  for (const auto& [v, there] : number)
    if (topology.GetVertexSharpness(v) > 0.0f) part.corners.push_back({there, topology.GetVertexSharpness(v)});
  // The level has its corners sharp already; the part's cut edge must make none, and must not take the face away.
  part.boundary = BoundaryRule::edge_only;
  part.crease_method = level.crease_method;
  part.triangle_rule = level.triangle_rule;
  return part;
}

/// A child of a face and its corner to start from, so that the children lie in the face as their coordinates do: corner i of child i is
/// that of the face; those of an n-gon start at its corner.
struct Child {
  int face = 0, start = 0;
};

std::vector<Child> children_of(const Far::TopologyLevel& base, const Far::TopologyLevel& fine, bool triangles) {
  const Far::ConstIndexArray corners = base.GetFaceVertices(0), faces = base.GetFaceChildFaces(0);
  std::vector<Child> children;
  for (int i = 0; i < faces.size(); ++i) {
    const Far::ConstIndexArray vertices = fine.GetFaceVertices(faces[i]);
    const bool middle = triangles && i == 3;
    const int mark = middle ? base.GetEdgeChildVertex(base.GetFaceEdges(0)[1]) : base.GetVertexChildVertex(corners[i]);
    const int wanted = !middle && corners.size() == vertices.size() ? i : 0, n = vertices.size();
    const auto at = static_cast<int>(std::find(vertices.begin(), vertices.end(), mark) - vertices.begin());
    children.push_back({faces[i], (at - wanted + n) % n});
  }
  return children;
}

std::vector<glm::dvec3> subdivided(const Far::TopologyRefiner& refiner, const std::vector<glm::dvec3>& positions) {
  Points points(positions.size()), finer(static_cast<size_t>(refiner.GetLevel(1).GetNumVertices()));
  for (size_t v = 0; v < points.size(); ++v) points[v].p = positions[v];
  Far::PrimvarRefinerReal<double>(refiner).Interpolate(1, points, finer);
  std::vector<glm::dvec3> result;
  result.reserve(finer.size());
  for (const WeightedPoint& point : finer) result.push_back(point.p);
  return result;
}

/// Of face 0, a quad, at its corner of valence 2; none where it has no such corner.
std::unique_ptr<LimitTip> tip_of(const Far::TopologyLevel& level, const Mesh& mesh, Scheme scheme) {
  const Far::ConstIndexArray corners = level.GetFaceVertices(0);
  if (corners.size() != 4) return nullptr;
  Points points(mesh.vertex_count());
  for (size_t v = 0; v < points.size(); ++v) points[v].p = mesh.positions[v];
  for (int i = 0; i < 4; ++i) {
    if (level.GetVertexFaces(corners[i]).size() != 2 || level.IsVertexBoundary(corners[i])) continue;
    auto tip = std::make_unique<LimitTip>();
    for (int k = 0; k < 4; ++k) tip->corners[static_cast<size_t>(k)] = mesh.positions[static_cast<size_t>(corners[k])];
    const OneRing ring = one_ring(level, scheme, points, corners[i]);
    // The subdivision of the ring has the eigenvalue 1/4 for what the two edges and the two faces differ by, unless one is sharp.
    if (ring.sharpness[0] == 0.0f && ring.sharpness[1] == 0.0f)
      tip->tangent1 = ring.edges[0] - ring.edges[1], tip->tangent2 = ring.diagonals[0] - ring.diagonals[1];
    return tip;
  }
  return nullptr;
}

constexpr std::array<glm::dvec2, 4> kCorners{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};

/// A tip at a crease has the tangents of the place where the child across from it begins.
void fill_tangents(LimitCell& cell, Scheme scheme) {
  for (size_t i = 0; i < cell.children.size() && cell.corners == 4 && scheme != Scheme::loop; ++i) {
    LimitTip* tip = cell.children[i].tip.get();
    LimitPoint point;
    if (tip == nullptr || tip->tangent1 != glm::dvec3(0.0)) continue;
    if (!evaluate_cell(cell.children[(i + 2) % 4], scheme, 0, kCorners[i].x, kCorners[i].y, LimitOrder::first, point)) continue;
    tip->tangent1 = point.du, tip->tangent2 = point.dv;
  }
}

LimitCell cell_of(const Level& level, const Child& at, int depth) {
  const Mesh part = neighbourhood(level, at.face, at.start);
  const std::unique_ptr<Far::TopologyRefiner> refiner = make_refiner(part, level.scheme, {});
  const Far::TopologyLevel& base = refiner->GetLevel(0);
  LimitCell cell;
  cell.corners = part.face_sizes[0];
  for (const int v : base.GetFaceVertices(0))
    if (base.IsVertexNonManifold(v)) return cell;
  if (simple_neighbourhood(base, 0)) {
    cell.patch = make_patch(Bfr::RefinerSurfaceFactory<>(*refiner, patch_options()), 0, part.positions);
  } else if (depth == kDeepest) {
    cell.tip = tip_of(base, part, level.scheme);
  } else {
    Far::TopologyRefiner::UniformOptions options(1);
    options.fullTopologyInLastLevel = true;
    refiner->RefineUniform(options);
    const std::vector<glm::dvec3> positions = subdivided(*refiner, part.positions);
    const Level finer{refiner->GetLevel(1), positions, level.scheme, level.crease_method};
    for (const Child& child : children_of(refiner->GetLevel(0), finer.topology, level.scheme == Scheme::loop))
      cell.children.push_back(cell_of(finer, child, depth + 1));
    fill_tangents(cell, level.scheme);
  }
  return cell;
}

bool evaluate_tip(const LimitTip& tip, double u, double v, LimitPoint& out) {
  const auto& c = tip.corners;
  out = {};
  out.position = (1.0 - u) * ((1.0 - v) * c[0] + v * c[3]) + u * ((1.0 - v) * c[1] + v * c[2]);
  out.du = tip.tangent1, out.dv = tip.tangent2;
  if (glm::length(glm::cross(out.du, out.dv)) > 1e-9 * glm::length(out.du) * glm::length(out.dv)) return true;
  out.du = (1.0 - v) * (c[1] - c[0]) + v * (c[2] - c[3]);
  out.dv = (1.0 - u) * (c[3] - c[0]) + u * (c[2] - c[1]);
  return true;
}

struct Place {
  size_t child = 0;
  double u = 0.0, v = 0.0;
  double scale = 2.0;  ///< Of the child's coordinates by the parent's.
};

Place child_at(const LimitCell& cell, Scheme scheme, double u, double v) {
  if (scheme == Scheme::loop) {
    if (u >= 0.5) return {1, 2.0 * u - 1.0, 2.0 * v};
    if (v >= 0.5) return {2, 2.0 * u, 2.0 * v - 1.0};
    if (u + v <= 0.5) return {0, 2.0 * u, 2.0 * v};
    return {3, 1.0 - 2.0 * u, 1.0 - 2.0 * v, -2.0};
  }
  const bool right = u >= 0.5, up = v >= 0.5;
  static constexpr size_t kCorner[2][2] = {{0, 3}, {1, 2}};
  return {cell.corners == 4 ? kCorner[right][up] : 0, 2.0 * u - right, 2.0 * v - up};
}

}  // namespace

bool LimitCell::valid() const {
  if (!children.empty()) return std::all_of(children.begin(), children.end(), [](const LimitCell& child) { return child.valid(); });
  return tip != nullptr || patch.surface.IsValid();
}

Bfr::SurfaceFactory::Options patch_options() {
  Bfr::SurfaceFactory::Options options;
  options.SetApproxLevelSmooth(kSmoothLevels).SetApproxLevelSharp(kSharpLevels);
  return options;
}

BfrPatch make_patch(const Bfr::RefinerSurfaceFactory<>& factory, int face, const std::vector<glm::dvec3>& positions) {
  static_assert(sizeof(glm::dvec3) == 3 * sizeof(double));
  BfrPatch patch;
  if (!factory.InitVertexSurface(face, &patch.surface)) return patch;
  patch.points.resize(3 * static_cast<size_t>(patch.surface.GetNumPatchPoints()));
  patch.surface.PreparePatchPoints(&positions[0].x, 3, patch.points.data(), 3);
  return patch;
}

void evaluate_patch(const BfrPatch& patch, Scheme scheme, double u, double v, LimitOrder order, LimitPoint& out) {
  const double uv[2] = {u, v};
  if (order == LimitOrder::first) {
    patch.surface.Evaluate(uv, patch.points.data(), 3, &out.position.x, &out.du.x, &out.dv.x);
    out.duu = out.duv = out.dvv = glm::dvec3(0.0);
    return;
  }
  patch.surface.Evaluate(uv, patch.points.data(), 3, &out.position.x, &out.du.x, &out.dv.x, &out.duu.x, &out.duv.x, &out.dvv.x);
  if (scheme == Scheme::loop) mend_sign(patch, u, v, out);
}

bool simple_neighbourhood(const Far::TopologyLevel& level, int face) {
  const Far::ConstIndexArray corners = level.GetFaceVertices(face);
  std::vector<std::pair<int, int>> met;
  for (int i = 0; i < corners.size(); ++i) {
    if (level.IsVertexNonManifold(corners[i])) return false;
    for (const int neighbour : level.GetVertexFaces(corners[i]))
      if (neighbour != face) met.emplace_back(neighbour, i);
  }
  std::sort(met.begin(), met.end());
  const int n = corners.size();
  for (size_t first = 0, end = 0; first < met.size(); first = end) {
    while (end < met.size() && met[end].first == met[first].first) ++end;
    if (end - first == 1) continue;
    const int gap = met[first + 1].second - met[first].second;
    if (end - first > 2 || (gap != 1 && gap != n - 1)) return false;
  }
  return true;
}

LimitCell make_cell(const Far::TopologyRefiner& refiner, const Mesh& mesh, Scheme scheme, int face) {
  return cell_of({refiner.GetLevel(0), mesh.positions, scheme, mesh.crease_method, mesh.triangle_rule}, {face, 0}, 0);
}

bool has_tip(const LimitCell& cell, int sub_face, int corner) {
  if (cell.children.empty()) return cell.tip != nullptr;
  if (cell.corners != 4) return has_tip(cell.children[static_cast<size_t>(sub_face)], 0, corner);
  return has_tip(cell.children[static_cast<size_t>(corner)], 0, corner);
}

bool evaluate_cell(const LimitCell& cell, Scheme scheme, int sub_face, double u, double v, LimitOrder order, LimitPoint& out) {
  if (cell.tip) return evaluate_tip(*cell.tip, u, v, out);
  if (cell.children.empty()) {
    if (!cell.patch.surface.IsValid()) return false;
    const Bfr::Parameterization parameters = cell.patch.surface.GetParameterization();
    double uv[2] = {u, v}, scale = 1.0;
    if (parameters.HasSubFaces()) {
      if (sub_face < 0 || sub_face >= parameters.GetFaceSize()) return false;
      const double normalized[2] = {u, v};
      parameters.ConvertNormalizedSubFaceToCoord(sub_face, normalized, uv);
      scale = 0.5;  // A sub-quad is half a unit wide in its face's coordinates.
    }
    evaluate_patch(cell.patch, scheme, uv[0], uv[1], order, out);
    out.du *= scale, out.dv *= scale;
    out.duu *= scale * scale, out.duv *= scale * scale, out.dvv *= scale * scale;
    return true;
  }
  if (scheme != Scheme::loop && cell.corners != 4) {
    if (sub_face < 0 || sub_face >= cell.corners) return false;
    return evaluate_cell(cell.children[static_cast<size_t>(sub_face)], scheme, 0, u, v, order, out);
  }
  const Place place = child_at(cell, scheme, u, v);
  if (!evaluate_cell(cell.children[place.child], scheme, 0, place.u, place.v, order, out)) return false;
  const double s = place.scale;
  out.du *= s, out.dv *= s, out.duu *= s * s, out.duv *= s * s, out.dvv *= s * s;
  return true;
}

}  // namespace limn
