#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "subdiv/mesh_distance.h"
#include "subdiv/weld.h"

namespace limn {
namespace {

/// An angle from -pi to pi, as a complex number of any length.
struct Turn {
  double along = 1.0, across = 0.0;
  double angle() const { return std::atan2(across, along); }
};

/// Half a triangle's signed solid angle (van Oosterom & Strackee 1983).
Turn half_solid_angle(const glm::dvec3& p, const glm::dvec3& first, const glm::dvec3& second, const glm::dvec3& third) {
  const glm::dvec3 a = first - p, b = second - p, c = third - p;
  const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
  return {la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb, glm::dot(a, glm::cross(b, c))};
}

/// A sum of a few angles: their product, and how often it went round. An arctangent takes longer than all the rest of a triangle.
class AngleSum {
 public:
  void add(const Turn& turn) {
    // On a corner or an edge there is none.
    if (turn.along == 0.0 && turn.across == 0.0) return;
    const Turn next{product_.along * turn.along - product_.across * turn.across,
                    product_.along * turn.across + product_.across * turn.along};
    const bool left = product_.across >= 0.0 && turn.across >= 0.0, right = product_.across < 0.0 && turn.across < 0.0;
    if (left && next.across < 0.0) ++rounds_;
    if (right && next.across >= 0.0) --rounds_;
    // Of meshes of any size the product stays a number.
    const double size = std::max(std::abs(next.along), std::abs(next.across)), scale = size > 1e100 || size < 1e-100 ? 1.0 / size : 1.0;
    product_ = {scale * next.along, scale * next.across};
  }
  double angle() const { return product_.angle() + 2.0 * std::numbers::pi * rounds_; }

 private:
  Turn product_{};
  int rounds_ = 0;
};

/// An edge of a border, between vertices.
struct Directed {
  std::uint32_t from, to;
  int times;
};

/// Each where the one before it ends, as long as there is one.
std::vector<Directed> in_chains(std::vector<Directed> edges) {
  std::stable_sort(edges.begin(), edges.end(), [](const Directed& a, const Directed& b) { return a.from < b.from; });
  std::vector<Directed> chained;
  chained.reserve(edges.size());
  std::vector<char> used(edges.size(), 0);
  std::vector<size_t> unused(edges.size());  // of edges from one vertex, at their first: which may be the next
  std::iota(unused.begin(), unused.end(), size_t{0});
  const auto next_from = [&](std::uint32_t vertex) {
    const auto found =
        std::lower_bound(edges.begin(), edges.end(), vertex, [](const Directed& edge, std::uint32_t v) { return edge.from < v; });
    if (found == edges.end()) return edges.size();
    size_t& next = unused[static_cast<size_t>(found - edges.begin())];
    while (next < edges.size() && edges[next].from == vertex && used[next]) ++next;
    return next < edges.size() && edges[next].from == vertex ? next : edges.size();
  };
  for (size_t first = 0; first < edges.size(); ++first)
    for (size_t i = used[first] ? edges.size() : first; i < edges.size(); i = next_from(edges[i].to)) {
      used[i] = 1;
      chained.push_back(edges[i]);
    }
  return chained;
}

std::vector<EdgeGroup> in_groups(const std::vector<Winding::BorderEdge>& border) {
  std::vector<EdgeGroup> groups((border.size() + 7) / 8);
  for (size_t i = 0; i < 8 * groups.size(); ++i) {
    const Winding::BorderEdge& edge = border[std::min(i, border.size() - 1)];
    EdgeGroup& group = groups[i / 8];
    for (int axis = 0; axis < 3; ++axis) group.a[axis][i % 8] = edge.a[axis], group.b[axis][i % 8] = edge.b[axis];
    group.times[i % 8] = i < border.size() ? edge.multiplicity : 0.0;
  }
  return groups;
}

}  // namespace

Winding::Winding(const TriangleMesh& mesh) : Winding(mesh, first_at_position(mesh.positions)) {}

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
      AngleSum halves;
      double repeated = 0.0;
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        const std::uint32_t t = order_[i];
        const Turn half = half_solid_angle(point, corner(t, 0), corner(t, 1), corner(t, 2));
        if (times(t) == 1)
          halves.add(half);
        else
          repeated += times(t) * half.angle();
      }
      sum += (halves.angle() + repeated) / (2.0 * std::numbers::pi);
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
  std::vector<Directed> edges;
  // Each start moves on to where the next vertex starts.
  visit([&](std::uint32_t low, const Use& use) { uses[ends[low]++] = use; });
  for (std::uint32_t low = 0, start = 0; low + 1 < ends.size(); start = ends[low++]) {
    const std::span<Use> own = std::span(uses).subspan(start, ends[low] - start);
    std::sort(own.begin(), own.end(), [](const Use& a, const Use& b) { return a.high < b.high; });
    for (size_t i = 0; i < own.size();) {
      int net = 0;
      size_t end = i;
      for (; end < own.size() && own[end].high == own[i].high; ++end) net += own[end].times;
      if (net > 0) edges.push_back({low, own[i].high, net});
      if (net < 0) edges.push_back({own[i].high, low, -net});
      i = end;
    }
  }
  for (const Directed& edge : in_chains(std::move(edges)))
    border_.push_back({mesh_.positions[edge.from], mesh_.positions[edge.to], edge.times});
  border_groups_ = in_groups(border_);
}

}  // namespace limn
