#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "sdf/parallel.h"
#include "subdiv/mesh_distance.h"
#include "subdiv/weld.h"

namespace limn {
namespace {

constexpr std::uint32_t kLeafSize = 8;

/// Signed solid angle over 4 pi (van Oosterom & Strackee 1983).
double triangle_winding(const glm::dvec3& p, const glm::dvec3& first, const glm::dvec3& second, const glm::dvec3& third) {
  const glm::dvec3 a = first - p, b = second - p, c = third - p;
  const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
  const double numerator = glm::dot(a, glm::cross(b, c));
  const double denominator = la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb;
  return std::atan2(numerator, denominator) / (2.0 * std::numbers::pi);
}

/// Of a tree over so many triangles: known beforehand, so that its halves can be built at a time.
std::uint32_t nodes_in(std::uint32_t triangles) {
  return triangles <= kLeafSize ? 1 : 1 + nodes_in(triangles / 2) + nodes_in(triangles - triangles / 2);
}

}  // namespace

Winding::Winding(const TriangleMesh& mesh, std::span<const std::uint32_t> first_at, std::vector<std::int32_t> times)
    : mesh_(mesh), times_(std::move(times)) {
  order_.resize(mesh.triangles.size());
  std::iota(order_.begin(), order_.end(), 0u);
  if (!order_.empty()) {
    nodes_.resize(nodes_in(static_cast<std::uint32_t>(order_.size())));
    Scratch scratch{std::vector<double>(order_.size()), std::vector<std::uint32_t>(order_.size())};
    build(0, 0, static_cast<std::uint32_t>(order_.size()), scratch);
  }
  find_border(first_at);
}

Winding::Winding(const TriangleMesh& mesh) : Winding(mesh, first_at_position(mesh.positions)) {}

void Winding::build(std::uint32_t index, std::uint32_t first, std::uint32_t count, Scratch& scratch) {
  Node& node = nodes_[index];
  node.first = first, node.count = count;
  const Box centers = measure(node);
  if (count <= kLeafSize) return;
  const glm::dvec3 size = centers.size();
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::uint32_t half = count / 2;
  split(first, count, half, axis, {centers.lower[axis], centers.upper[axis]}, scratch);
  node.left = index + 1;
  node.right = index + 1 + nodes_in(half);
  const auto build_left = [&] { build(node.left, first, half, scratch); };
  const auto build_right = [&] { build(node.right, first + half, count - half, scratch); };
  constexpr std::uint32_t kWorthATask = 4096;
  if (count > kWorthATask)
    parallel_invoke(build_left, build_right);
  else
    build_left(), build_right();
}

/// Returns the bounds of the triangles' middles.
Box Winding::measure(Node& node) const {
  double area = 0.0;
  glm::dvec3 weighted(0.0);
  Box centers;
  for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
    const std::uint32_t t = order_[i];
    const glm::dvec3 a = corner(t, 0), b = corner(t, 1), c = corner(t, 2), middle = (a + b + c) / 3.0;
    const glm::dvec3 vector = 0.5 * glm::cross(b - a, c - a);
    const double length = glm::length(vector);
    node.dipole += times_.empty() ? vector : static_cast<double>(times_[t]) * vector;
    area += length;
    weighted += length * middle;
    centers = include(centers, middle);
  }
  node.center = area > 0.0 ? weighted / area : centers.center();
  double farthest = 0.0;
  const auto squared = [&node](const glm::dvec3& p) { return glm::dot(p - node.center, p - node.center); };
  for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
    for (int k = 0; k < 3; ++k) farthest = std::max(farthest, squared(corner(order_[i], k)));
  node.radius = std::sqrt(farthest);
  return centers;
}

/// Brings the `half` triangles of the least middles (of equal ones those of the lowest numbers) to the front; both parts stay in order, so
/// that sums are the same everywhere. A histogram finds the pair between the two in a few passes.
void Winding::split(std::uint32_t first, std::uint32_t count, std::uint32_t half, int axis, const Interval& range, Scratch& scratch) {
  using Key = std::pair<double, std::uint32_t>;
  const std::span<std::uint32_t> order = std::span(order_).subspan(first, count);
  const std::span<double> keys = std::span(scratch.keys).subspan(first, count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t t = order[i];
    keys[i] = (corner(t, 0)[axis] + corner(t, 1)[axis] + corner(t, 2)[axis]) / 3.0;
  }
  constexpr std::uint32_t kMostBins = 4096;
  const std::uint32_t bins = std::clamp(count / 8, 1u, kMostBins);
  const double scale = range.width() > 0.0 ? bins / range.width() : 0.0;
  const auto bin_of = [&](double key) {
    const double at = (key - range.lower) * scale;
    return at < bins - 1 ? static_cast<std::uint32_t>(at) : bins - 1;
  };
  std::array<std::uint32_t, kMostBins> counts;
  std::fill_n(counts.begin(), bins, 0u);
  for (const double key : keys) ++counts[bin_of(key)];
  std::uint32_t bin = 0, before = 0;
  while (before + counts[bin] <= half) before += counts[bin++];
  std::vector<Key> within;
  within.reserve(counts[bin]);
  for (std::uint32_t i = 0; i < count; ++i)
    if (bin_of(keys[i]) == bin) within.emplace_back(keys[i], order[i]);
  const auto middle = within.begin() + (half - before);
  std::nth_element(within.begin(), middle, within.end());
  const Key pivot = *middle;
  const std::span<std::uint32_t> back = std::span(scratch.back).subspan(first, count);
  std::uint32_t front = 0, behind = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (Key(keys[i], order[i]) < pivot)
      order[front++] = order[i];
    else
      back[behind++] = order[i];
  }
  std::copy_n(back.begin(), behind, order.begin() + front);
}

