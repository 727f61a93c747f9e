// What is seen where sheets of a limit surface end or meet: at creases, open edges, and edges with more than two faces.

#include <algorithm>
#include <cmath>

#include "raymarch/truth/limit_tracer.h"

namespace limn {
namespace {

/// A sheet that ends on a seam: its corners at the edge's two nodes, in the order of the first use.
struct CreaseSide {
  LimitTriangle triangle{};
  int from = 0, to = 0;
  double f0 = 0.0, f1 = 0.0;  ///< N.V at the nodes.
  glm::dvec3 third{0.0};
  bool on_left = false;  ///< Of the way from the first node to the second, seen from the side of its normal.
};

CreaseSide crease_side(const LimitTracer& tracer, const SeamUse& use, std::uint32_t first_node) {
  CreaseSide side;
  side.triangle = triangle_of(tracer.grid, use.triangle);
  side.from = use.from;
  side.to = (use.from + 1) % 3;
  if (side.triangle.corners[static_cast<size_t>(side.from)].node != first_node) std::swap(side.from, side.to);
  side.on_left = (side.from == use.from) != tracer.mirrored;
  side.f0 = tracer.facing[side_towards(side.triangle, side.from, side.to)];
  side.f1 = tracer.facing[side_towards(side.triangle, side.to, side.from)];
  side.third = tracer.grid.positions[side.triangle.corners[static_cast<size_t>((use.from + 2) % 3)].node];
  return side;
}

/// The surface on a side of the seam, at the share t of the way between its nodes: what lies between is not what lies at them where normals
/// turn fast, as beside a sharp corner.
struct SideSample {
  glm::dvec3 normal{0.0};
  double facing = 0.0;  ///< N.V.
};

SideSample sample_side(const LimitTracer& tracer, const CreaseSide& side, double t) {
  const auto corner = [&](int i) { return side.triangle.corners[static_cast<size_t>(i)]; };
  const LimitSample s = sample(tracer.placed, side.triangle.patch, glm::mix(corner(side.from).uv(), corner(side.to).uv(), t));
  if (s.valid) return {s.normal, glm::dot(s.normal, view_vector(tracer.camera, s.position))};
  return {tracer.grid.normals[side_towards(side.triangle, side.from, side.to)], side.f0 + t * (side.f1 - side.f0)};
}

struct Break {
  double t = 0.0;
  LimitEnd end;
};

void add_breaks(LimitTracer& tracer, const CreaseSide& side, std::vector<Break>& breaks) {
  const double c = tracer.level.threshold;
  const auto add = [&](double level, int kind) {
    if ((side.f0 - level >= 0.0) == (side.f1 - level >= 0.0)) return;
    breaks.push_back({root_on(tracer, side.triangle, side.from, side.to, kind), end_on(tracer, side.triangle, side.from, side.to, kind)});
  };
  add(c, 0);
  if (c > 0.0) add(0.0, 1);
}

/// Where one side lies above the threshold and the other below. A side that turns away altogether is no ink that anybody sees beside it:
/// there the edge is a silhouette and no inner border.
bool is_on(const LimitTracer& tracer, double facing1, double facing2) {
  const double c = tracer.level.threshold, low = std::min(facing1, facing2), high = std::max(facing1, facing2);
  return high >= c && low < c && (c == 0.0 || low >= 0.0);
}

/// The seam's ends, and where any of its sheets turns from the one side of the threshold to the other.
std::vector<Break> breaks_of(LimitTracer& tracer, const std::vector<CreaseSide>& sides) {
  const CreaseSide& one = sides.front();
  const auto corner = [&](int i) { return one.triangle.corners[static_cast<size_t>(i)]; };
  const auto node_end = [&](int i) { return LimitEnd{{corner(i).node, 0, 2}, one.triangle.patch, corner(i).uv()}; };
  std::vector<Break> breaks{{0.0, node_end(one.from)}};
  for (const CreaseSide& side : sides) add_breaks(tracer, side, breaks);
  breaks.push_back({1.0, node_end(one.to)});
  std::sort(breaks.begin(), breaks.end(), [](const Break& a, const Break& b) { return a.t < b.t; });
  return breaks;
}

/// Between two breaks, both ends in one patch, so that places between them can be asked for.
LimitSegment piece_of(const LimitTracer& tracer, const CreaseSide& one, const Break& first, const Break& second) {
  const LimitCorner &from = one.triangle.corners[static_cast<size_t>(one.from)], &to = one.triangle.corners[static_cast<size_t>(one.to)];
  LimitSegment segment;
  segment.crease = true;
  segment.beside_is_bounded = true;
  segment.along = tracer.grid.positions[to.node] - tracer.grid.positions[from.node];
  const Break* ends[2] = {&first, &second};
  for (size_t e = 0; e < 2; ++e) segment.ends[e] = {ends[e]->end.key, one.triangle.patch, glm::mix(from.uv(), to.uv(), ends[e]->t)};
  return segment;
}

void follow_crease(LimitTracer& tracer, const CreaseSide& one, const CreaseSide& two) {
  const std::vector<Break> breaks = breaks_of(tracer, {one, two});
  for (size_t k = 0; k + 1 < breaks.size(); ++k) {
    const double middle = 0.5 * (breaks[k].t + breaks[k + 1].t);
    const SideSample at_one = sample_side(tracer, one, middle), at_two = sample_side(tracer, two, middle);
    if (glm::distance(at_one.normal, at_two.normal) < kSameLimitNormal || !is_on(tracer, at_one.facing, at_two.facing)) continue;
    const bool one_high = at_one.facing >= at_two.facing;
    const CreaseSide &high = one_high ? one : two, &low = one_high ? two : one;
    const CreaseSide& covered = tracer.level.kind == CurveKind::silhouette ? high : low;
    LimitSegment segment = piece_of(tracer, one, breaks[k], breaks[k + 1]);
    segment.beside = covered.third;
    segment.left = covered.on_left;
    segment.high_normal = one_high ? at_one.normal : at_two.normal;
    segment.low_normal = one_high ? at_two.normal : at_one.normal;
    tracer.segments.push_back(segment);
  }
}

/// A sheet at a place of the seam, as the picture has it: it covers the left or the right of the seam.
struct Seen {
  const CreaseSide* side = nullptr;
  glm::dvec3 normal{0.0};
  double facing = 0.0;
  bool left = false;
  double nearness = 0.0;  ///< How much nearer to the eye it gets with each unit that it covers.
};

std::vector<Seen> seen_at(const LimitTracer& tracer, const std::vector<CreaseSide>& sides, const LimitSegment& piece, double t) {
  const CreaseSide& one = sides.front();
  const auto node = [&](int i) { return tracer.grid.positions[one.triangle.corners[static_cast<size_t>(i)].node]; };
  const glm::dvec3 v = view_vector(tracer.camera, glm::mix(node(one.from), node(one.to), t)), to_left = glm::cross(v, piece.along);
  std::vector<Seen> seen;
  for (const CreaseSide& side : sides) {
    const SideSample here = sample_side(tracer, side, t);
    Seen sheet{&side, here.normal, here.facing};
    sheet.left = side.on_left == (sheet.facing >= 0.0);
    sheet.nearness = -glm::dot(sheet.left ? to_left : -to_left, sheet.normal) / glm::dot(v, sheet.normal);
    seen.push_back(sheet);
  }
  return seen;
}

const Seen* nearest(const std::vector<Seen>& seen, bool left) {
  const Seen* best = nullptr;
  for (const Seen& sheet : seen)
    if (sheet.left == left && (best == nullptr || sheet.nearness > best->nearness)) best = &sheet;
  return best;
}

/// An open edge, sheets that disagree on the outside, or three and more at one edge: where all of them lie on one side of it in the picture
/// the surface ends there; where the nearest on both sides differ in ink, an inner border runs along it.
void follow_junction(LimitTracer& tracer, const std::vector<CreaseSide>& sides) {
  const std::vector<Break> breaks = breaks_of(tracer, sides);
  const bool silhouette = tracer.level.kind == CurveKind::silhouette;
  for (size_t k = 0; k + 1 < breaks.size(); ++k) {
    LimitSegment segment = piece_of(tracer, sides.front(), breaks[k], breaks[k + 1]);
    const std::vector<Seen> seen = seen_at(tracer, sides, segment, 0.5 * (breaks[k].t + breaks[k + 1].t));
    const Seen *left = nearest(seen, true), *right = nearest(seen, false);
    const auto is_ink = [&](const Seen& sheet) {
      return (tracer.level.turn == LimitTurn::none ? sheet.facing : std::abs(sheet.facing)) < tracer.level.threshold;
    };
    const bool ends = left == nullptr || right == nullptr;
    if (silhouette != ends || (!silhouette && is_ink(*left) == is_ink(*right))) continue;
    segment.left = ends ? left != nullptr : is_ink(*left);
    const Seen &bounded = segment.left ? *left : *right, &other = ends ? bounded : segment.left ? *right : *left;
    const auto towards_eye = [&](const Seen& sheet) { return sheet.normal * (sheet.facing < 0.0 ? -1.0 : 1.0); };
    segment.beside = bounded.side->third;
    segment.low_normal = towards_eye(bounded);
    segment.high_normal = towards_eye(other);
    tracer.segments.push_back(segment);
  }
}

}  // namespace

void cross_seams(LimitTracer& tracer) {
  for (const LimitSeam& seam : tracer.grid.seams) {
    std::vector<CreaseSide> sides;
    for (const SeamUse& use : uses_of(tracer.grid, seam)) sides.push_back(crease_side(tracer, use, seam.nodes.first));
    if (sides.size() != 2 || sides[0].on_left == sides[1].on_left) {
      if (tracer.level.turn != LimitTurn::back) follow_junction(tracer, sides);
      continue;
    }
    const auto from = [](const CreaseSide& s) { return side_towards(s.triangle, s.from, s.to); };
    const auto to = [](const CreaseSide& s) { return side_towards(s.triangle, s.to, s.from); };
    if (from(sides[0]) == from(sides[1]) && to(sides[0]) == to(sides[1])) continue;
    follow_crease(tracer, sides[0], sides[1]);
  }
}

}  // namespace limn
