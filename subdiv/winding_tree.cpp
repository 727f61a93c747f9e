// The tree that winding numbers are summed over: triangles sorted along a curve through space, their range split at the highest bit that
// differs, so that every cluster fills a box of an octree (Lauterbach et al., Fast BVH construction on GPUs, 2009).

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "sdf/parallel.h"
#include "subdiv/mesh_distance.h"

namespace limn {
namespace {

constexpr size_t kLeafSize = 8;
/// Triangles of a part of the tree that one thread builds.
constexpr size_t kPartSize = 1 << 14;

/// Every third bit of the result, from the 21 lowest of the argument.
std::uint64_t spread_bits(std::uint64_t bits) {
  bits &= 0x1fffff;
  bits = (bits | bits << 32) & 0x1f00000000ffffull;
  bits = (bits | bits << 16) & 0x1f0000ff0000ffull;
  bits = (bits | bits << 8) & 0x100f00f00f00f00full;
  bits = (bits | bits << 4) & 0x10c30c30c30c30c3ull;
  return (bits | bits << 2) & 0x1249249249249249ull;
}

/// A triangle and its middle's place on Morton's curve, on which what is near in space is mostly near.
struct Place {
  std::uint64_t along;
  std::uint32_t triangle;
  bool operator<(const Place& other) const { return along != other.along ? along < other.along : triangle < other.triangle; }
};

constexpr double kMostAlong = 0x1fffff;

/// How many come before the place where the highest of the bits that differ changes; half of them where none differs.
size_t split(std::span<const Place> range) {
  const std::uint64_t differ = range.front().along ^ range.back().along;
  if (differ == 0) return range.size() / 2;
  const std::uint64_t highest = std::bit_floor(differ);
  const auto found =
      std::partition_point(range.begin(), range.end(), [highest](const Place& place) { return (place.along & highest) == 0; });
  return static_cast<size_t>(found - range.begin());
}

}  // namespace

struct Winding::Builder {
  Winding& winding;
  std::vector<Place> places{};

  /// What a cluster adds to the one above it.
  struct Sum {
    double area = 0.0;
    glm::dvec3 weighted{0.0};  ///< By area, of the middles.
    Box corners{};
  };
  struct Part {
    std::vector<Node> nodes{};
    Sum sum{};
  };

  void run() {
    sort();
    std::vector<std::span<const Place>> ranges;
    find_parts(places, ranges);
    std::vector<Part> parts(ranges.size());
    parallel_for(size_t{0}, ranges.size(), [&](size_t i) { parts[i].sum = build(ranges[i], parts[i].nodes); });
    size_t nodes = parts.size();
    for (const Part& part : parts) nodes += part.nodes.size();
    winding.nodes_.reserve(nodes);
    Part* next = parts.data();
    join_parts(places, next);
  }

  /// Along the curve.
  void sort() {
    const TriangleMesh& mesh = winding.mesh_;
    // A vertex that no triangle uses must not make the curve coarse.
    Box box;
    for (const glm::uvec3& triangle : mesh.triangles) box = include(box, mesh.positions[triangle.x]);
    const double scale = box.longest_side() > 0.0 ? kMostAlong / box.longest_side() : 0.0;
    places.resize(mesh.triangles.size());
    parallel_for(size_t{0}, places.size(), [&](size_t i) {
      const auto t = static_cast<std::uint32_t>(i);
      const glm::dvec3 at = scale * ((winding.corner(t, 0) + winding.corner(t, 1) + winding.corner(t, 2)) / 3.0 - box.lower);
      const auto bits = [](double x) { return spread_bits(static_cast<std::uint64_t>(std::clamp(x, 0.0, kMostAlong))); };
      places[i] = {bits(at.x) << 2 | bits(at.y) << 1 | bits(at.z), t};
    });
    parallel_sort(places.begin(), places.end());
    winding.order_.resize(places.size());
    for (size_t i = 0; i < places.size(); ++i) winding.order_[i] = places[i].triangle;
  }

