// Segments joined to polylines, and polylines made as fine as the tolerance wants.

#include "raymarch/truth/limit_curves.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "raymarch/truth/limit_segments.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr std::uint32_t kNone = 0xffffffffu;
constexpr int kRefinements = 8;
constexpr double kBesideTip = 1e-3;  // of a segment
constexpr double kSameLift = 0.9;    // the cosine between ways off the surface

/// What is traced, and its pieces.
struct Shape {
  const PlacedLimitSurface& placed;
  const Camera& camera;
  const LimitCurveSettings& settings;
  bool sheet = false;
  std::vector<LimitSegment> segments;
};

glm::dvec2 outward_at(const Shape& shape, const LimitSegment& segment, const TracedPoint& point) {
  const glm::dvec2 towards = glm::dvec2(project(shape.camera, segment.beside)) - point.px;
  if (segment.crease) return segment.beside_is_bounded ? -towards : towards;
  if (shape.settings.kind == CurveKind::inner) return towards;
  const glm::dmat3& axes = shape.camera.world_from_camera;
  const glm::dvec2 n(glm::dot(point.high, axes[0]), -glm::dot(point.high, axes[1]));
  return point.radial_curvature < 0.0 ? -n : n;
}

TracedPoint point_at(const Shape& shape, const LimitSegment& segment, std::uint32_t patch, const glm::dvec2& uv) {
  CurvedLimitSample curved;
  if (segment.crease) {
    curved.at = sample(shape.placed, patch, uv);
  } else {
    curved = curved_sample(shape.placed, patch, uv);
  }
  const LimitSample& s = curved.at;
  const glm::dvec3 image = project(shape.camera, s.position), v = view_vector(shape.camera, s.position);
  TracedPoint point;
  point.p = s.position;
  point.px = glm::dvec2(image);
  point.depth = image.z;
  point.crease = segment.crease;
  point.high = segment.crease ? segment.high_normal : s.normal;
  point.low = segment.crease ? segment.low_normal : s.normal;
  if (!segment.crease) point.radial_curvature = curvature_along(curved.curvature, v - glm::dot(v, s.normal) * s.normal);
  // A fold that bends towards its normal is seen, if at all, from the surface's other side.
  point.lift = shape.settings.kind == CurveKind::inner ? v : point.radial_curvature < 0.0 ? -point.high : point.high;
  // Where the back of a sheet is nearer than its front, neither of its normals leads away from it.
  if (shape.sheet && segment.crease && shape.settings.kind == CurveKind::silhouette)
    point.lift = glm::normalize(glm::cross(v, segment.left ? -segment.along : segment.along));
  point.outward = outward_at(shape, segment, point);
  return point;
}

/// A curve that leads to the tip of a cone has there the normal that it has a little before.
TracedPoint end_point(const Shape& shape, const LimitSegment& segment, const LimitEnd& end, const LimitEnd& other) {
  TracedPoint point = point_at(shape, segment, end.patch, end.uv);
  if (segment.crease || end.key.kind != 2) return point;
  const TracedPoint before = point_at(shape, segment, end.patch, glm::mix(end.uv, other.uv, kBesideTip));
  point.high = before.high;
  point.low = before.low;
  point.radial_curvature = before.radial_curvature;
  point.lift = before.lift;
  point.outward = before.outward;
  return point;
}

/// The place of the curve beside the middle of two others, in their patch; the middle itself on a crease.
glm::dvec2 middle_of(const Shape& shape, const LimitSegment& segment, std::uint32_t patch, const glm::dvec2& a, const glm::dvec2& b) {
  const glm::dvec2 middle = 0.5 * (a + b), along = b - a, across(-0.5 * along.y, 0.5 * along.x);
  if (segment.crease) return middle;
  const auto clamped = [&](glm::dvec2 p) {
    p = glm::clamp(p, glm::dvec2(0.0), glm::dvec2(1.0));
    const double excess = p.x + p.y - 1.0;
    return shape.placed.patches[patch].triangle && excess > 0.0 ? p - 0.5 * excess : p;
  };
  const glm::dvec2 p0 = clamped(middle - across), p1 = clamped(middle + across);
  const double c = shape.settings.threshold;
  const double h0 = facing_at(shape.placed, shape.camera, patch, p0) - c, h1 = facing_at(shape.placed, shape.camera, patch, p1) - c;
  if ((h0 < 0.0) == (h1 < 0.0)) return middle;
  return glm::mix(p0, p1, root_between(shape.placed, shape.camera, patch, p0, p1, h0, h1, c));
}

