// The sign of h = N.V - c at the corners of a triangulated sheet says which of its edges a curve crosses; along an edge of one side the
// crossing is a root of h, along a crease the curve follows the edge where the signs of its two sides differ. What is crossed is known by
// the sides at both ends, so that segments of neighbouring triangles join without any search.

#include "raymarch/truth/limit_tracer.h"

#include <algorithm>
#include <cmath>

namespace limn {
namespace {

constexpr int kRootSteps = 40;

void cross_triangle(LimitTracer& tracer, const LimitTriangle& triangle) {
  bool positive[3];
  for (size_t i = 0; i < 3; ++i) positive[i] = tracer.h(triangle.corners[i].side) >= 0.0;
  if (positive[0] == positive[1] && positive[1] == positive[2]) return;
  // The corner that is alone with its sign: both crossings lie on its edges.
  const int lone = positive[0] == positive[1] ? 2 : positive[0] == positive[2] ? 1 : 0;
  LimitSegment segment;
  segment.ends[0] = end_on(tracer, triangle, lone, (lone + 1) % 3, 0);
  segment.ends[1] = end_on(tracer, triangle, lone, (lone + 2) % 3, 0);
  const auto other = static_cast<size_t>(positive[lone] ? lone : (lone + 1) % 3);
  segment.beside = tracer.grid.positions[triangle.corners[other].node];
  // From the first end to the second the lone corner lies on the left. Seen are a contour's parts of higher N.V on the left and a level
  // curve's ink, which is of lower N.V, whichever way the surface bends.
  segment.left = (positive[lone] == (tracer.level.kind == CurveKind::silhouette)) != tracer.mirrored;
  tracer.segments.push_back(segment);
}

}  // namespace

double root_on(LimitTracer& tracer, const LimitTriangle& triangle, int from, int to, int kind) {
  LimitCorner a = triangle.corners[static_cast<size_t>(from)], b = triangle.corners[static_cast<size_t>(to)];
  const bool turned = a.side > b.side;
  if (turned) std::swap(a, b);
  const double level = kind == 0 ? tracer.level.threshold : 0.0;
  const auto [entry, added] = tracer.roots.try_emplace(root_key(a.side, b.side, kind), 0.0);
  if (added)
    entry->second = root_between(tracer.placed, tracer.camera, triangle.patch, a.uv, b.uv, tracer.facing[a.side] - level,
                                 tracer.facing[b.side] - level, level);
  return turned ? 1.0 - entry->second : entry->second;
}

LimitEnd end_on(LimitTracer& tracer, const LimitTriangle& triangle, int from, int to, int kind) {
  const LimitCorner &a = triangle.corners[static_cast<size_t>(from)], &b = triangle.corners[static_cast<size_t>(to)];
  const double t = root_on(tracer, triangle, from, to, kind);
  return {root_key(a.side, b.side, kind), triangle.patch, glm::mix(a.uv, b.uv, t)};
}

double facing_at(const PlacedLimitSurface& placed, const Camera& camera, std::uint32_t patch, const glm::dvec2& uv) {
  const LimitSample s = sample(placed, patch, uv);
  return glm::dot(s.normal, view_vector(camera, s.position));
}

// The Illinois method (Dowell & Jarratt 1971): false position that halves the weight of an end which stays.
double root_between(const PlacedLimitSurface& placed, const Camera& camera, std::uint32_t patch, const glm::dvec2& uv0,
                    const glm::dvec2& uv1, double h0, double h1, double level) {
  double low = 0.0, high = 1.0;
  for (int step = 0; step < kRootSteps && high - low > 1e-7; ++step) {
    double t = h0 == h1 ? 0.5 * (low + high) : low + (high - low) * h0 / (h0 - h1);
    if (!(t > low && t < high)) t = 0.5 * (low + high);
    const double value = facing_at(placed, camera, patch, glm::mix(uv0, uv1, t)) - level;
    if (std::abs(value) < 1e-13) return t;
    if ((value < 0.0) == (h0 < 0.0)) {
      low = t;
      h0 = value;
      h1 *= 0.5;
    } else {
      high = t;
      h1 = value;
      h0 *= 0.5;
    }
  }
  return 0.5 * (low + high);
}

std::vector<LimitSegment> limit_segments(const PlacedLimitSurface& placed, const LimitGrid& grid, const Camera& camera,
                                         const LimitLevel& level) {
  LimitTracer tracer{placed, grid, camera, level, glm::determinant(placed.world_from_cage.linear) < 0.0};
  tracer.facing.resize(grid.normals.size());
  for (size_t s = 0; s < grid.normals.size(); ++s)
    tracer.facing[s] = glm::dot(grid.normals[s], view_vector(camera, grid.positions[grid.node_of_side[s]]));
  for (const LimitTriangle& triangle : grid.triangles) cross_triangle(tracer, triangle);
  cross_seams(tracer);
  return std::move(tracer.segments);
}

}  // namespace limn
