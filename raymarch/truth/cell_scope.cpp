#include "raymarch/truth/cell_scope.h"

#include <algorithm>

#include "sdf/field_program.h"
#include "sdf/number.h"
#include "sdf/number_interval.h"

namespace limn {
namespace {

constexpr double kViewMargin = 1e-9, kRounding = 1e-13;
constexpr double kWider = 1.0 + 1e-9;  // boxes, for the rounding of their corners
constexpr size_t kWorthPruning = 6;    // steps

/// N.V - c times the gradient's length and the view vector's, of whose sign alone anything is asked: no division is needed.
std::array<Interval, kCurveFamilies> facing_bounds(const CellSearch& search, const std::array<Interval, 3>& view,
                                                   const std::array<Interval, 3>& g) {
  const Interval gradient_length = norm(g[0], g[1], g[2]);
  const Interval view_length = search.camera.projection == Projection::perspective ? norm(view[0], view[1], view[2]) : Interval{1.0, 1.0};
  const Interval product = g[0] * view[0] + g[1] * view[1] + g[2] * view[2];
  const Interval lengths = gradient_length * view_length;
  const double margin = kViewMargin * lengths.upper;
  std::array<Interval, kCurveFamilies> result;
  for (size_t family = 0; family < kCurveFamilies; ++family) {
    const Interval h = product - lengths * search.levels[family];
    result[family] = {h.lower - margin, h.upper + margin};
  }
  return result;
}

bool apart(const Interval& a, const Interval& b) { return (a.lower > 0.0 && b.lower > 0.0) || (a.upper < 0.0 && b.upper < 0.0); }

void set_direction(LaneBeams& beams, const glm::dvec3& direction, double spread) {
  for (int axis = 0; axis < 3; ++axis) {
    for (int i = 0; i < kLanes; ++i) beams.rays.direction[axis][i] = direction[axis];
    beams.direction_spread[axis] = glm::dvec3(0.0);
    beams.direction_spread[axis][axis] = spread;
  }
}

}  // namespace

CellTapes::CellTapes(const SharpField& sharp) {
  tapes.reserve(sharp.branches.size());
  for (const Field& branch : sharp.branches) {
    tapes.emplace_back(branch);
    whole.branches.push_back(static_cast<int>(whole.branches.size()));
    whole.steps.push_back(std::make_shared<const std::vector<TapeStep>>(tapes.back().steps));
  }
  whole.tree = tree_of(sharp);
}

void CellBounds::set_boxes(std::span<const glm::dvec3> lower, double side) {
  half_ = 0.5 * side * kWider;
  beams_.lanes = static_cast<int>(lower.size());
  const double radius = std::sqrt(3.0) * half_ * kWider;
  for (int axis = 0; axis < 3; ++axis) {
    beams_.origin_spread[axis] = glm::dvec3(0.0);
    beams_.origin_spread[axis][axis] = half_;
  }
  for (int i = 0; i < kLanes; ++i) {
    const glm::dvec3 center = lower[std::min(static_cast<size_t>(i), lower.size() - 1)] + 0.5 * side;
    for (int axis = 0; axis < 3; ++axis) beams_.rays.origin[axis][i] = center[axis];
    beams_.middle[i] = beams_.half[i] = 0.0;
    beams_.radius[i] = radius;
  }
}

/// With `facing`, the slope towards the eye as well: the gradient times a view vector that is as long as the eye is far away. Where other
/// levels of N.V than 0 are asked for, the slopes along the axes.
void CellBounds::bound_branch(const CellScope& scope, size_t at, bool facing) {
  const FieldTape& tape = tapes_.tapes[static_cast<size_t>(scope.branches[at])];
  const std::vector<TapeStep>& steps = *scope.steps[at];
  Bounds& bounds = bounds_[at];
  bounds.facing = facing;
  if (!facing) {
    set_direction(beams_, glm::dvec3(0.0), 0.0);
    tape_bounds(tape, steps, beams_, scratch_, bounds.of);
  } else if (sees_silhouettes_only()) {
    const bool perspective = search_.camera.projection == Projection::perspective;
    set_direction(beams_, search_.camera.world_from_camera[2], perspective ? half_ : 0.0);
    for (int axis = 0; axis < 3 && perspective; ++axis) {
      for (int i = 0; i < kLanes; ++i) beams_.rays.direction[axis][i] = search_.camera.eye[axis] - beams_.rays.origin[axis][i];
    }
    tape_slope_bounds(tape, steps, beams_, scratch_, bounds.of);
  } else {
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 direction(0.0);
      direction[axis] = 1.0;
      set_direction(beams_, direction, 0.0);
      tape_slope_bounds(tape, steps, beams_, scratch_, bounds.along[static_cast<size_t>(axis)]);
    }
    bounds.of = bounds.along[0];
  }
  bounds.choices.assign(scratch_.choices.begin(), scratch_.choices.end());
}

