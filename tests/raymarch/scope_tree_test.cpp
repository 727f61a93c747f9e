// Which branches may matter in a box, over trees of random unions and intersections.

#include "raymarch/truth/scope_tree.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/random_seed.h"
#include "tests/sdf/random_field.h"

namespace limn {
namespace {

/// A tree over `count` branches, which have no fields.
SharpField random_tree(Random& random, int count) {
  SharpField sharp;
  sharp.epsilon = 1e-4;
  std::vector<int> open;
  for (int i = 0; i < count; ++i) {
    open.push_back(static_cast<int>(sharp.nodes.size()));
    sharp.node_of.push_back(open.back());
    sharp.nodes.push_back({.branch = i});
    sharp.branches.push_back(make_shape("sphere"));
  }
  while (open.size() > 1) {
    const auto take = [&] {
      const auto at = static_cast<size_t>(random.index(static_cast<int>(open.size())));
      const int node = open[at];
      open.erase(open.begin() + static_cast<std::ptrdiff_t>(at));
      return node;
    };
    const int left = take(), right = take(), whole = static_cast<int>(sharp.nodes.size());
    sharp.nodes.push_back({.maximum = random.index(2) == 0, .left = left, .right = right});
    for (const int side : {left, right}) sharp.nodes[static_cast<size_t>(side)].parent = whole;
    open.push_back(whole);
  }
  return sharp;
}

/// Intervals that reach across 0 in a third of all cases.
std::vector<Interval> random_intervals(Random& random, size_t count) {
  std::vector<Interval> intervals;
  for (size_t i = 0; i < count; ++i) {
    const double middle = random.uniform(-1.0, 1.0), half = random.uniform(0.0, 0.6);
    intervals.push_back({middle - half, middle + half});
  }
  return intervals;
}

/// The value of a node over the branches in `kept`; NaN where none of them lies below it.
double value_at(const SharpField& sharp, int at, const std::vector<double>& values, const std::vector<char>& kept) {
  const SharpNode& node = sharp.nodes[static_cast<size_t>(at)];
  if (node.branch >= 0) {
    const auto branch = static_cast<size_t>(node.branch);
    return kept[branch] ? values[branch] : std::nan("");
  }
  const double a = value_at(sharp, node.left, values, kept), b = value_at(sharp, node.right, values, kept);
  return node.maximum ? std::fmax(a, b) : std::fmin(a, b);  // the other where one is NaN
}

struct Bounded {
  bool known = false;
  Interval bounds{};
};
Bounded bounds_at(const SharpField& sharp, int at, const std::vector<Interval>& intervals, const std::vector<char>& kept) {
  const SharpNode& node = sharp.nodes[static_cast<size_t>(at)];
  if (node.branch >= 0) return {kept[static_cast<size_t>(node.branch)] != 0, intervals[static_cast<size_t>(node.branch)]};
  const Bounded a = bounds_at(sharp, node.left, intervals, kept), b = bounds_at(sharp, node.right, intervals, kept);
  if (!a.known || !b.known) return a.known ? a : b;
  const auto of = [&](double p, double q) { return node.maximum ? std::max(p, q) : std::min(p, q); };
  return {true, {of(a.bounds.lower, b.bounds.lower), of(a.bounds.upper, b.bounds.upper)}};
}

/// Node by node from the root, on the whole tree.
void mark(const SharpField& sharp, int at, const std::vector<Interval>& intervals, const std::vector<char>& kept, double epsilon,
          std::vector<char>& relevant) {
  const SharpNode& node = sharp.nodes[static_cast<size_t>(at)];
  if (!bounds_at(sharp, at, intervals, kept).known) return;
  if (node.branch >= 0) {
    relevant[static_cast<size_t>(node.branch)] = 1;
    return;
  }
  const auto side = [&](int one, int other) {
    const Bounded a = bounds_at(sharp, one, intervals, kept), b = bounds_at(sharp, other, intervals, kept);
    // As minima of what is negated.
    const double low = node.maximum ? -a.bounds.upper : a.bounds.lower, high = node.maximum ? -b.bounds.lower : b.bounds.upper;
    if (low > epsilon || (b.known && low > high + epsilon)) return;
    mark(sharp, one, intervals, kept, epsilon, relevant);
  };
  side(node.left, node.right);
  side(node.right, node.left);
}

TEST(ScopeTree, WhatIsLeftOutChangesNoSignAndNothingElseIsLookedAt) {
  const std::uint64_t seed = random_seed();
  Random random(seed);
  int signs = 0, left_out = 0, narrower = 0;
  for (int k = 0; k < 4000; ++k) {
    SCOPED_TRACE(fmt::format("seed {}, tree {}", seed, k));
    const int count = 1 + random.index(14);
    const SharpField sharp = random_tree(random, count);
    const auto branches = static_cast<size_t>(count);
    const double epsilon = sharp.epsilon * count;
    ScopeTree tree = tree_of(sharp);
    std::vector<size_t> scope(branches);
    for (size_t i = 0; i < branches; ++i) scope[i] = i;
    std::vector<char> kept(branches, 1);
    std::vector<Interval> intervals = random_intervals(random, branches);
    // Box within box, each with the branches that mattered in the one around it.
    for (int depth = 0; depth < 4; ++depth) {
      std::vector<Interval> own;
      for (const size_t branch : scope) own.push_back(intervals[branch]);
      ScopeBounds bounds;
      const bool holds = find_relevant(tree, own, bounds);
      std::vector<char> expected(branches, 0);
      mark(sharp, static_cast<int>(sharp.nodes.size()) - 1, intervals, kept, epsilon, expected);
      std::vector<size_t> left;
      for (size_t at = 0; at < scope.size(); ++at) {
        EXPECT_EQ(bounds.relevant[at], expected[scope[at]]) << "depth " << depth << ", branch " << scope[at];
        if (bounds.relevant[at]) left.push_back(at);
      }
      left_out += static_cast<int>(scope.size() - left.size());
      for (int trial = 0; trial < 8; ++trial) {
        std::vector<double> values;
        for (const Interval& i : intervals) values.push_back(random.uniform(i.lower, i.upper));
        const double whole = value_at(sharp, static_cast<int>(sharp.nodes.size()) - 1, values, std::vector<char>(branches, 1));
        const double part = value_at(sharp, static_cast<int>(sharp.nodes.size()) - 1, values, expected);
        if (!holds || left.empty() || std::abs(whole) <= epsilon || std::abs(part) <= epsilon) continue;
        EXPECT_EQ(whole > 0.0, part > 0.0) << "depth " << depth;
        ++signs;
      }
      if (!holds || left.empty()) break;
      tree = narrowed(tree, left);
      EXPECT_EQ(tree.nodes.size(), 2 * left.size() - 1);
      std::vector<size_t> inner;
      for (const size_t at : left) inner.push_back(scope[at]);
      scope = inner;
      kept = expected;
      for (Interval& i : intervals) {
        const double a = random.uniform(i.lower, i.upper), b = random.uniform(i.lower, i.upper);
        i = {std::min(a, b), std::max(a, b)};
      }
      narrower += depth > 0;
    }
    if (testing::Test::HasFailure()) return;
  }
  EXPECT_GT(signs, 4000);
  EXPECT_GT(left_out, 4000);
  EXPECT_GT(narrower, 200);
}

TEST(ScopeTree, HoldsNothingWithoutBranches) {
  ScopeBounds bounds;
  EXPECT_FALSE(find_relevant(narrowed(tree_of(split_branches(make_shape("sphere"), 1.0)), {}), {}, bounds));
  EXPECT_TRUE(bounds.relevant.empty());
}

TEST(SharpField, ValuesOfNodesAboveSomeBranchesAreAllThatChangesWithThem) {
  const std::uint64_t seed = random_seed();
  SCOPED_TRACE(fmt::format("seed {}", seed));
  Random random(seed);
  size_t spared = 0;
  for (int k = 0; k < 400; ++k) {
    const int count = 1 + random.index(20);
    const SharpField sharp = random_tree(random, count);
    std::vector<double> values, updated, all;
    for (int i = 0; i < count; ++i) values.push_back(random.uniform(-1.0, 1.0));
    node_values(sharp, values, updated);
    std::vector<size_t> changed;
    for (size_t i = 0; i < values.size(); ++i) {
      if (random.index(4) != 0) continue;
      values[i] = random.uniform(-1.0, 1.0);
      changed.push_back(i);
    }
    const std::vector<int> above = nodes_above(sharp, changed);
    update_node_values(sharp, values, above, updated);
    node_values(sharp, values, all);
    EXPECT_EQ(updated, all);
    spared += sharp.nodes.size() - above.size();
  }
  EXPECT_GT(spared, 1000u);
}

}  // namespace
}  // namespace limn