double Winding::number(const glm::dvec3& point, double far) const {
  if (nodes_.empty()) return 0.0;
  double sum = 0.0;
  std::uint32_t stack[128];
  int depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const Node& node = nodes_[stack[--depth]];
    const glm::dvec3 away = node.center - point;
    const double squared = glm::dot(away, away);
    if (squared > far * far * node.radius * node.radius) {
      sum += glm::dot(away, node.dipole) / (4.0 * std::numbers::pi * squared * std::sqrt(squared));
    } else if (node.left == 0) {
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        const std::uint32_t t = order_[i];
        const double own = triangle_winding(point, corner(t, 0), corner(t, 1), corner(t, 2));
        sum += times_.empty() ? own : static_cast<double>(times_[t]) * own;
      }
    } else {
      stack[depth++] = node.right;
      stack[depth++] = node.left;
    }
  }
  return sum;
}

/// Uses of edges, brought to their places by the lower vertex (few share one) and sorted there by the higher.
void Winding::find_border(std::span<const std::uint32_t> first_at) {
  struct Use {
    std::uint32_t high;
    std::int32_t times;  ///< Below 0: from the higher vertex to the lower.
  };
  const auto visit = [&](const auto& take) {
    for (size_t t = 0; t < mesh_.triangles.size(); ++t)
      for (int i = 0; i < 3; ++i) {
        const std::uint32_t a = first_at[mesh_.triangles[t][i]], b = first_at[mesh_.triangles[t][(i + 1) % 3]];
        const std::int32_t times = times_.empty() ? 1 : times_[t];
        if (a != b) take(std::min(a, b), Use{std::max(a, b), a < b ? times : -times});
      }
  };
  std::vector<std::uint32_t> ends(mesh_.positions.size() + 1, 0);
  visit([&](std::uint32_t low, const Use&) { ++ends[low + 1]; });
  std::partial_sum(ends.begin(), ends.end(), ends.begin());
  std::vector<Use> uses(ends.back());
  // Each start moves on to where the next vertex starts.
  visit([&](std::uint32_t low, const Use& use) { uses[ends[low]++] = use; });
  for (std::uint32_t low = 0, start = 0; low + 1 < ends.size(); start = ends[low++]) {
    const std::span<Use> own = std::span(uses).subspan(start, ends[low] - start);
    std::sort(own.begin(), own.end(), [](const Use& a, const Use& b) { return a.high < b.high; });
    for (size_t i = 0; i < own.size();) {
      int net = 0;
      size_t end = i;
      for (; end < own.size() && own[end].high == own[i].high; ++end) net += own[end].times;
      if (net != 0) border_.push_back({mesh_.positions[low], mesh_.positions[own[i].high], net});
      i = end;
    }
  }
}

glm::dvec3 Winding::gradient(const glm::dvec3& point) const {
  glm::dvec3 sum(0.0);
  for (const BorderEdge& edge : border_) {
    const glm::dvec3 a = edge.a - point, b = edge.b - point;
    const double la = glm::length(a), lb = glm::length(b);
    const double denominator = la * lb * (la * lb + glm::dot(a, b));
    if (denominator > 0.0) sum += static_cast<double>(edge.multiplicity) * (la + lb) / denominator * glm::cross(a, b);
  }
  return sum / (4.0 * std::numbers::pi);
}

// Either the border's pieces at their nearest, all pulling one way; or the gradient at the centre and as much as it can change from there,
// the derivative of r/|r|^3 being no larger than 2/|r|^3: far from a hole its two sides cancel, and only the second bound knows.
double Winding::gradient_bound(const glm::dvec3& center, double radius) const {
  double largest = 0.0, change = 0.0;
  for (const BorderEdge& edge : border_) {
    const double length = glm::distance(edge.a, edge.b);
    const double distance = glm::distance(center, 0.5 * (edge.a + edge.b)) - 0.5 * length - radius;
    if (distance <= 0.0) return std::numeric_limits<double>::infinity();
    const double weight = std::abs(edge.multiplicity) * length / (4.0 * std::numbers::pi);
    largest += weight / (distance * distance);
    change += 2.0 * weight / (distance * distance * distance);
  }
  return std::min(largest, glm::length(gradient(center)) + radius * change);
}

}  // namespace limn