std::array<Interval, kCurveFamilies> CellBounds::facing_in(size_t at, size_t lane) const {
  const Bounds& bounds = bounds_[at];
  const auto i = static_cast<int>(lane);
  const bool perspective = search_.camera.projection == Projection::perspective;
  std::array<Interval, 3> view{};
  for (int axis = 0; axis < 3; ++axis) {
    const double along = perspective ? search_.camera.eye[axis] - beams_.rays.origin[axis][i] : search_.camera.world_from_camera[2][axis];
    const double reach = perspective ? half_ + kViewMargin * half_ : 0.0;
    view[static_cast<size_t>(axis)] = {along - reach, along + reach};
  }
  if (sees_silhouettes_only()) {
    const double margin = kViewMargin * search_.sharp.branches[0].traits().lipschitz * norm(view[0], view[1], view[2]).upper;
    return {Interval{bounds.of.slope_lower[i] - margin, bounds.of.slope_upper[i] + margin}, Interval{}};
  }
  std::array<Interval, 3> gradient{};
  for (size_t axis = 0; axis < 3; ++axis) gradient[axis] = {bounds.along[axis].slope_lower[i], bounds.along[axis].slope_upper[i]};
  return facing_bounds(search_, view, gradient);
}

/// The tighter of the tape's bounds and of how far f goes from its value in the middle, by the branch's Lipschitz constant and, where they
/// are known, by its slopes in the box (the mean value theorem; of functions with creases Lebourg's 1975): sums of powers that nearly
/// cancel out have bounds many times as wide.
Interval CellBounds::value_in(const CellScope& scope, size_t at, int lane) const {
  const Bounds& bounds = bounds_[at];
  const LaneBounds& of = bounds.of;
  const double lipschitz = search_.sharp.branches[static_cast<size_t>(scope.branches[at])].traits().lipschitz;
  const auto& origin = beams_.rays.origin;
  double reach = lipschitz * beams_.radius[lane];
  if (bounds.facing && !sees_silhouettes_only()) {
    double along = 0.0;
    for (const LaneBounds& axis : bounds.along)
      along += half_ * std::max(std::fabs(axis.slope_lower[lane]), std::fabs(axis.slope_upper[lane]));
    if (along < reach) reach = along;
  }
  const double extent = lipschitz * (std::fabs(origin[0][lane]) + std::fabs(origin[1][lane]) + std::fabs(origin[2][lane])),
               middle = of.middle[lane], slack = kRounding * (std::fabs(middle) + reach + extent);
  return tighter({of.lower[lane], of.upper[lane]}, {middle - reach - slack, middle + reach + slack});
}

/// Fills `values_`, and of `nodes_` which of the scope's branches are relevant in the box; false where it holds no surface.
bool CellBounds::values_hold_surface(const CellScope& scope, size_t lane) {
  values_.resize(scope.branches.size());
  for (size_t at = 0; at < values_.size(); ++at) values_[at] = value_in(scope, at, static_cast<int>(lane));
  return find_relevant(scope.tree, values_, nodes_);
}

void CellBounds::find_in(const CellScope& scope, size_t lane, Survivors& found) {
  found.relevant.clear();
  found.branches.clear();
  found.seams.clear();
  const auto i = static_cast<int>(lane);
  if (!values_hold_surface(scope, lane)) return;
  candidates_.clear();
  facing_.clear();
  for (size_t at = 0; at < values_.size(); ++at) {
    if (!nodes_.relevant[at]) continue;
    found.relevant.push_back(at);
    if (!values_[at].contains(0.0)) continue;
    if (!bounds_[at].facing) {
      bound_branch(scope, at, true);
      values_[at] = value_in(scope, at, i);
      if (!values_[at].contains(0.0)) continue;
    }
    candidates_.push_back(at);
    facing_.push_back(facing_in(at, lane));
    LiveBranch live{at, 0};
    for (size_t family = 0; family < kCurveFamilies; ++family) {
      if ((search_.families >> family & 1u) && facing_.back()[family].contains(0.0)) live.families |= 1u << family;
    }
    if (live.families != 0 && !search_.only_seam) found.branches.push_back(live);
  }
  for (size_t k = 1; k < candidates_.size(); ++k) {
    for (size_t j = 0; j < k; ++j) {
      const std::pair<int, int> pair{scope.branches[candidates_[j]], scope.branches[candidates_[k]]};
      if (search_.only_seam && pair != *search_.only_seam) continue;
      bool live = search_.whole_seams;
      for (size_t family = 0; family < kCurveFamilies; ++family) {
        live = live || ((search_.families >> family & 1u) && !apart(facing_[j][family], facing_[k][family]));
      }
      if (live) found.seams.push_back({candidates_[j], candidates_[k]});
    }
  }
}

