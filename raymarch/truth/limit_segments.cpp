// The sign of h = N.V - c at the corners of a triangulated sheet says which of its edges a curve crosses; along an edge of one side the
// crossing is a root of h, along a crease the curve follows the edge where the signs of its two sides differ. What is crossed is known by
// the sides at both ends, so that segments of neighbouring triangles join without any search.

#include "raymarch/truth/limit_tracer.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace limn {
namespace {

constexpr int kRootSteps = 40;

/// At a node: the tip of a cone, to which a curve leads between two of the ways there.
LimitEnd tip_end(const LimitTriangle& triangle, size_t corner) {
  return {{triangle.corners[corner].node, 0, 2}, triangle.patch, triangle.corners[corner].uv};
}

/// Once around the triangle, along its edges and, at tips of cones, from one way there to the other: where h falls below 0 and where it
/// rises again a curve goes through.
void cross_triangle(LimitTracer& tracer, const LimitTriangle& triangle) {
  std::optional<LimitEnd> falls, rises;
  size_t above = 0;
  const auto pass = [&](double before, double after, const auto& end) {
    if ((before >= 0.0) == (after >= 0.0)) return;
    (before >= 0.0 ? falls : rises) = end();
  };
  for (int i = 0; i < 3; ++i) {
    const auto at = static_cast<size_t>(i);
    const int next = (i + 1) % 3;
    const double back = tracer.h(triangle.corners[at].side_back), away = tracer.h(triangle.corners[at].side);
    if (std::max(back, away) >= 0.0) above = at;
    if (triangle.corners[at].side_back != triangle.corners[at].side) pass(back, away, [&] { return tip_end(triangle, at); });
    pass(away, tracer.h(triangle.corners[static_cast<size_t>(next)].side_back), [&] { return end_on(tracer, triangle, i, next, 0); });
  }
  if (!falls || !rises) return;
  LimitSegment segment;
  segment.ends[0] = *falls;
  segment.ends[1] = *rises;
  segment.beside = tracer.grid.positions[triangle.corners[above].node];
  // From where h falls to where it rises the part above lies on the left. Seen are a contour's parts of higher N.V on the left and a level
  // curve's ink, which is of lower N.V, whichever way the surface bends.
  segment.left = (tracer.level.kind == CurveKind::silhouette) != tracer.mirrored;
  tracer.segments.push_back(segment);
}

}  // namespace

double root_on(LimitTracer& tracer, const LimitTriangle& triangle, int from, int to, int kind) {
  struct Node {
    std::uint32_t side;
    glm::dvec2 uv;
  };
  Node a{side_towards(triangle, from, to), triangle.corners[static_cast<size_t>(from)].uv},
      b{side_towards(triangle, to, from), triangle.corners[static_cast<size_t>(to)].uv};
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
  return {root_key(side_towards(triangle, from, to), side_towards(triangle, to, from), kind), triangle.patch, glm::mix(a.uv, b.uv, t)};
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
  if (level.seams) cross_seams(tracer);
  return std::move(tracer.segments);
}

}  // namespace limn
