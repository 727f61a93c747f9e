#pragma once
// Internal: which branches of a field, and which of their seams, bounds leave in boxes, sixteen boxes at a time.

#include <memory>
#include <span>
#include <vector>

#include "raymarch/truth/field_cells.h"
#include "raymarch/truth/scope_tree.h"
#include "sdf/tape_lanes.h"

namespace limn {

/// Steps of a branch's tape: all of them, or those that matter in a box.
using SharedSteps = std::shared_ptr<const std::vector<TapeStep>>;

/// The branches that may matter to the surface in a box, each with the steps that matter there.
struct CellScope {
  std::vector<int> branches{};
  std::vector<SharedSteps> steps{};
  ScopeTree tree{};
};

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

/// The tapes of a search's branches; made once, used by many threads.
struct CellTapes {
  explicit CellTapes(const SharpField& sharp);
  std::vector<FieldTape> tapes{};
  CellScope whole{};  ///< All branches with all steps.
};

struct ModelledCells;  // raymarch/truth/cell_models.h

/// Bounds over boxes, for one thread.
class CellBounds {
 public:
  CellBounds(const CellSearch& search, const CellTapes& tapes) : search_(search), tapes_(tapes) {}

  /// What cubes of one size hold, at most kLanes of them; all of them within what the scope is for.
  void find(const CellScope& scope, std::span<const glm::dvec3> lower, double side, std::span<Survivors> found);
  /// The same without a view, of eight cubes at most; false where no tape gives derivatives. `innermost`: the cubes are not divided.
  bool model(const CellScope& scope, std::span<const glm::dvec3> lower, double side, bool innermost, ModelledCells& out);
  /// The scope for what lies in the i-th of the boxes that were asked for last.
  CellScope inside(const CellScope& scope, const Survivors& found, size_t lane) const;

 private:
  /// The slope towards the eye is all that is asked for then.
  bool sees_silhouettes_only() const { return search_.families == 1u && search_.levels[0] == 0.0; }
  void set_boxes(std::span<const glm::dvec3> lower, double side);
  void bound_branch(const CellScope& scope, size_t at, bool facing);
  void find_in(const CellScope& scope, size_t lane, Survivors& found);
  bool values_hold_surface(const CellScope& scope, size_t lane);
  void find_zeros(const CellScope& scope, size_t lanes, std::array<std::vector<size_t>, 8>& relevant,
                  std::array<std::vector<size_t>, 8>& zero);
  Interval value_in(const CellScope& scope, size_t at, int lane) const;
  std::array<Interval, kCurveFamilies> facing_in(size_t at, size_t lane) const;

  const CellSearch& search_;
  const CellTapes& tapes_;
  TapeScratch scratch_{};
  LaneBeams beams_{};
  double half_ = 0.0;
  /// Of a branch of the scope.
  struct Bounds {
    LaneBounds of{};
    std::array<LaneBounds, 3> along{};  ///< The axes, where levels other than 0 are looked for.
    bool facing = false;                ///< Its slopes are known.
    std::vector<TapeChoice> choices{};
  };
  std::vector<Bounds> bounds_{};
  std::vector<Interval> values_{};
  ScopeBounds nodes_{};
  std::vector<size_t> candidates_{};
  std::vector<std::array<Interval, kCurveFamilies>> facing_{};
};

/// Evaluators of branches with their programs shortened for a box, each made when it is first asked for.
class BranchEvaluators {
 public:
  BranchEvaluators() = default;
  BranchEvaluators(const SharpField& sharp, const Box& box);
  /// For boxes within the outer one's, which outlives this.
  explicit BranchEvaluators(BranchEvaluators* outer);
  void restrict_to(const Box& box);
  FieldEvaluator& at(int branch);

 private:
  const SharpField* sharp_ = nullptr;
  BranchEvaluators* outer_ = nullptr;
  Box box_{};
  std::vector<FieldEvaluator*> made_{};
  std::vector<std::unique_ptr<FieldEvaluator>> owned_{};
};

/// The branches that may be surface somewhere in the box; evaluators are those of all branches.
std::vector<size_t> relevant_branches(const SharpField& sharp, std::vector<FieldEvaluator>& evaluators, const Box& box);

}  // namespace limn