void CellBounds::find(const CellScope& scope, std::span<const glm::dvec3> lower, double side, std::span<Survivors> found) {
  set_boxes(lower, side);
  bounds_.resize(std::max(bounds_.size(), scope.branches.size()));
  const bool alone = scope.branches.size() == 1;
  for (size_t at = 0; at < scope.branches.size(); ++at) bound_branch(scope, at, alone);
  for (size_t lane = 0; lane < lower.size(); ++lane) find_in(scope, lane, found[lane]);
}

CellScope CellBounds::inside(const CellScope& scope, const Survivors& found, size_t lane) const {
  CellScope inner;
  inner.tree = narrowed(scope.tree, found.relevant);
  for (const size_t at : found.relevant) {
    inner.branches.push_back(scope.branches[at]);
    const SharedSteps& steps = scope.steps[at];
    const std::vector<TapeChoice>& choices = bounds_[at].choices;
    const auto mask = static_cast<std::uint16_t>(1u << lane);
    const bool any = steps->size() >= kWorthPruning && std::any_of(choices.begin(), choices.end(), [&](const TapeChoice& choice) {
                       return ((choice.idle[0] | choice.idle[1] | choice.idle[2]) & mask) != 0;
                     });
    if (!any) {
      inner.steps.push_back(steps);
      continue;
    }
    auto pruned = std::make_shared<std::vector<TapeStep>>();
    const FieldTape& tape = tapes_.tapes[static_cast<size_t>(scope.branches[at])];
    prune_tape(*steps, choices, mask, tape.registers, TapeUse::bounds, *pruned);
    inner.steps.push_back(std::move(pruned));
  }
  return inner;
}

BranchEvaluators::BranchEvaluators(const SharpField& sharp, const Box& box)
    : sharp_(&sharp), box_(box), made_(sharp.branches.size(), nullptr), owned_(sharp.branches.size()) {}

BranchEvaluators::BranchEvaluators(BranchEvaluators* outer)
    : outer_(outer), box_(outer->box_), made_(outer->made_.size(), nullptr), owned_(outer->made_.size()) {}

void BranchEvaluators::restrict_to(const Box& box) {
  box_ = box;
  std::fill(made_.begin(), made_.end(), nullptr);
}

FieldEvaluator& BranchEvaluators::at(int branch) {
  const auto i = static_cast<size_t>(branch);
  if (made_[i] != nullptr) return *made_[i];
  if (outer_ == nullptr) {
    owned_[i] = std::make_unique<FieldEvaluator>(FieldEvaluator(sharp_->branches[i]).restricted(box_));
    return *(made_[i] = owned_[i].get());
  }
  FieldEvaluator& outer = outer_->at(branch);
  const Field field = outer.restricted(box_);
  if (&field.program() == &outer.field().program()) return *(made_[i] = &outer);
  owned_[i] = std::make_unique<FieldEvaluator>(field);
  return *(made_[i] = owned_[i].get());
}

std::vector<size_t> relevant_branches(const SharpField& sharp, std::vector<FieldEvaluator>& evaluators, const Box& box) {
  std::vector<Interval> values;
  values.reserve(evaluators.size());
  for (FieldEvaluator& evaluator : evaluators) values.push_back(evaluator.bounds(box));
  ScopeBounds bounds;
  find_relevant(tree_of(sharp), values, bounds);
  std::vector<size_t> result;
  for (size_t i = 0; i < bounds.relevant.size(); ++i) {
    if (bounds.relevant[i]) result.push_back(i);
  }
  return result;
}

}  // namespace limn
