#pragma once
// Internal: which branches of a field, and which of their seams, bounds leave in a box.

#include <memory>
#include <vector>

#include "raymarch/truth/field_cells.h"

namespace limn {

/// The branches that may matter to the surface in a box, each with an evaluator that is right there and around it.
struct CellScope {
  std::vector<int> branches{};
  std::vector<FieldEvaluator*> evaluators{};
  std::vector<std::unique_ptr<FieldEvaluator>> owned{};
};
CellScope whole_scope(const SharpField& sharp);
/// With programs shortened for what is within `reach` of the box.
CellScope shortened(const CellScope& scope, const Box& box, double reach);

/// Indices into a scope.
struct LiveBranch {
  size_t at = 0;
  FamilyMask families = 0;
};
struct LiveSeam {
  size_t first = 0, second = 0;
};

/// What a box may hold: pieces of curves on branches, and seams that a level of N.V lies between the sides of.
struct Survivors {
  std::vector<size_t> relevant{};  ///< Into the scope: what may be surface somewhere in the box.
  std::vector<LiveBranch> branches{};
  std::vector<LiveSeam> seams{};
  bool empty() const { return branches.empty() && seams.empty(); }
};
Survivors survivors_in(const CellSearch& search, const CellScope& scope, const Box& box);
/// The branches that may be surface somewhere in the box; evaluators are those of all branches.
std::vector<size_t> relevant_branches(const SharpField& sharp, std::vector<FieldEvaluator>& evaluators, const Box& box);
/// Only the relevant branches.
CellScope narrowed(const CellScope& scope, const std::vector<size_t>& relevant);

}  // namespace limn
