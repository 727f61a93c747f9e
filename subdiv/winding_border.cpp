#include "subdiv/winding_border.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "sdf/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "subdiv/winding_border.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "sdf/lane_real-inl.h"

HWY_BEFORE_NAMESPACE();
namespace limn {
namespace HWY_NAMESPACE {
namespace {

struct Reals3 {
  Reals x, y, z;
};
HWY_INLINE Reals3 reals3(const glm::dvec3& v) { return {reals(v.x), reals(v.y), reals(v.z)}; }
HWY_INLINE Reals3 load3(const double (&lanes)[3][8], int at) { return {load(lanes[0] + at), load(lanes[1] + at), load(lanes[2] + at)}; }
HWY_INLINE Reals3 operator-(const Reals3& a, const Reals3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
HWY_INLINE Reals3 operator+(const Reals3& a, const Reals3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
HWY_INLINE Reals3 operator*(Reals s, const Reals3& a) { return {s * a.x, s * a.y, s * a.z}; }
HWY_INLINE Reals dot(const Reals3& a, const Reals3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
HWY_INLINE Reals length(const Reals3& a) { return norm(a.x, a.y, a.z); }
HWY_INLINE Reals3 cross(const Reals3& a, const Reals3& b) { return {a.y * b.z - b.y * a.z, a.z * b.x - b.z * a.x, a.x * b.y - b.x * a.y}; }

/// One end of an edge, from a point.
struct EdgeEnd {
  Reals3 way;
  Reals length;
};

HWY_INLINE EdgeEnd edge_end(const glm::dvec3& at, const Reals3& p) {
  const Reals3 way = reals3(at) - p;
  return {way, length(way)};
}

/// What gradients and angles of an edge have in common.
struct EdgeLanes {
  EdgeEnd a, b;
  Reals together;  ///< Product of the lengths, and of the ways.
  Reals3 normal;   ///< Across both ways.
};

HWY_INLINE EdgeLanes edge_lanes(const EdgeEnd& a, const EdgeEnd& b) {
  return {a, b, a.length * b.length + dot(a.way, b.way), cross(a.way, b.way)};
}

/// Of edges from a point, which mostly begin where the one before ended.
struct EdgeWalk {
  EdgeEnd last;
  const Winding::BorderEdge* before;
};

HWY_INLINE EdgeLanes next_edge(EdgeWalk& walk, const Winding::BorderEdge& edge, const Reals3& p) {
  const EdgeEnd a = walk.before && walk.before->b == edge.a ? walk.last : edge_end(edge.a, p);
  walk.last = edge_end(edge.b, p);
  walk.before = &edge;
  return edge_lanes(a, walk.last);
}

HWY_INLINE EdgeWalk no_edge_yet(const Reals3& p) { return {{p, p.x}, nullptr}; }

/// What an edge adds to the gradient, 4 pi times as much: Biot and Savart's law for straight pieces.
HWY_INLINE Reals3 pull_of(const EdgeLanes& edge, int multiplicity) {
  const Reals denominator = edge.a.length * edge.b.length * edge.together, zero = reals(0.0);
  const Reals weight = reals(static_cast<double>(multiplicity)) * (edge.a.length + edge.b.length) / denominator;
  // On the piece itself there is none.
  return select(denominator > zero, weight, zero) * edge.normal;
}

HWY_INLINE Reals3 per_whole_sphere(const Reals3& pulls) {
  const Reals all = reals(4.0 * std::numbers::pi);
  return {pulls.x / all, pulls.y / all, pulls.z / all};
}

HWY_INLINE Reals3 gradient_at(std::span<const Winding::BorderEdge> border, const Reals3& p) {
  const Reals zero = reals(0.0);
  Reals3 sum{zero, zero, zero};
  EdgeWalk walk = no_edge_yet(p);
  for (const Winding::BorderEdge& edge : border) sum = sum + pull_of(next_edge(walk, edge, p), edge.multiplicity);
  return per_whole_sphere(sum);
}

/// An angle, as a complex number of any length.
struct Turn {
  Reals along, across;
};

HWY_INLINE Turn operator*(const Turn& a, const Turn& b) {
  return {a.along * b.along - a.across * b.across, a.along * b.across + a.across * b.along};
}

/// Half the solid angle of a triangle that leads from an edge to infinity in a direction (van Oosterom & Strackee 1983).
HWY_INLINE Turn half_angle(const EdgeLanes& edge, const glm::dvec3& direction) {
  const Reals3 ahead = reals3(direction);
  return {edge.together + dot(ahead, edge.b.way) * edge.a.length + dot(ahead, edge.a.way) * edge.b.length, dot(ahead, edge.normal)};
}

/// A product of angles.
struct TurnProduct {
  Turn turn;
  unsigned count;
};

HWY_INLINE TurnProduct no_turn() { return {{reals(1.0), reals(0.0)}, 0}; }

/// Times a power of two.
HWY_INLINE Turn of_ordinary_length(const Turn& turn) {
  const hn::Rebind<std::int64_t, RealTag> integers;
  const auto size = hn::BitCast(integers, maximum(abs(turn.along), abs(turn.across)).v);
  const auto exponent = hn::And(size, hn::Set(integers, std::int64_t{0x7ff} << 52));
  const Reals scale{hn::BitCast(RealTag(), hn::Sub(hn::Set(integers, std::int64_t{0x7fe} << 52), exponent))};
  return {scale * turn.along, scale * turn.across};
}

HWY_INLINE void multiply(TurnProduct& product, Turn half, int times) {
  // On a line through an end of the edge along which its triangle leads there is no angle, or as good as none.
  half.along = select(maximum(abs(half.along), abs(half.across)) > reals(0.0), half.along, reals(1.0));
  for (int k = 0; k < times; ++k) {
    product.turn = product.turn * half;
    // Of so many, models of any usual size make an ordinary number.
    if (++product.count % 4 == 0) product.turn = of_ordinary_length(product.turn);
  }
}

void store_lanes(const Reals3& gradient, const Turn& turn, int at, EightPotentials& out) {
  store(gradient.x, out.gradients.at[0] + at);
  store(gradient.y, out.gradients.at[1] + at);
  store(gradient.z, out.gradients.at[2] + at);
  store(turn.along, out.along + at);
  store(turn.across, out.across + at);
}

HWY_INLINE const Winding::BorderEdge& edge_of(const Winding::BorderEdge& edge) { return edge; }
HWY_INLINE const Winding::BorderEdge& edge_of(const SeenEdge& seen) { return seen.edge; }

/// Gradients of edges, and the product of their angles, `angle_of(lanes, edge)`.
template <class Edge, class AngleOf>
HWY_INLINE void add_up(std::span<const Edge> edges, const EightPoints& points, const AngleOf& angle_of, EightPotentials& out) {
  for (int at = 0; at < 8; at += kWidth) {
    const Reals3 p = load3(points.at, at);
    const Reals zero = reals(0.0);
    Reals3 sum{zero, zero, zero};
    TurnProduct turns = no_turn();
    EdgeWalk walk = no_edge_yet(p);
    for (const Edge& edge : edges) {
      const EdgeLanes lanes = next_edge(walk, edge_of(edge), p);
      sum = sum + pull_of(lanes, edge_of(edge).multiplicity);
      multiply(turns, angle_of(lanes, edge), edge_of(edge).multiplicity);
    }
    store_lanes(per_whole_sphere(sum), turns.turn, at, out);
  }
}

/// Triangles from all edges to one point close the mesh: their angles are the number's but for a whole one.
void potentials_at(std::span<const Winding::BorderEdge> border, const EightPoints& points, EightPotentials& out) {
  // Along no axis, diagonal or edge that a model is likely to have.
  constexpr glm::dvec3 kFarAway{0.3169914974459893, 0.5602276283961604, 0.7652851722910635};
  add_up(
      border, points, [&](const EdgeLanes& lanes, const Winding::BorderEdge&) { return half_angle(lanes, kFarAway); }, out);
}

/// What lies behind each edge as the center sees it, between the edge and infinity, is seen from there as a line. From elsewhere it is two
/// triangles: from the edge to where the way to b leads, and from a to where both ways lead.
void changes_at(std::span<const SeenEdge> edges, const EightPoints& points, EightPotentials& out) {
  const auto angle_of = [](const EdgeLanes& lanes, const SeenEdge& seen) {
    const Turn behind_a{lanes.a.length * seen.together + dot(reals3(seen.ways), lanes.a.way), dot(reals3(seen.normal), lanes.a.way)};
    return half_angle(lanes, seen.to_b) * behind_a;
  };
  add_up(edges, points, angle_of, out);
}

void gradients_at(std::span<const Winding::BorderEdge> border, const EightPoints& points, EightPoints& gradients) {
  for (int at = 0; at < 8; at += kWidth) {
    const Reals3 gradient = gradient_at(border, load3(points.at, at));
    store(gradient.x, gradients.at[0] + at);
    store(gradient.y, gradients.at[1] + at);
    store(gradient.z, gradients.at[2] + at);
  }
}

HWY_INLINE Reals distance_to(const Reals3& a, const Reals3& b, const Reals3& p) {
  const Reals zero = reals(0.0), one = reals(1.0);
  const Reals3 along = b - a;
  const Reals squared = dot(along, along), per = select(squared > zero, one / squared, zero);
  const Reals share = minimum(maximum(dot(p - a, along) * per, zero), one);
  return length(a + share * along - p);
}

void distances_to(std::span<const EdgeGroup> border, const glm::dvec3& point, double* distances) {
  const Reals3 p = reals3(point);
  for (const EdgeGroup& group : border)
    for (int at = 0; at < 8; at += kWidth, distances += kWidth) store(distance_to(load3(group.a, at), load3(group.b, at), p), distances);
}

/// In the order of the lanes, whatever a vector holds.
template <int kSums>
struct EightSums {
  alignas(64) double lanes[kSums][8] = {};
};
HWY_INLINE void add(Reals value, double* lanes) { store(load(lanes) + value, lanes); }

// Either the border's pieces at their nearest, all pulling one way; or the gradient at the centre and as much as it can change from there,
// the derivative of r/|r|^3 being no larger than 2/|r|^3: far from a hole its two sides cancel, and only the second bound knows. A piece of
// length l whose nearest point lies d away pulls by no more than the integral of d / (d^2 + u^2)^(3/2) over its length, which is largest
// where that point is its middle: l / (d sqrt(d^2 + l^2 / 4)); the integral of 2 / (d^2 + u^2)^(3/2) is 2 / d times as much.
double bound_about(std::span<const EdgeGroup> border, const glm::dvec3& center, double radius) {
  const Reals3 p = reals3(center);
  EightSums<5> sums;
  auto& [largest, change, x, y, z] = sums.lanes;
  for (const EdgeGroup& group : border)
    for (int at = 0; at < 8; at += kWidth) {
      const Reals3 a = load3(group.a, at), b = load3(group.b, at);
      const Reals times = load(group.times + at), distance = distance_to(a, b, p) - radius, length_of_edge = length(b - a);
      if (!hn::AllFalse(RealTag(), distance <= reals(0.0))) return std::numeric_limits<double>::infinity();
      const Reals root = square_root(square(distance) + square(length_of_edge) * 0.25), per = reals(1.0) / (distance * root);
      const Reals pull = times * length_of_edge * per;
      add(pull, largest + at);
      add(pull * 2.0 * (root * per), change + at);
      const Reals3 way_a = a - p, way_b = b - p;
      const Reals3 pulls = times * pull_of(edge_lanes({way_a, length(way_a)}, {way_b, length(way_b)}), 1);
      add(pulls.x, x + at);
      add(pulls.y, y + at);
      add(pulls.z, z + at);
    }
  double all[5] = {};
  for (int k = 0; k < 5; ++k)
    for (const double lane : sums.lanes[k]) all[k] += lane;
  const double from_center = std::sqrt(all[2] * all[2] + all[3] * all[3] + all[4] * all[4]) + all[1] * radius;
  return std::min(all[0], from_center) / (4.0 * std::numbers::pi);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace limn
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace limn {
namespace {
HWY_EXPORT(gradients_at);
HWY_EXPORT(potentials_at);
HWY_EXPORT(distances_to);
HWY_EXPORT(bound_about);
HWY_EXPORT(changes_at);

/// From the first on; lanes beyond repeat the last.
EightPoints eight_of(std::span<const glm::dvec3> points) {
  EightPoints eight;
  for (size_t i = 0; i < 8; ++i) {
    const glm::dvec3& p = points[std::min(i, points.size() - 1)];
    for (int axis = 0; axis < 3; ++axis) eight.at[axis][i] = p[axis];
  }
  return eight;
}

}  // namespace

void border_gradients(std::span<const Winding::BorderEdge> border, const EightPoints& points, EightPoints& gradients) {
  HWY_DYNAMIC_DISPATCH(gradients_at)(border, points, gradients);
}
void border_potentials(std::span<const Winding::BorderEdge> border, const EightPoints& points, EightPotentials& potentials) {
  HWY_DYNAMIC_DISPATCH(potentials_at)(border, points, potentials);
}
void border_distances(std::span<const EdgeGroup> border, const glm::dvec3& point, double* distances) {
  HWY_DYNAMIC_DISPATCH(distances_to)(border, point, distances);
}
SeenEdge seen_from(const glm::dvec3& center, const Winding::BorderEdge& edge) {
  // Whatever direction an end at the center itself has, both of its edges have it.
  const auto direction = [&](const glm::dvec3& end) { return end == center ? glm::dvec3(0.0, 0.0, 1.0) : glm::normalize(end - center); };
  const glm::dvec3 to_a = direction(edge.a), to_b = direction(edge.b);
  return {edge, to_b, to_a + to_b, glm::cross(to_b, to_a), 1.0 + glm::dot(to_a, to_b)};
}
void border_changes(std::span<const SeenEdge> edges, const EightPoints& points, EightPotentials& changes) {
  HWY_DYNAMIC_DISPATCH(changes_at)(edges, points, changes);
}

void Winding::potentials(std::span<const glm::dvec3> points, std::span<Potential> out) const {
  for (size_t first = 0; first < points.size(); first += 8) {
    const std::span<const glm::dvec3> part = points.subspan(first, std::min<size_t>(8, points.size() - first));
    EightPotentials found;
    border_potentials(border_, eight_of(part), found);
    const auto& [x, y, z] = found.gradients.at;
    for (size_t i = 0; i < part.size(); ++i)
      out[first + i] = {std::atan2(found.across[i], found.along[i]) / (2.0 * std::numbers::pi), {x[i], y[i], z[i]}};
  }
}

Winding::Potential Winding::potential(const glm::dvec3& point) const {
  Potential found;
  potentials({&point, 1}, {&found, 1});
  return found;
}

double Winding::gradient_bound(const glm::dvec3& center, double radius) const {
  return HWY_DYNAMIC_DISPATCH(bound_about)(border_groups_, center, radius);
}

}  // namespace limn
#endif
