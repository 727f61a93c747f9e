// The sign of h = N.V - c at the corners of a triangulated sheet says which of its edges a curve crosses; along an edge of one side the
// crossing is a root of h, along a crease the curve follows the edge where the signs of its two sides differ. What is crossed is known by
// the sides at both ends, so that segments of neighbouring triangles join without any search.

#include "raymarch/truth/limit_tracer.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr double kRootPlace = 1e-7;  // of an edge
constexpr int kRootSteps = 40;
constexpr double kWidthSlack = 1e-6;  // radians: cosines say little of small angles

/// At a node: the tip of a cone, to which a curve leads between two of the ways there.
LimitEnd tip_end(const LimitTriangle& triangle, size_t corner) {
  return {{triangle.corners[corner].node, 0, 2}, triangle.patch, triangle.corners[corner].uv()};
}

}  // namespace

namespace {

/// A triangle's edge from its smaller side to its greater; `turned` where that is from `to` to `from`.
struct TriangleEdge {
  PendingRoot root{};
  bool turned = false;
};

TriangleEdge edge_of(const LimitTracer& tracer, const LimitTriangle& triangle, int from, int to, int kind) {
  struct Node {
    std::uint32_t side;
    glm::dvec2 uv;
  };
  Node a{side_towards(triangle, from, to), triangle.corners[static_cast<size_t>(from)].uv()},
      b{side_towards(triangle, to, from), triangle.corners[static_cast<size_t>(to)].uv()};
  const bool turned = a.side > b.side;
  if (turned) std::swap(a, b);
  const double level = kind == 0 ? tracer.level.threshold : 0.0;
  return {{root_key(a.side, b.side, kind), triangle.patch, a.uv, b.uv, tracer.facing[a.side] - level, tracer.facing[b.side] - level, level},
          turned};
}

double root_of(const LimitTracer& tracer, const PendingRoot& root) {
  return root_between(tracer.placed, tracer.camera, root.patch, root.uv0, root.uv1, root.h0, root.h1, root.level);
}

/// What `cross_triangle` needs, from many threads at once.
void find_roots(LimitTracer& tracer) {
  std::vector<double> places(tracer.pending.size());
  parallel_parts(places.size(), size_t{16}, [&](const IndexRange<size_t>& range) {
    for (size_t i = range.begin(); i < range.end(); ++i) places[i] = root_of(tracer, tracer.pending[i]);
  });
  for (size_t i = 0; i < places.size(); ++i) tracer.roots[tracer.pending[i].key] = places[i];
  tracer.pending.clear();
}

}  // namespace

double root_on(LimitTracer& tracer, const LimitTriangle& triangle, int from, int to, int kind) {
  const TriangleEdge edge = edge_of(tracer, triangle, from, to, kind);
  const auto [entry, added] = tracer.roots.try_emplace(edge.root.key, 0.0);
  if (added) entry->second = root_of(tracer, edge.root);
  return edge.turned ? 1.0 - entry->second : entry->second;
}

LimitEnd end_on(LimitTracer& tracer, const LimitTriangle& triangle, int from, int to, int kind) {
  const LimitCorner &a = triangle.corners[static_cast<size_t>(from)], &b = triangle.corners[static_cast<size_t>(to)];
  const double t = root_on(tracer, triangle, from, to, kind);
  return {root_key(side_towards(triangle, from, to), side_towards(triangle, to, from), kind), triangle.patch, glm::mix(a.uv(), b.uv(), t)};
}

double facing_at(const PlacedLimitSurface& placed, const Camera& camera, std::uint32_t patch, const glm::dvec2& uv) {
  const LimitSample s = sample(placed, patch, uv);
  return glm::dot(s.normal, view_vector(camera, s.position));
}

// The Illinois method (Dowell & Jarratt 1971): false position that halves the weight of an end which stays. The secant through the last two
// places says how far the root is.
double root_between(const PlacedLimitSurface& placed, const Camera& camera, std::uint32_t patch, const glm::dvec2& uv0,
                    const glm::dvec2& uv1, double h0, double h1, double level) {
  double low = 0.0, high = 1.0, last_t = 0.0, last = h0;
  int last_side = 0;
  for (int step = 0; step < kRootSteps && high - low > kRootPlace; ++step) {
    double t = h0 == h1 ? 0.5 * (low + high) : low + (high - low) * h0 / (h0 - h1);
    if (!(t > low && t < high)) t = 0.5 * (low + high);
    const double value = facing_at(placed, camera, patch, glm::mix(uv0, uv1, t)) - level, slope = (value - last) / (t - last_t);
    const bool is_low = (value < 0.0) == (h0 < 0.0);
    if (std::abs(value) < kRootPlace * std::abs(slope)) return std::clamp(t - value / slope, is_low ? t : low, is_low ? high : t);
    const int side = is_low ? -1 : 1;
    if (is_low) {
      low = t;
      h0 = value;
      if (last_side == side) h1 *= 0.5;
    } else {
      high = t;
      h1 = value;
      if (last_side == side) h0 *= 0.5;
    }
    last_side = side;
    last_t = t;
    last = value;
  }
  return 0.5 * (low + high);
}

