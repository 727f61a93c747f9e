// The sign of h = N.V - c at the corners of a triangulated sheet says which of its edges a curve crosses; along an edge of one side the
// crossing is a root of h, along a crease the curve follows the edge where the signs of its two sides differ. What is crossed is known by
// the sides at both ends, so that segments of neighbouring triangles join without any search.

#include "raymarch/truth/limit_segments.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace limn {
namespace {

constexpr int kRootSteps = 40;

struct Tracer {
  const PlacedLimitSurface& placed;
  const LimitGrid& grid;
  const Camera& camera;
  CurveKind kind;
  double threshold;
  std::vector<double> facing{};  ///< N.V of each side.
  std::vector<LimitSegment> segments{};
  std::map<LimitEndKey, double> roots{};  ///< Place of each root along its edge, from the smaller side to the greater.

  double h(std::uint32_t side) const { return facing[side] - threshold; }
};

/// The root on an edge, found once, by whoever asks first: all who share it then agree.
double root_on(Tracer& tracer, const LimitTriangle& triangle, int from, int to, int kind) {
  LimitCorner a = triangle.corners[static_cast<size_t>(from)], b = triangle.corners[static_cast<size_t>(to)];
  const bool turned = a.side > b.side;
  if (turned) std::swap(a, b);
  const double level = kind == 0 ? tracer.threshold : 0.0;
  const auto [entry, added] = tracer.roots.try_emplace(root_key(a.side, b.side, kind), 0.0);
  if (added)
    entry->second = root_between(tracer.placed, tracer.camera, triangle.patch, a.uv, b.uv, tracer.facing[a.side] - level,
                                 tracer.facing[b.side] - level, level);
  return turned ? 1.0 - entry->second : entry->second;
}

LimitEnd end_on(Tracer& tracer, const LimitTriangle& triangle, int from, int to, int kind) {
  const LimitCorner &a = triangle.corners[static_cast<size_t>(from)], &b = triangle.corners[static_cast<size_t>(to)];
  const double t = root_on(tracer, triangle, from, to, kind);
  return {root_key(a.side, b.side, kind), triangle.patch, glm::mix(a.uv, b.uv, t)};
}

void cross_triangle(Tracer& tracer, const LimitTriangle& triangle) {
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
  tracer.segments.push_back(segment);
}

/// A triangle's edge on a seam between patches.
struct SeamUse {
  std::uint32_t triangle = 0;
  int from = 0;  ///< The edge runs from this corner to the next.
};
using Seams = std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<SeamUse>>;

/// Patch sides only: inside a patch no two triangles can disagree.
Seams seams_of(const LimitGrid& grid, const PlacedLimitSurface& placed) {
  const auto on_side = [](const LimitPatch& patch, const glm::dvec2& a, const glm::dvec2& b) {
    const auto both = [&](auto&& test) { return test(a) && test(b); };
    if (both([](const glm::dvec2& p) { return p.x == 0.0; }) || both([](const glm::dvec2& p) { return p.y == 0.0; })) return true;
    if (patch.triangle) return both([](const glm::dvec2& p) { return p.x + p.y > 1.0 - 1e-9; });
    return both([](const glm::dvec2& p) { return p.x == 1.0; }) || both([](const glm::dvec2& p) { return p.y == 1.0; });
  };
  Seams seams;
  for (std::uint32_t t = 0; t < grid.triangles.size(); ++t) {
    const LimitTriangle& triangle = grid.triangles[t];
    for (int from = 0; from < 3; ++from) {
      const LimitCorner &a = triangle.corners[static_cast<size_t>(from)], &b = triangle.corners[static_cast<size_t>((from + 1) % 3)];
      if (a.node == b.node || !on_side(placed.patches[triangle.patch], a.uv, b.uv)) continue;
      seams[std::minmax(a.node, b.node)].push_back({t, from});
    }
  }
  return seams;
}

/// One side of a crease: its corners at the edge's two nodes, in the order of the first use.
struct CreaseSide {
  const LimitTriangle* triangle = nullptr;
  int from = 0, to = 0;
  double f0 = 0.0, f1 = 0.0;  ///< N.V.
  glm::dvec3 third{0.0};
  double at(double t) const { return f0 + t * (f1 - f0); }
};

CreaseSide crease_side(const Tracer& tracer, const SeamUse& use, std::uint32_t first_node) {
  CreaseSide side;
  side.triangle = &tracer.grid.triangles[use.triangle];
  side.from = use.from;
  side.to = (use.from + 1) % 3;
  if (side.triangle->corners[static_cast<size_t>(side.from)].node != first_node) std::swap(side.from, side.to);
  side.f0 = tracer.facing[side.triangle->corners[static_cast<size_t>(side.from)].side];
  side.f1 = tracer.facing[side.triangle->corners[static_cast<size_t>(side.to)].side];
  side.third = tracer.grid.positions[side.triangle->corners[static_cast<size_t>((use.from + 2) % 3)].node];
  return side;
}

struct Break {
  double t = 0.0;
  LimitEnd end;
};

void add_breaks(Tracer& tracer, const CreaseSide& side, std::vector<Break>& breaks) {
  const double c = tracer.threshold;
  const auto add = [&](double level, int kind) {
    if ((side.f0 - level >= 0.0) == (side.f1 - level >= 0.0)) return;
    breaks.push_back({root_on(tracer, *side.triangle, side.from, side.to, kind), end_on(tracer, *side.triangle, side.from, side.to, kind)});
  };
  add(c, 0);
  if (c > 0.0) add(0.0, 1);
}

/// Where one side lies above the threshold and the other below. A side that turns away altogether is no ink that anybody sees beside it:
/// there the edge is a silhouette and no inner border.
bool is_on(const Tracer& tracer, double facing1, double facing2) {
  const double c = tracer.threshold, low = std::min(facing1, facing2), high = std::max(facing1, facing2);
  return high >= c && low < c && (c == 0.0 || low >= 0.0);
}

void follow_crease(Tracer& tracer, const CreaseSide& one, const CreaseSide& two) {
  std::vector<Break> breaks;
  const auto corner = [&](int i) { return one.triangle->corners[static_cast<size_t>(i)]; };
  const auto node_end = [&](int i) { return LimitEnd{{corner(i).node, 0, 2}, one.triangle->patch, corner(i).uv}; };
  breaks.push_back({0.0, node_end(one.from)});
  add_breaks(tracer, one, breaks);
  add_breaks(tracer, two, breaks);
  breaks.push_back({1.0, node_end(one.to)});
  std::sort(breaks.begin(), breaks.end(), [](const Break& a, const Break& b) { return a.t < b.t; });
  for (size_t k = 0; k + 1 < breaks.size(); ++k) {
    const double middle = 0.5 * (breaks[k].t + breaks[k + 1].t);
    if (!is_on(tracer, one.at(middle), two.at(middle))) continue;
    const CreaseSide& high = one.at(middle) >= two.at(middle) ? one : two;
    const CreaseSide& low = &high == &one ? two : one;
    const CreaseSide& covered = tracer.kind == CurveKind::silhouette ? high : low;
    LimitSegment segment;
    segment.crease = true;
    segment.beside_is_bounded = true;
    segment.beside = covered.third;
    const auto normal = [&](const CreaseSide& side) {
      return tracer.grid.normals[side.triangle->corners[static_cast<size_t>(side.from)].side];
    };
    segment.high_normal = normal(high);
    segment.low_normal = normal(low);
    for (size_t e = 0; e < 2; ++e) {
      segment.ends[e] = breaks[k + e].end;
      // Both ends in one patch, so that places between them can be asked for.
      segment.ends[e].patch = one.triangle->patch;
      segment.ends[e].uv = glm::mix(corner(one.from).uv, corner(one.to).uv, breaks[k + e].t);
    }
    tracer.segments.push_back(segment);
  }
}

void add_open_edge(Tracer& tracer, const CreaseSide& side) {
  LimitSegment segment;
  segment.crease = true;
  segment.beside_is_bounded = true;
  segment.beside = side.third;
  const LimitCorner &a = side.triangle->corners[static_cast<size_t>(side.from)], &b = side.triangle->corners[static_cast<size_t>(side.to)];
  segment.high_normal = segment.low_normal = tracer.grid.normals[a.side] * (side.f0 < 0.0 ? -1.0 : 1.0);
  segment.ends[0] = {{a.node, 0, 2}, side.triangle->patch, a.uv};
  segment.ends[1] = {{b.node, 0, 2}, side.triangle->patch, b.uv};
  tracer.segments.push_back(segment);
}

void cross_seams(Tracer& tracer) {
  for (const auto& [nodes, uses] : seams_of(tracer.grid, tracer.placed)) {
    const CreaseSide one = crease_side(tracer, uses[0], nodes.first);
    if (uses.size() == 1) {
      if (tracer.kind == CurveKind::silhouette) add_open_edge(tracer, one);
      continue;
    }
    const CreaseSide two = crease_side(tracer, uses[1], nodes.first);
    const auto side = [](const CreaseSide& s, int i) { return s.triangle->corners[static_cast<size_t>(i)].side; };
    if (side(one, one.from) == side(two, two.from) && side(one, one.to) == side(two, two.to)) continue;
    follow_crease(tracer, one, two);
  }
}

}  // namespace

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

std::vector<LimitSegment> limit_segments(const PlacedLimitSurface& placed, const LimitGrid& grid, const Camera& camera, CurveKind kind,
                                         double threshold) {
  Tracer tracer{placed, grid, camera, kind, threshold};
  tracer.facing.resize(grid.normals.size());
  for (size_t s = 0; s < grid.normals.size(); ++s)
    tracer.facing[s] = glm::dot(grid.normals[s], view_vector(camera, grid.positions[grid.node_of_side[s]]));
  for (const LimitTriangle& triangle : grid.triangles) cross_triangle(tracer, triangle);
  cross_seams(tracer);
  return std::move(tracer.segments);
}

}  // namespace limn