struct Place {
  glm::dvec2 uv;
  TracedPoint point;
};

void refine(const Shape& shape, const LimitSegment& segment, const Place& a, const Place& b, int depth, std::vector<Place>& out) {
  const std::uint32_t patch = segment.ends[0].patch;
  Place middle{middle_of(shape, segment, patch, a.uv, b.uv), {}};
  middle.point = point_at(shape, segment, patch, middle.uv);
  const glm::dvec2 chord = b.point.px - a.point.px;
  const double length = glm::length(chord);
  const glm::dvec2 offset = middle.point.px - 0.5 * (a.point.px + b.point.px);
  const double deviation = length > 0.0 ? std::abs(chord.x * offset.y - chord.y * offset.x) / length : glm::length(offset);
  if (depth == 0 || deviation < shape.settings.tolerance_px) {
    if (deviation > 0.1 * shape.settings.tolerance_px) out.push_back(middle);
    return;
  }
  refine(shape, segment, a, middle, depth - 1, out);
  out.push_back(middle);
  refine(shape, segment, middle, b, depth - 1, out);
}

/// Where a crease goes over into a contour, or turns a corner, both sides have a point: no step is half the one and half the other, and
/// each side is looked at from its own place off the surface.
bool are_one(const TracedPoint& end, const TracedPoint& beginning) {
  return end.crease == beginning.crease && glm::dot(end.lift, beginning.lift) > kSameLift;
}

/// A segment of a chain, which may run along it backwards.
struct ChainSegment {
  std::uint32_t segment = 0;
  bool turned = false;
};
struct SegmentChain {
  bool closed = false, left = true;
  std::vector<ChainSegment> segments{};
};

/// From the one end to the other.
std::vector<TracedPoint> points_along(const Shape& shape, const ChainSegment& link) {
  const LimitSegment& segment = shape.segments[link.segment];
  const LimitEnd &first = segment.ends[link.turned ? 1 : 0], &last = segment.ends[link.turned ? 0 : 1];
  const auto place_of = [&](const LimitEnd& at, const LimitEnd& other) { return Place{at.uv, end_point(shape, segment, at, other)}; };
  std::vector<Place> places{place_of(first, last)};
  const Place end = place_of(last, first);
  refine(shape, segment, places.front(), end, kRefinements, places);
  places.push_back(end);
  std::vector<TracedPoint> points;
  points.reserve(places.size());
  for (const Place& place : places) points.push_back(place.point);
  return points;
}

TracedCurve curve_of(const Shape& shape, const SegmentChain& chain, const std::vector<TracedPoint>* points) {
  TracedCurve curve;
  curve.kind = shape.settings.kind;
  curve.object = shape.settings.object;
  curve.sheet = shape.sheet;
  curve.closed = chain.closed;
  for (size_t i = 0; i < chain.segments.size(); ++i) {
    if (!curve.points.empty() && are_one(curve.points.back(), points[i].front())) curve.points.pop_back();
    curve.points.insert(curve.points.end(), points[i].begin(), points[i].end());
  }
  if (curve.closed && are_one(curve.points.back(), curve.points.front())) curve.points.pop_back();
  if (shape.sheet && !chain.left) std::reverse(curve.points.begin(), curve.points.end());
  return curve;
}