  void find_parts(std::span<const Place> range, std::vector<std::span<const Place>>& parts) const {
    if (range.size() <= kPartSize) {
      parts.push_back(range);
      return;
    }
    const size_t half = split(range);
    find_parts(range.first(half), parts);
    find_parts(range.subspan(half), parts);
  }

  Sum build(std::span<const Place> range, std::vector<Node>& nodes) const {
    const size_t index = nodes.size();
    nodes.emplace_back();
    if (range.size() <= kLeafSize) return measure(range, nodes[index]);
    const size_t half = split(range);
    nodes[index].left = static_cast<std::uint32_t>(nodes.size());
    const Sum left = build(range.first(half), nodes);
    nodes[index].right = static_cast<std::uint32_t>(nodes.size());
    const Sum right = build(range.subspan(half), nodes);
    return joined(nodes, nodes[index], left, right);
  }

  /// As build, down to the parts, which are there already.
  Sum join_parts(std::span<const Place> range, Part*& next) {
    std::vector<Node>& nodes = winding.nodes_;
    const auto index = static_cast<std::uint32_t>(nodes.size());
    if (range.size() <= kPartSize) {
      for (Node node : std::exchange(next->nodes, {})) {
        if (node.left != 0) node.left += index, node.right += index;
        nodes.push_back(node);
      }
      return next++->sum;
    }
    nodes.emplace_back();
    const size_t half = split(range);
    nodes[index].left = index + 1;
    const Sum left = join_parts(range.first(half), next);
    nodes[index].right = static_cast<std::uint32_t>(nodes.size());
    const Sum right = join_parts(range.subspan(half), next);
    return joined(nodes, nodes[index], left, right);
  }

  Sum measure(std::span<const Place> range, Node& node) const {
    node.first = static_cast<std::uint32_t>(range.data() - places.data());
    node.count = static_cast<std::uint32_t>(range.size());
    Sum sum;
    for (const Place& place : range) {
      const std::uint32_t t = place.triangle;
      const glm::dvec3 a = winding.corner(t, 0), b = winding.corner(t, 1), c = winding.corner(t, 2);
      const glm::dvec3 vector = 0.5 * glm::cross(b - a, c - a);
      const double area = glm::length(vector);
      node.dipole += winding.times_.empty() ? vector : static_cast<double>(winding.times_[t]) * vector;
      sum.area += area;
      sum.weighted += area / 3.0 * (a + b + c);
      for (const glm::dvec3& corner : {a, b, c}) sum.corners = include(sum.corners, corner);
    }
    node.center = sum.area > 0.0 ? sum.weighted / sum.area : sum.corners.center();
    double farthest = 0.0;
    for (const Place& place : range)
      for (int k = 0; k < 3; ++k) {
        const glm::dvec3 away = winding.corner(place.triangle, k) - node.center;
        farthest = std::max(farthest, glm::dot(away, away));
      }
    node.radius = std::sqrt(farthest);
    return sum;
  }

  /// The radius is that of a ball around both halves, or of one around the box of all corners where that is smaller.
  static Sum joined(const std::vector<Node>& nodes, Node& node, const Sum& a, const Sum& b) {
    const Node &left = nodes[node.left], &right = nodes[node.right];
    Sum sum{a.area + b.area, a.weighted + b.weighted, merge(a.corners, b.corners)};
    node.dipole = left.dipole + right.dipole;
    node.center = sum.area > 0.0 ? sum.weighted / sum.area : sum.corners.center();
    const double balls =
        std::max(glm::distance(node.center, left.center) + left.radius, glm::distance(node.center, right.center) + right.radius);
    const glm::dvec3 farthest = glm::max(sum.corners.upper - node.center, node.center - sum.corners.lower);
    node.radius = std::min(balls, glm::length(farthest));
    return sum;
  }
};

Winding::Winding(const TriangleMesh& mesh, std::span<const std::uint32_t> first_at, std::vector<std::int32_t> times)
    : mesh_(mesh), times_(std::move(times)) {
  if (!mesh.triangles.empty()) Builder{*this}.run();
  find_border(first_at);
}

}  // namespace limn
