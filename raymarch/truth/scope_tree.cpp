#include "raymarch/truth/scope_tree.h"

#include <algorithm>

namespace limn {
namespace {

/// A side is without influence where the other one decides: on the value, or on where it is zero.
void mark_relevant(const ScopeTree& tree, size_t at, ScopeBounds& bounds) {
  const ScopeNode& node = tree.nodes[at];
  const Interval& own = bounds.of_nodes[at];
  if (node.below_maximum && own.upper < -tree.epsilon) return;
  if (node.below_minimum && own.lower > tree.epsilon) return;
  if (node.at >= 0) {
    bounds.relevant[static_cast<size_t>(node.at)] = 1;
    return;
  }
  const auto left = static_cast<size_t>(node.left), right = static_cast<size_t>(node.right);
  const auto matters = [&](size_t one, size_t other) {
    const Interval &a = bounds.of_nodes[one], &b = bounds.of_nodes[other];
    if (node.maximum) return !(a.upper < -tree.epsilon) && !(a.upper < b.lower - tree.epsilon);
    return !(a.lower > tree.epsilon) && !(a.lower > b.upper + tree.epsilon);
  };
  // Where both are decided against, the box is empty of surface, and what remains says so.
  if (matters(left, right)) mark_relevant(tree, left, bounds);
  if (matters(right, left)) mark_relevant(tree, right, bounds);
}

}  // namespace

ScopeTree tree_of(const SharpField& sharp) {
  ScopeTree tree{{}, sharp.epsilon * static_cast<double>(sharp.branches.size())};
  tree.nodes.reserve(sharp.nodes.size());
  for (const SharpNode& node : sharp.nodes) tree.nodes.push_back({node.maximum, node.left, node.right, node.branch});
  return tree;
}

ScopeTree narrowed(const ScopeTree& tree, std::span<const size_t> kept) {
  ScopeTree inner{{}, tree.epsilon};
  if (kept.empty()) return inner;
  std::vector<int> number(kept.back() + 1, -1), place(tree.nodes.size(), -1);
  for (size_t k = 0; k < kept.size(); ++k) number[kept[k]] = static_cast<int>(k);
  for (size_t i = 0; i < tree.nodes.size(); ++i) {
    ScopeNode node = tree.nodes[i];
    if (node.at >= 0) {
      const auto at = static_cast<size_t>(node.at);
      node.at = at < number.size() ? number[at] : -1;
      if (node.at < 0) continue;
    } else {
      node.left = place[static_cast<size_t>(node.left)];
      node.right = place[static_cast<size_t>(node.right)];
      if (node.left < 0 && node.right < 0) continue;
      if (node.left < 0 || node.right < 0) {
        place[i] = std::max(node.left, node.right);
        ScopeNode& only = inner.nodes[static_cast<size_t>(place[i])];
        only.below_maximum = only.below_maximum || node.below_maximum || node.maximum;
        only.below_minimum = only.below_minimum || node.below_minimum || !node.maximum;
        continue;
      }
    }
    place[i] = static_cast<int>(inner.nodes.size());
    inner.nodes.push_back(node);
  }
  return inner;
}

bool find_relevant(const ScopeTree& tree, std::span<const Interval> of_branches, ScopeBounds& bounds) {
  bounds.relevant.assign(of_branches.size(), 0);
  if (tree.nodes.empty()) return false;
  bounds.of_nodes.resize(tree.nodes.size());
  for (size_t i = 0; i < tree.nodes.size(); ++i) {
    const ScopeNode& node = tree.nodes[i];
    if (node.at >= 0) {
      bounds.of_nodes[i] = of_branches[static_cast<size_t>(node.at)];
      continue;
    }
    const Interval &a = bounds.of_nodes[static_cast<size_t>(node.left)], &b = bounds.of_nodes[static_cast<size_t>(node.right)];
    bounds.of_nodes[i] = node.maximum ? maximum(a, b) : minimum(a, b);
  }
  mark_relevant(tree, tree.nodes.size() - 1, bounds);
  return !(bounds.of_nodes.back().lower > tree.epsilon) && !(bounds.of_nodes.back().upper < -tree.epsilon);
}

}  // namespace limn