/// The segments of all chains are refined each on its own.
std::vector<TracedCurve> curves_of(const Shape& shape, const std::vector<SegmentChain>& chains) {
  std::vector<ChainSegment> all;
  for (const SegmentChain& chain : chains) all.insert(all.end(), chain.segments.begin(), chain.segments.end());
  std::vector<std::vector<TracedPoint>> points(all.size());
  parallel_parts(all.size(), size_t{8}, [&](const IndexRange<size_t>& range) {
    for (size_t i = range.begin(); i < range.end(); ++i) points[i] = points_along(shape, all[i]);
  });
  std::vector<TracedCurve> curves;
  size_t first = 0;
  for (const SegmentChain& chain : chains) {
    curves.push_back(curve_of(shape, chain, points.data() + first));
    first += chain.segments.size();
  }
  return curves;
}

struct Graph {
  std::map<LimitEndKey, std::vector<std::uint32_t>> at_end;
  std::vector<char> used;
};

bool starts_at(const LimitSegment& segment, const LimitEndKey& key) { return segment.ends[0].key == key; }

/// A sheet's curves end where three and more meet, and where what one bounds changes sides, as an open edge does where front becomes back:
/// past such places a chain has what it bounds on the one side here and on the other there.
bool ends_chain(const Shape& shape, const std::vector<std::uint32_t>& here, const LimitEndKey& key) {
  if (!shape.sheet) return here.size() % 2 != 0;
  if (here.size() != 2) return true;
  const LimitSegment &a = shape.segments[here[0]], &b = shape.segments[here[1]];
  return (starts_at(a, key) == a.left) == (starts_at(b, key) == b.left);
}

std::uint32_t next_segment(const Shape& shape, const Graph& graph, const LimitEndKey& key) {
  const std::vector<std::uint32_t>& here = graph.at_end.at(key);
  if (shape.sheet && ends_chain(shape, here, key)) return kNone;
  for (const std::uint32_t s : here) {
    if (!graph.used[s]) return s;
  }
  return kNone;
}

SegmentChain walk(const Shape& shape, Graph& graph, std::uint32_t start, const LimitEndKey& from) {
  SegmentChain chain;
  chain.left = starts_at(shape.segments[start], from) == shape.segments[start].left;
  LimitEndKey key = from;
  for (std::uint32_t s = start; s != kNone;) {
    graph.used[s] = 1;
    const LimitSegment& segment = shape.segments[s];
    const bool turned = !starts_at(segment, key);
    key = segment.ends[turned ? 0 : 1].key;
    chain.segments.push_back({s, turned});
    chain.closed = key == from;
    s = chain.closed ? kNone : next_segment(shape, graph, key);
  }
  return chain;
}

std::vector<SegmentChain> chained(const Shape& shape) {
  Graph graph;
  graph.used.assign(shape.segments.size(), 0);
  for (std::uint32_t s = 0; s < shape.segments.size(); ++s) {
    for (const LimitEnd& end : shape.segments[s].ends) graph.at_end[end.key].push_back(s);
  }
  std::vector<SegmentChain> chains;
  for (const auto& [key, here] : graph.at_end) {
    if (!ends_chain(shape, here, key)) continue;
    for (const std::uint32_t s : here) {
      if (graph.used[s]) continue;
      chains.push_back(walk(shape, graph, s, key));
      if (!shape.sheet) break;
    }
  }
  for (std::uint32_t s = 0; s < shape.segments.size(); ++s) {
    if (!graph.used[s]) chains.push_back(walk(shape, graph, s, shape.segments[s].ends[0].key));
  }
  return chains;
}

}  // namespace

std::vector<TracedCurve> trace_limit_curves(const PlacedLimitSurface& placed, const LimitGrid& grid, const Camera& camera,
                                            const LimitCurveSettings& settings) {
  const LimitLevel level{settings.kind, settings.threshold, settings.turn, settings.seams};
  const Shape shape{placed, camera, settings, grid.sheet, limit_segments(placed, grid, camera, level)};
  return curves_of(shape, chained(shape));
}

}  // namespace limn
