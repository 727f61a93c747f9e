#include "subdiv/interpolating_cage.h"

#include <opensubdiv/far/primvarRefiner.h>

#include <algorithm>
#include <cmath>

#include "sdf/parallel.h"
#include "subdiv/edge_topology.h"
#include "subdiv/fair_mesh.h"
#include "subdiv/opensubdiv_cage.h"
#include "subdiv/sharp_edges.h"

namespace limn {
namespace {

// Eigenvalues of the limit masks lie between these: all weights are positive and add up to 1, and the smallest one that regular and
// irregular triangulations have is 0.15, of an octahedron.
constexpr double kLeastEigenvalue = 0.1, kMostEigenvalue = 1.0;
constexpr int kMostSweeps = 60;
constexpr int kMostCorrections = 8;

/// Holes left out, vertices at one position joined.
Mesh triangles_of(const Mesh& mesh) {
  const std::vector<std::int32_t> first_at = first_vertex_at_position(mesh), first = first_corners(mesh);
  Mesh result;
  result.positions = mesh.positions;
  result.material_names = mesh.material_names;
  result.material_colors = mesh.material_colors;
  result.draws_colors = mesh.draws_colors;
  std::vector<glm::dvec3> corners;
  std::vector<std::array<std::int32_t, 3>> triangles;
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    if (std::binary_search(mesh.holes.begin(), mesh.holes.end(), static_cast<std::int32_t>(f))) continue;
    const std::span<const std::int32_t> vertices = face_corners(mesh, first[f], f);
    triangles.assign(1, {0, 1, 2});
    if (vertices.size() > 3) {
      gather_corners(mesh, vertices, corners);
      triangles.clear();
      triangulate_polygon(corners, triangles);
    }
    for (const auto& triangle : triangles) {
      result.face_sizes.push_back(3);
      for (const std::int32_t corner : triangle)
        result.corner_vertices.push_back(first_at[static_cast<size_t>(vertices[static_cast<size_t>(corner)])]);
      if (!mesh.face_materials.empty()) result.face_materials.push_back(mesh.face_materials[f]);
    }
  }
  return result;
}

/// Weights of the cage's vertices, for OpenSubdiv's refiner to weigh and add.
struct MaskRow {
  std::vector<std::pair<int, double>> weights{};
  void Clear(void* = nullptr) { weights.clear(); }
  void AddWithWeight(const MaskRow& other, double weight) { weights.emplace_back(other.weights[0].first, weight); }
};

/// Where the limit of each vertex of the cage is, as a weighted sum of the cage's vertices.
std::vector<MaskRow> limit_masks(const Far::TopologyRefiner& refiner) {
  std::vector<MaskRow> vertices(static_cast<size_t>(refiner.GetLevel(0).GetNumVertices())), masks(vertices.size());
  for (size_t v = 0; v < vertices.size(); ++v) vertices[v].weights.emplace_back(static_cast<int>(v), 1.0);
  Far::PrimvarRefinerReal<double>(refiner).Limit(vertices, masks);
  return masks;
}

/// An x whose masked sums are `wanted`, nearly: Chebyshev's acceleration (Saad 2003, "Iterative methods for sparse linear systems",
/// algorithm 12.1).
std::vector<glm::dvec3> solve(const std::vector<MaskRow>& masks, const std::vector<glm::dvec3>& wanted, double tolerance) {
  constexpr double kMiddle = 0.5 * (kMostEigenvalue + kLeastEigenvalue), kHalf = 0.5 * (kMostEigenvalue - kLeastEigenvalue);
  std::vector<glm::dvec3> x(wanted.size(), glm::dvec3(0.0)), move = wanted, rest = wanted;
  std::vector<double> off(x.size());
  for (glm::dvec3& one : move) one /= kMiddle;
  double rho = kHalf / kMiddle;
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    for (size_t v = 0; v < x.size(); ++v) x[v] += move[v];
    parallel_for(size_t{0}, x.size(), [&](size_t v) {
      glm::dvec3 sum(0.0);
      for (const auto& [other, weight] : masks[v].weights) sum += weight * x[static_cast<size_t>(other)];
      rest[v] = wanted[v] - sum;
      off[v] = glm::length(rest[v]);
    });
    if (*std::max_element(off.begin(), off.end()) <= tolerance) break;
    const double next = 1.0 / (2.0 * kMiddle / kHalf - rho);
    for (size_t v = 0; v < x.size(); ++v) move[v] = next * rho * move[v] + 2.0 * next / kHalf * rest[v];
    rho = next;
  }
  return x;
}

/// From the limit of each vertex of the cage to where it is to be.
std::vector<glm::dvec3> off_limit(const Far::TopologyRefiner& refiner, const Mesh& cage, const std::vector<glm::dvec3>& through) {
  Points points(through.size());
  for (size_t v = 0; v < points.size(); ++v) points[v].p = cage.positions[v];
  const LimitFrame limit = limit_frame(refiner, Scheme::loop, points);
  std::vector<glm::dvec3> off(through.size());
  for (size_t v = 0; v < off.size(); ++v) off[v] = through[v] - limit.positions[v].p;
  return off;
}

double longest(const std::vector<glm::dvec3>& off) {
  double most = 0.0;
  for (const glm::dvec3& one : off) most = std::max(most, glm::length(one));
  return most;
}

}  // namespace

InterpolatedMesh interpolating_cage(const Mesh& mesh, const InterpolationSettings& settings, const std::string& file) {
  Mesh triangles = triangles_of(mesh);
  mark_creases(settings.crease_angle_deg, triangles);
  Mesh cage = clean_cage(triangles, Scheme::loop, file).mesh;
  const double moved = settings.fairing_edges > 0.0 ? fair(settings.fairing_edges, cage) : 0.0;
  std::vector<glm::dvec3> through = cage.positions;
  const std::unique_ptr<Far::TopologyRefiner> refiner = make_refiner(cage, Scheme::loop, file);
  const std::vector<MaskRow> masks = limit_masks(*refiner);
  const double tolerance = settings.tolerance * bounds(cage).longest_side();
  std::vector<glm::dvec3> off = off_limit(*refiner, cage, through);
  // The masks hold but for ends of creases, whose own limit says what is left.
  for (int k = 0; k < kMostCorrections && longest(off) > tolerance; ++k) {
    Mesh nearer = cage;
    const std::vector<glm::dvec3> moves = solve(masks, off, 0.1 * tolerance);
    for (size_t v = 0; v < moves.size(); ++v) nearer.positions[v] += moves[v];
    std::vector<glm::dvec3> left = off_limit(*refiner, nearer, through);
    if (!(longest(left) < longest(off))) break;
    cage = std::move(nearer);
    off = std::move(left);
  }
  return {std::move(cage), std::move(through), moved};
}

}  // namespace limn