namespace {

/// Once around the triangle, along its edges and, at tips of cones, from one way there to the other: where h falls below 0 and where it
/// rises again a curve goes through. `end_at` makes the end on an edge from a corner to the next.
struct TriangleCrossing {
  std::optional<LimitEnd> falls{}, rises{};
  size_t above = 0;
};
template <class EndAt>
TriangleCrossing crossing_of(const LimitTracer& tracer, const LimitTriangle& triangle, const EndAt& end_at) {
  TriangleCrossing crossing;
  const auto pass = [&](double before, double after, const auto& end) {
    if ((before >= 0.0) == (after >= 0.0)) return;
    (before >= 0.0 ? crossing.falls : crossing.rises) = end();
  };
  for (int i = 0; i < 3; ++i) {
    const auto at = static_cast<size_t>(i);
    const int next = (i + 1) % 3;
    const double back = tracer.h(triangle.corners[at].side_back), away = tracer.h(triangle.corners[at].side);
    if (std::max(back, away) >= 0.0) crossing.above = at;
    if (triangle.corners[at].side_back != triangle.corners[at].side) pass(back, away, [&] { return tip_end(triangle, at); });
    pass(away, tracer.h(triangle.corners[static_cast<size_t>(next)].side_back), [&] { return end_at(i, next); });
  }
  return crossing;
}

/// The roots that the triangle's ends want; whoever asks first says from which patch.
bool ask_for_roots(LimitTracer& tracer, const LimitTriangle& triangle) {
  const TriangleCrossing crossing = crossing_of(tracer, triangle, [&](int from, int to) {
    const TriangleEdge edge = edge_of(tracer, triangle, from, to, 0);
    if (tracer.roots.try_emplace(edge.root.key, 0.0).second) tracer.pending.push_back(edge.root);
    return LimitEnd{};
  });
  return crossing.falls && crossing.rises;
}

void cross_triangle(LimitTracer& tracer, const LimitTriangle& triangle) {
  const auto [falls, rises, above] = crossing_of(tracer, triangle, [&](int from, int to) { return end_on(tracer, triangle, from, to, 0); });
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

/// Whether N.V may cross the level somewhere in the block: the angle between normal and view is that between the cone's axis and the way
/// from the ball's middle to the eye, but for the cone's width and how wide the ball is seen.
bool may_cross(const LimitBlock& block, const Camera& camera, double threshold) {
  if (threshold == 0.0 && camera.projection == Projection::perspective && block.cosine > 0.0) {
    const glm::dvec3 to_eye = camera.eye - block.center;
    const double squared = glm::dot(to_eye, to_eye), seen = block.radius * block.radius;
    if (!(squared > seen * (1.0 + kWidthSlack))) return true;
    // cos(angle) < sin(width), times the distance: the sine of the sum of the cone's width and the ball's.
    const double sine = block.sine * std::sqrt(squared - seen) + block.cosine * block.radius;
    const bool narrow = block.cosine * std::sqrt(squared - seen) > block.sine * block.radius;  // the sum is less than a right angle
    return !narrow || !(std::abs(glm::dot(block.axis, to_eye)) > sine + kWidthSlack * std::sqrt(squared));
  }
  double width = block.angle, cosine = glm::dot(block.axis, camera.world_from_camera[2]);
  if (camera.projection == Projection::perspective) {
    const glm::dvec3 to_eye = camera.eye - block.center;
    const double distance = glm::length(to_eye);
    if (!(distance > block.radius * (1.0 + kWidthSlack))) return true;
    cosine = glm::dot(block.axis, to_eye) / distance;
    width += std::asin(block.radius / distance) + kWidthSlack;
  }
  return !(std::abs(std::acos(std::clamp(cosine, -1.0, 1.0)) - std::acos(threshold)) > width + kWidthSlack);
}

/// Marks the triangles in which h may change its sign, and fills in N.V of their sides; of all sides where seams are followed.
std::vector<std::uint32_t> triangles_to_cross(LimitTracer& tracer) {
  const LimitGrid& grid = tracer.grid;
  const auto facing_of = [&](std::uint32_t side) {
    return glm::dot(grid.normals[side], view_vector(tracer.camera, grid.positions[grid.node_of_side[side]]));
  };
  tracer.facing = std::make_unique_for_overwrite<double[]>(grid.normals.size());
  std::vector<bool> known(grid.normals.size(), tracer.level.seams);
  if (tracer.level.seams) {
    parallel_parts(grid.normals.size(), size_t{4096}, [&](const IndexRange<size_t>& range) {
      for (size_t s = range.begin(); s < range.end(); ++s) tracer.facing[s] = facing_of(static_cast<std::uint32_t>(s));
    });
  }
  std::vector<char> may(grid.blocks.size(), 0);
  parallel_parts(may.size(), size_t{1024}, [&](const IndexRange<size_t>& range) {
    for (size_t b = range.begin(); b < range.end(); ++b) may[b] = may_cross(grid.blocks[b], tracer.camera, tracer.level.threshold);
  });
  std::vector<std::uint32_t> triangles;
  for (size_t b = 0; b < may.size(); ++b) {
    if (may[b] == 0) continue;
    for_triangles(grid, grid.blocks[b].first, grid.blocks[b].end, [&](std::uint32_t t, const LimitTriangle& triangle) {
      for (const LimitCorner& corner : triangle.corners) {
        for (const std::uint32_t side : {corner.side, corner.side_back}) {
          if (!known[side]) tracer.facing[side] = facing_of(side);
          known[side] = true;
        }
      }
      if (ask_for_roots(tracer, triangle)) triangles.push_back(t);
    });
  }
  return triangles;
}

}  // namespace

std::vector<LimitSegment> limit_segments(const PlacedLimitSurface& placed, const LimitGrid& grid, const Camera& camera,
                                         const LimitLevel& level) {
  LimitTracer tracer{placed, grid, camera, level, glm::determinant(placed.world_from_cage.linear) < 0.0};
  const std::vector<std::uint32_t> triangles = triangles_to_cross(tracer);
  find_roots(tracer);
  for (const std::uint32_t t : triangles) cross_triangle(tracer, triangle_of(grid, t));
  if (level.seams) cross_seams(tracer);
  return std::move(tracer.segments);
}

}  // namespace limn
