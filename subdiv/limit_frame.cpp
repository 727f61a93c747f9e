#include <fmt/format.h>
#include <opensubdiv/far/primvarRefiner.h>

#include <algorithm>
#include <iterator>

#include "sdf/error.h"
#include "sdf/parallel.h"
#include "subdiv/opensubdiv_cage.h"

namespace limn {
namespace {

namespace Sdc = OpenSubdiv::Sdc;

/// The edge of `level` that joins two vertices; it must be there.
int edge_between(const Far::TopologyLevel& level, int a, int b) {
  for (const int e : level.GetVertexEdges(a)) {
    const Far::ConstIndexArray ends = level.GetEdgeVertices(e);
    if (ends[0] == b || ends[1] == b) return e;
  }
  constexpr bool kSpokesAreEdges = false;
  LIMN_CHECK(kSpokesAreEdges);
  return -1;
}

Points points_of(const Mesh& mesh) {
  Points points(mesh.vertex_count());
  for (size_t i = 0; i < points.size(); ++i) points[i].p = mesh.positions[i];
  return points;
}

/// Each ring after one subdivision: the ring of the same vertex, half as wide, its sharpness worn by one.
std::vector<OneRing> subdivide(const std::vector<OneRing>& rings, Scheme scheme, CreaseMethod creases) {
  const Fans fans = gather_fans(rings, scheme, creases);
  const std::unique_ptr<Far::TopologyRefiner> refiner = make_refiner(fans.mesh, scheme, {});
  Far::TopologyRefiner::UniformOptions options(1);
  options.fullTopologyInLastLevel = true;
  refiner->RefineUniform(options);
  const Far::TopologyLevel &base = refiner->GetLevel(0), &fine = refiner->GetLevel(1);
  Points finer(static_cast<size_t>(fine.GetNumVertices()));
  const Points points = points_of(fans.mesh);
  Far::PrimvarRefinerReal<double>(*refiner).Interpolate(1, points, finer);
  std::vector<OneRing> result;
  int face = 0;
  for (size_t r = 0; r < rings.size(); ++r) {
    const int center = fans.centers[r], child = base.GetVertexChildVertex(center);
    OneRing ring;
    ring.center = finer[static_cast<size_t>(child)].p;
    ring.center_sharpness = fine.GetVertexSharpness(child);
    ring.face_total = rings[r].face_total;
    for (size_t i = 0; i < rings[r].edges.size(); ++i) {
      const int spoke = edge_between(base, center, center + 1 + static_cast<int>(i)), middle = base.GetEdgeChildVertex(spoke);
      const int edge = edge_between(fine, child, middle);
      ring.edges.push_back(finer[static_cast<size_t>(middle)].p);
      ring.sharpness.push_back(fine.IsEdgeBoundary(edge) ? 0.0f : fine.GetEdgeSharpness(edge));
    }
    for (size_t i = 0; i < rings[r].face_total; ++i, ++face)
      if (scheme != Scheme::loop) ring.diagonals.push_back(finer[static_cast<size_t>(base.GetFaceChildVertex(face))].p);
    result.push_back(std::move(ring));
  }
  return result;
}

bool semi_sharp(const OneRing& ring) {
  const auto semi = [](float s) { return s > 0.0f && s < kInfiniteSharpness; };
  return semi(ring.center_sharpness) || std::any_of(ring.sharpness.begin(), ring.sharpness.end(), semi);
}

/// The tangents' cross product must point to the side from which the faces run counter-clockwise.
glm::dvec3 ring_area(const OneRing& ring) {
  glm::dvec3 area(0.0);
  for (size_t i = 0; i < ring.face_total; ++i)
    area += glm::cross(ring.edges[i] - ring.center, ring.edges[(i + 1) % ring.edges.size()] - ring.center);
  return area;
}

/// Vertices whose features are still wearing off: their rings are subdivided until nothing semi-sharp is left, then the masks hold.
void settle_semi_sharp(std::vector<OneRing> rings, Scheme scheme, CreaseMethod creases, LimitFrame& frame) {
  while (std::any_of(rings.begin(), rings.end(), semi_sharp)) rings = subdivide(rings, scheme, creases);
  const Fans fans = gather_fans(rings, scheme, creases);
  const std::unique_ptr<Far::TopologyRefiner> refiner = make_refiner(fans.mesh, scheme, {});
  const Points points = points_of(fans.mesh);
  const LimitFrame settled = limit_frame(*refiner, scheme, points);
  const std::vector<glm::vec3> normals = limit_normals(*refiner, scheme, points, settled, &fans.centers);
  const size_t sides = scheme == Scheme::loop ? 3 : 4;
  size_t face = 0;
  for (size_t r = 0; r < rings.size(); ++r) {
    LimitFrame::Ring& ring = frame.semi_sharp[r];
    frame.positions[static_cast<size_t>(ring.vertex)] = settled.positions[static_cast<size_t>(fans.centers[r])];
    // Fans put their centre first in every face.
    for (size_t i = 0; i < rings[r].face_total; ++i, ++face) ring.normals.push_back(normals[face * sides]);
  }
}

/// OpenSubdiv 3.5 takes smooth vertices of valence 2 for corners. Their position by the mask for all valences; the eigenvalue next to 1 is
/// 1/4, for what the two edges and the two faces differ by, which are the tangents (where Loop's scheme has none, the facets decide).
void settle_valence_two(const OneRing& ring, size_t v, LimitFrame& frame) {
  frame.tangent1[v].p = ring.edges[0] - ring.edges[1];
  if (ring.diagonals.empty()) {
    frame.tangent2[v].p = glm::dvec3(0.0);
    return;
  }
  frame.positions[v].p = (4.0 * ring.center + 4.0 * (ring.edges[0] + ring.edges[1]) + ring.diagonals[0] + ring.diagonals[1]) / 14.0;
  frame.tangent2[v].p = ring.diagonals[0] - ring.diagonals[1];
}

}  // namespace

bool still_semi_sharp(const Far::TopologyLevel& level, int vertex) {
  if (level.IsVertexSemiSharp(vertex)) return true;
  for (const int e : level.GetVertexEdges(vertex))
    if (level.IsEdgeSemiSharp(e)) return true;
  return false;
}

OneRing one_ring(const Far::TopologyLevel& level, Scheme scheme, const Points& points, int vertex) {
  OneRing ring;
  ring.center = points[static_cast<size_t>(vertex)].p;
  ring.center_sharpness = level.GetVertexSharpness(vertex);
  for (const int e : level.GetVertexEdges(vertex)) {
    const Far::ConstIndexArray ends = level.GetEdgeVertices(e);
    ring.edges.push_back(points[static_cast<size_t>(ends[0] == vertex ? ends[1] : ends[0])].p);
    ring.sharpness.push_back(level.IsEdgeBoundary(e) ? 0.0f : level.GetEdgeSharpness(e));
  }
  const Far::ConstIndexArray faces = level.GetVertexFaces(vertex);
  const Far::ConstLocalIndexArray corner = level.GetVertexFaceLocalIndices(vertex);
  ring.face_total = static_cast<size_t>(faces.size());
  for (int i = 0; i < faces.size() && scheme != Scheme::loop; ++i)
    ring.diagonals.push_back(points[static_cast<size_t>(level.GetFaceVertices(faces[i])[(corner[i] + 2) % 4])].p);
  return ring;
}

CreaseMethod crease_method(const Far::TopologyRefiner& refiner) {
  const bool chaikin = refiner.GetSchemeOptions().GetCreasingMethod() == Sdc::Options::CREASE_CHAIKIN;
  return chaikin ? CreaseMethod::chaikin : CreaseMethod::uniform;
}

Fans gather_fans(const std::vector<OneRing>& rings, Scheme scheme, CreaseMethod creases) {
  Fans fans;
  fans.mesh.crease_method = creases;
  fans.mesh.boundary = BoundaryRule::edge_only;
  for (const OneRing& ring : rings) {
    const auto center = static_cast<std::int32_t>(fans.mesh.vertex_count());
    const auto edges = static_cast<std::int32_t>(ring.edges.size()), faces = static_cast<std::int32_t>(ring.face_total);
    fans.centers.push_back(center);
    fans.mesh.positions.push_back(ring.center);
    fans.mesh.positions.insert(fans.mesh.positions.end(), ring.edges.begin(), ring.edges.end());
    fans.mesh.positions.insert(fans.mesh.positions.end(), ring.diagonals.begin(), ring.diagonals.end());
    for (std::int32_t i = 0; i < faces; ++i) {
      const std::int32_t from = center + 1 + i, to = center + 1 + (i + 1) % edges, diagonal = center + 1 + edges + i;
      fans.mesh.face_sizes.push_back(scheme == Scheme::loop ? 3 : 4);
      if (scheme == Scheme::loop) {
        fans.mesh.corner_vertices.insert(fans.mesh.corner_vertices.end(), {center, from, to});
      } else {
        fans.mesh.corner_vertices.insert(fans.mesh.corner_vertices.end(), {center, from, diagonal, to});
      }
    }
    for (std::int32_t i = 0; i < edges; ++i)
      if (ring.sharpness[static_cast<size_t>(i)] > 0.0f)
        fans.mesh.creases.push_back({center, center + 1 + i, ring.sharpness[static_cast<size_t>(i)]});
    if (ring.center_sharpness > 0.0f) fans.mesh.corners.push_back({center, ring.center_sharpness});
  }
  return fans;
}

/// For tangents on a crease Catmull-Clark's masks take a place for each face about the vertex, where OpenSubdiv 3.5 (far/primvarRefiner.h,
/// limit) has as many as the largest valence. More faces than that, about an edge with more than two, come to lie in the next mask, which
/// harms nobody, since the normals there are found otherwise (limit_normals); but beyond the last one they would leave the buffer.
void check_room_for_masks(const Far::TopologyRefiner& refiner) {
  const Far::TopologyLevel& level = refiner.GetLevel(refiner.GetMaxLevel());
  const int valence = refiner.GetMaxValence(), mask = 1 + 2 * valence;
  const int indices = std::max(mask, 33), weights = std::max(3 * mask, 99);
  for (int v = 0; v < level.GetNumVertices(); ++v) {
    if (level.GetVertexRule(v) != Sdc::Crease::RULE_CREASE) continue;
    const int edges = level.GetVertexEdges(v).size(), faces = level.GetVertexFaces(v).size();
    if (edges + faces <= indices && 2 * mask + 1 + valence + faces <= weights) continue;
    int sharing = 0;
    for (const int e : level.GetVertexEdges(v)) sharing = std::max(sharing, level.GetEdgeFaces(e).size());
    throw InputError({"", "mesh", fmt::format("{} faces at one edge", sharing), "too many faces share an edge for a limit surface",
                      "a cage whose edges have two faces, or scheme = bilinear"});
  }
}

namespace {

/// What masks do not tell, of a run of vertices; `frame` is written at these only.
struct Unsettled {
  std::vector<int> vertices{};  ///< Semi-sharp ones, in order.
  std::vector<OneRing> rings{};
};

Unsettled settle_vertices(const Far::TopologyLevel& level, Scheme scheme, const Points& points, int first, int last, LimitFrame& frame) {
  Unsettled unsettled;
  for (int v = first; v < last; ++v) {
    if (level.IsVertexNonManifold(v) || level.GetVertexFaces(v).size() == 0) continue;
    if (still_semi_sharp(level, v)) {
      unsettled.vertices.push_back(v);
      unsettled.rings.push_back(one_ring(level, scheme, points, v));
    } else if (level.GetVertexRule(v) == Sdc::Crease::RULE_SMOOTH && level.GetVertexFaces(v).size() == 2 && !level.IsVertexBoundary(v)) {
      settle_valence_two(one_ring(level, scheme, points, v), static_cast<size_t>(v), frame);
    } else if (level.GetVertexRule(v) == Sdc::Crease::RULE_DART) {
      const OneRing ring = one_ring(level, scheme, points, v);
      VertexLimit limit = dart_limit(ring, scheme);
      if (glm::dot(glm::cross(limit.tangent1, limit.tangent2), ring_area(ring)) < 0.0) std::swap(limit.tangent1, limit.tangent2);
      const auto i = static_cast<size_t>(v);
      frame.positions[i].p = limit.position, frame.tangent1[i].p = limit.tangent1, frame.tangent2[i].p = limit.tangent2;
    }
  }
  return unsettled;
}

}  // namespace

LimitFrame limit_frame(const Far::TopologyRefiner& refiner, Scheme scheme, const Points& points) {
  if (scheme == Scheme::catmark) check_room_for_masks(refiner);
  LimitFrame frame;
  limit_points(refiner, scheme, points, frame);
  if (scheme == Scheme::bilinear) return frame;
  const Far::TopologyLevel& level = refiner.GetLevel(refiner.GetMaxLevel());
  constexpr int kTogether = 4096;
  std::vector<Unsettled> parts(static_cast<size_t>((level.GetNumVertices() + kTogether - 1) / kTogether));
  parallel_each(parts.size(), [&](size_t i) {
    const int first = static_cast<int>(i) * kTogether;
    parts[i] = settle_vertices(level, scheme, points, first, std::min(first + kTogether, level.GetNumVertices()), frame);
  });
  std::vector<OneRing> rings;
  for (Unsettled& part : parts) {
    for (const int v : part.vertices) frame.semi_sharp.push_back({v, {}});
    std::move(part.rings.begin(), part.rings.end(), std::back_inserter(rings));
  }
  if (!rings.empty()) settle_semi_sharp(std::move(rings), scheme, crease_method(refiner), frame);
  return frame;
}

}  // namespace limn
