#pragma once
// Internal: which branches of a field may matter to its surface in a box, told from bounds of their values there.

#include <span>
#include <vector>

#include "raymarch/truth/branches.h"
#include "sdf/number_interval.h"

namespace limn {

/// A SharpNode of the tree that is left of some branches: nodes with one of their sides alone are gone, and said in the other.
struct ScopeNode {
  bool maximum = false;
  int left = -1, right = -1;  ///< Nodes; -1 in a branch's.
  int at = -1;                ///< Which of the branches; -1 elsewhere.
  /// Below a maximum (minimum) whose other side is gone: without influence where negative (positive) all over.
  bool below_maximum = false, below_minimum = false;
};

/// Children before parents, the last is the root; empty without branches.
struct ScopeTree {
  std::vector<ScopeNode> nodes{};
  double epsilon = 0.0;  ///< So far apart faces that coincide may count (SharpField::epsilon times its branches).
};

/// Of all branches, as they are numbered.
ScopeTree tree_of(const SharpField& sharp);
/// Of some of a tree's branches, ascending, which become 0, 1, ...
ScopeTree narrowed(const ScopeTree& tree, std::span<const size_t> kept);

/// Memory of one thread.
struct ScopeBounds {
  std::vector<Interval> of_nodes{};
  std::vector<char> relevant{};  ///< Of each branch: whether it may matter in the box.
};
/// Fills bounds.relevant from the branches' values over the box; false where it holds no surface.
bool find_relevant(const ScopeTree& tree, std::span<const Interval> of_branches, ScopeBounds& bounds);

}  // namespace limn
