#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <tuple>

#include "sdf/parallel.h"
#include "subdiv/mesh_distance.h"

namespace limn {
namespace {

constexpr std::uint32_t kLeafSize = 8;

/// Signed solid angle over 4 pi (van Oosterom & Strackee 1983).
double triangle_winding(const glm::dvec3& p, const glm::dvec3* corners) {
  const glm::dvec3 a = corners[0] - p, b = corners[1] - p, c = corners[2] - p;
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

Winding::Winding(const TriangleMesh& mesh) {
  order_.resize(mesh.triangles.size());
  std::iota(order_.begin(), order_.end(), 0u);
  if (!order_.empty()) {
    nodes_.resize(nodes_in(static_cast<std::uint32_t>(order_.size())));
    build(mesh, 0, 0, static_cast<std::uint32_t>(order_.size()));
  }
  for (const std::uint32_t t : order_)
    for (int i = 0; i < 3; ++i) corners_.push_back(mesh.positions[mesh.triangles[t][i]]);
  find_border(mesh);
}

void Winding::build(const TriangleMesh& mesh, std::uint32_t index, std::uint32_t first, std::uint32_t count) {
  Node& node = nodes_[index];
  node.first = first, node.count = count;
  const auto corner = [&mesh](std::uint32_t t, int i) { return mesh.positions[mesh.triangles[t][i]]; };
  const auto middle = [&corner](std::uint32_t t) { return (corner(t, 0) + corner(t, 1) + corner(t, 2)) / 3.0; };
  double area = 0.0;
  glm::dvec3 weighted(0.0);
  Box centers;
  for (std::uint32_t i = first; i < first + count; ++i) {
    const std::uint32_t t = order_[i];
    const glm::dvec3 vector = 0.5 * glm::cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0));
    node.dipole += vector;
    area += glm::length(vector);
    weighted += glm::length(vector) * middle(t);
    centers = include(centers, middle(t));
  }
  node.center = area > 0.0 ? weighted / area : centers.center();
  for (std::uint32_t i = first; i < first + count; ++i)
    for (int k = 0; k < 3; ++k) node.radius = std::max(node.radius, glm::distance(node.center, corner(order_[i], k)));
  if (count > kLeafSize) {
    const glm::dvec3 size = centers.size();
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::uint32_t half = count / 2;
    const auto begin = order_.begin() + first;
    std::nth_element(begin, begin + half, begin + count,
                     [&](std::uint32_t a, std::uint32_t b) { return std::pair(middle(a)[axis], a) < std::pair(middle(b)[axis], b); });
    // The order within halves is the library's; sorting makes the sums the same everywhere.
    std::sort(begin, begin + half), std::sort(begin + half, begin + count);
    node.left = index + 1;
    node.right = index + 1 + nodes_in(half);
    const auto build_left = [&] { build(mesh, node.left, first, half); };
    const auto build_right = [&] { build(mesh, node.right, first + half, count - half); };
    constexpr std::uint32_t kWorthATask = 4096;
    if (count > kWorthATask)
      parallel_invoke(build_left, build_right);
    else
      build_left(), build_right();
  }
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
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) sum += triangle_winding(point, &corners_[3 * i]);
    } else {
      stack[depth++] = node.right;
      stack[depth++] = node.left;
    }
  }
  return sum;
}

void Winding::find_border(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> by_position(mesh.positions.size());
  std::iota(by_position.begin(), by_position.end(), 0u);
  const auto key = [&mesh](std::uint32_t v) {
    const glm::dvec3& p = mesh.positions[v];
    return std::tuple(p.x, p.y, p.z, v);
  };
  parallel_sort(by_position.begin(), by_position.end(), [&key](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  std::vector<std::uint32_t> welded(mesh.positions.size());
  for (size_t i = 0; i < by_position.size(); ++i) {
    const bool same = i > 0 && mesh.positions[by_position[i]] == mesh.positions[by_position[i - 1]];
    welded[by_position[i]] = same ? welded[by_position[i - 1]] : by_position[i];
  }
  struct Use {
    std::uint32_t low, high;
    int direction;
  };
  std::vector<Use> uses;
  for (const glm::uvec3& t : mesh.triangles)
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t a = welded[t[i]], b = welded[t[(i + 1) % 3]];
      if (a != b) uses.push_back(a < b ? Use{a, b, 1} : Use{b, a, -1});
    }
  parallel_sort(uses.begin(), uses.end(), [](const Use& a, const Use& b) { return std::tie(a.low, a.high) < std::tie(b.low, b.high); });
  for (size_t i = 0; i < uses.size();) {
    int net = 0;
    size_t end = i;
    for (; end < uses.size() && uses[end].low == uses[i].low && uses[end].high == uses[i].high; ++end) net += uses[end].direction;
    if (net != 0) border_.push_back({mesh.positions[uses[i].low], mesh.positions[uses[i].high], net});
    i = end;
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
