#include "subdiv/triangle_tree.h"

#include <algorithm>

#include "sdf/parallel.h"
#include "subdiv/triangle_box.h"

namespace limn {
namespace {

bool meet(const Box& a, const Box& b) {
  return glm::all(glm::lessThanEqual(a.lower, b.upper)) && glm::all(glm::greaterThanEqual(a.upper, b.lower));
}

bool holds(const Box& outer, const Box& inner) {
  return glm::all(glm::lessThanEqual(outer.lower, inner.lower)) && glm::all(glm::greaterThanEqual(outer.upper, inner.upper));
}

void add(const FacetBounds& other, FacetBounds& facets) {
  facets.lower = glm::min(facets.lower, other.lower), facets.upper = glm::max(facets.upper, other.upper);
  facets.longest_edge = std::max(facets.longest_edge, other.longest_edge);
}

}  // namespace

struct TriangleTree::Builder {
  TriangleTree& tree;
  static constexpr std::uint32_t kLeaf = 4;
  static constexpr std::uint32_t kAlone = 4096;  // as many are one thread's

  struct TreeSizes {
    size_t here = 1, of_one_more = 1;
  };
  /// How many nodes the trees of so many leaves and of one more have.
  static TreeSizes sizes(std::uint32_t count) {
    if (count < kLeaf) return {};
    const auto [half, half_and_one] = sizes(count / 2);
    const bool odd = count % 2 != 0;
    return {count <= kLeaf ? 1 : odd ? 1 + half + half_and_one : 1 + 2 * half, odd ? 1 + 2 * half_and_one : 1 + half + half_and_one};
  }

  void make_leaf(std::uint32_t first, std::uint32_t count, Node& node) const {
    node.first = first, node.count = count;
    for (std::uint32_t i = first; i < first + count; ++i) {
      const Leaf& leaf = tree.leaves_[i];
      node.box = merge(node.box, leaf.box);
      if (leaf.normal != glm::dvec3(0.0)) add({leaf.normal, leaf.normal, leaf.longest_edge}, node.facets);
    }
  }

  /// Halves along the longest side of the boxes' middles. The tree's root is node `number`; its left half follows, then its right half.
  void build(size_t number, std::uint32_t first, std::uint32_t count) const {
    Node& node = tree.nodes_[number];
    if (count <= kLeaf) return make_leaf(first, count, node);
    const auto begin = tree.leaves_.begin() + first, end = begin + count;
    Box middles;
    for (auto leaf = begin; leaf != end; ++leaf) middles = include(middles, leaf->box.center());
    const glm::dvec3 size = middles.size();
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::uint32_t half = count / 2;
    std::nth_element(begin, begin + half, end, [axis](const Leaf& a, const Leaf& b) {
      const double x = a.box.center()[axis], y = b.box.center()[axis];
      return x != y ? x < y : a.triangle < b.triangle;
    });
    const size_t left = number + 1, right = left + sizes(half).here;
    node.right = static_cast<std::uint32_t>(right);
    if (count > kAlone) {
      parallel_invoke([&] { build(left, first, half); }, [&] { build(right, first + half, count - half); });
    } else {
      build(left, first, half);
      build(right, first + half, count - half);
    }
    const Node &a = tree.nodes_[left], &b = tree.nodes_[right];
    node.box = merge(a.box, b.box);
    add(a.facets, node.facets), add(b.facets, node.facets);
  }
};

TriangleTree::TriangleTree(const TriangleMesh& mesh) {
  leaves_.resize(mesh.triangles.size());
  parallel_parts(mesh.triangles.size(), size_t{4096}, [&](const IndexRange<size_t>& range) {
    for (size_t i = range.begin(); i < range.end(); ++i) {
      const glm::uvec3& t = mesh.triangles[i];
      Leaf& leaf = leaves_[i];
      leaf.triangle = static_cast<std::uint32_t>(i);
      const glm::dvec3 a = mesh.positions[t.x], b = mesh.positions[t.y], c = mesh.positions[t.z];
      leaf.box = {glm::min(glm::min(a, b), c), glm::max(glm::max(a, b), c)};
      leaf.longest_edge = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
      const glm::dvec3 area = glm::cross(b - a, c - a);
      if (const double length = glm::length(area); length > 0.0) leaf.normal = area / length;
    }
  });
  if (leaves_.empty()) return;
  const auto count = static_cast<std::uint32_t>(leaves_.size());
  nodes_.resize(Builder::sizes(count).here);
  Builder{*this}.build(0, 0, count);
}

template <class VisitNode, class VisitLeaf>
bool TriangleTree::visit(const Box& box, const VisitNode& visit_node, const VisitLeaf& visit_leaf) const {
  std::array<std::uint32_t, 64> waiting;
  size_t count = 0;
  if (!nodes_.empty()) waiting[count++] = 0;
  while (count > 0) {
    const std::uint32_t number = waiting[--count];
    const Node& node = nodes_[number];
    if (!meet(node.box, box) || !visit_node(node, holds(box, node.box))) continue;
    if (node.count == 0) {
      waiting[count++] = node.right;
      waiting[count++] = number + 1;
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
      if (meet(leaves_[i].box, box) && !visit_leaf(leaves_[i])) return false;
  }
  return true;
}

void TriangleTree::find(const Box& box, std::vector<std::uint32_t>& found) const {
  visit(
      box, [](const Node&, bool) { return true; },
      [&](const Leaf& leaf) {
        found.push_back(leaf.triangle);
        return true;
      });
}

bool TriangleTree::any_meets(const TriangleMesh& mesh, const Box& box) const {
  return !visit(
      box, [](const Node&, bool) { return true; },
      [&](const Leaf& leaf) {
        if (holds(box, leaf.box)) return false;
        const glm::uvec3& t = mesh.triangles[leaf.triangle];
        return !triangle_meets_box({mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]}, box.lower, box.upper);
      });
}

FacetBounds TriangleTree::facets(const Box& box) const {
  FacetBounds facets;
  visit(
      box,
      [&](const Node& node, bool inside) {
        if (inside) add(node.facets, facets);
        return !inside;
      },
      [&](const Leaf& leaf) {
        if (leaf.normal != glm::dvec3(0.0)) add({leaf.normal, leaf.normal, leaf.longest_edge}, facets);
        return true;
      });
  return facets;
}

Interval TriangleTree::facing(const Box& box, const glm::dvec3& direction) const {
  Interval range{2.0, -2.0};
  visit(
      box,
      [&](const Node& node, bool) {
        // Nothing in it is beyond what is known.
        if (node.facets.empty()) return false;
        const glm::dvec3 a = direction * node.facets.lower, b = direction * node.facets.upper;
        const glm::dvec3 low = glm::min(a, b), high = glm::max(a, b);
        return low.x + low.y + low.z < range.lower || high.x + high.y + high.z > range.upper;
      },
      [&](const Leaf& leaf) {
        if (leaf.normal == glm::dvec3(0.0)) return true;
        const double along = glm::dot(direction, leaf.normal);
        range = {std::min(range.lower, along), std::max(range.upper, along)};
        return true;
      });
  return range;
}

}  // namespace limn
