#include "raymarch/truth/cell_scope.h"

#include <algorithm>

#include "sdf/field_program.h"
#include "sdf/number.h"
#include "sdf/number_interval.h"

namespace limn {
namespace {

constexpr double kViewMargin = 1e-9;

Interval coordinate(const Box& box, int axis) { return {box.lower[axis], box.upper[axis]}; }

/// N.V - c times the gradient's length and the view vector's, of whose sign alone anything is asked: no division is needed.
std::array<Interval, kCurveFamilies> facing_bounds(const CellSearch& search, const Box& box, const GradientBounds& bounds) {
  std::array<Interval, 3> view;
  const bool perspective = search.camera.projection == Projection::perspective;
  for (int axis = 0; axis < 3; ++axis) {
    const double eye = search.camera.eye[axis], backward = search.camera.world_from_camera[2][axis];
    view[static_cast<size_t>(axis)] = perspective ? -(coordinate(box, axis) - eye) : Interval{backward, backward};
  }
  const auto& g = bounds.gradient;
  const Interval gradient_length = norm(g[0], g[1], g[2]);
  const Interval view_length = perspective ? norm(view[0], view[1], view[2]) : Interval{1.0, 1.0};
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

std::vector<ScopeNode> whole_tree(const SharpField& sharp) {
  std::vector<ScopeNode> nodes;
  nodes.reserve(sharp.nodes.size());
  for (const SharpNode& node : sharp.nodes) nodes.push_back({node.maximum, node.left, node.right, node.branch});
  return nodes;
}

/// With the relevant branches only. Where one of two sides goes what asks whether the other one matters stays, once.
std::vector<ScopeNode> narrowed_tree(const std::vector<ScopeNode>& nodes, size_t branches, const std::vector<size_t>& relevant) {
  std::vector<int> branch_at(branches, -1), node_at(nodes.size(), -1);
  for (size_t k = 0; k < relevant.size(); ++k) branch_at[relevant[k]] = static_cast<int>(k);
  std::vector<ScopeNode> result;
  const auto add = [&](const ScopeNode& node) {
    result.push_back(node);
    return static_cast<int>(result.size()) - 1;
  };
  for (size_t i = 0; i < nodes.size(); ++i) {
    const ScopeNode& node = nodes[i];
    if (node.branch >= 0) {
      const int branch = branch_at[static_cast<size_t>(node.branch)];
      if (branch >= 0) node_at[i] = add({false, -1, -1, branch});
      continue;
    }
    const int left = node_at[static_cast<size_t>(node.left)], right = node.right < 0 ? -1 : node_at[static_cast<size_t>(node.right)];
    if (left >= 0 && right >= 0) {
      node_at[i] = add({node.maximum, left, right, -1});
    } else if (const int only = std::max(left, right); only >= 0) {
      const ScopeNode& below = result[static_cast<size_t>(only)];
      const bool asks_already = below.branch < 0 && below.right < 0 && below.maximum == node.maximum;
      node_at[i] = asks_already ? only : add({node.maximum, only, -1, -1});
    }
  }
  return result;
}

std::vector<Interval> node_bounds(const std::vector<ScopeNode>& nodes, const std::vector<Interval>& of_branches) {
  std::vector<Interval> bounds(nodes.size());
  for (size_t i = 0; i < nodes.size(); ++i) {
    const ScopeNode& node = nodes[i];
    if (node.branch >= 0) {
      bounds[i] = of_branches[static_cast<size_t>(node.branch)];
      continue;
    }
    const Interval& a = bounds[static_cast<size_t>(node.left)];
    if (node.right < 0) {
      bounds[i] = a;
      continue;
    }
    const Interval& b = bounds[static_cast<size_t>(node.right)];
    bounds[i] = node.maximum ? maximum(a, b) : minimum(a, b);
  }
  return bounds;
}

/// A side is without influence where the other one decides: on the value, or on where it is zero.
void mark_relevant(const std::vector<ScopeNode>& nodes, const std::vector<Interval>& bounds, double hair, int at,
                   std::vector<bool>& relevant) {
  const ScopeNode& node = nodes[static_cast<size_t>(at)];
  if (node.branch >= 0) {
    relevant[static_cast<size_t>(node.branch)] = true;
    return;
  }
  const auto matters = [&](int one, int other) {
    const Interval& a = bounds[static_cast<size_t>(one)];
    const Interval* b = other >= 0 ? &bounds[static_cast<size_t>(other)] : nullptr;
    if (node.maximum) return !(a.upper < -hair) && !(b != nullptr && a.upper < b->lower - hair);
    return !(a.lower > hair) && !(b != nullptr && a.lower > b->upper + hair);
  };
  // Where both are decided against, the box is empty of surface, and what remains says so.
  if (matters(node.left, node.right)) mark_relevant(nodes, bounds, hair, node.left, relevant);
  if (node.right >= 0 && matters(node.right, node.left)) mark_relevant(nodes, bounds, hair, node.right, relevant);
}

/// Branches of a scope, by the bounds of its nodes.
std::vector<size_t> relevant_in(const std::vector<ScopeNode>& nodes, const std::vector<Interval>& bounds, size_t branches, double hair) {
  std::vector<bool> relevant(branches, false);
  mark_relevant(nodes, bounds, hair, static_cast<int>(nodes.size()) - 1, relevant);
  std::vector<size_t> result;
  for (size_t i = 0; i < relevant.size(); ++i) {
    if (relevant[i]) result.push_back(i);
  }
  return result;
}

bool apart(const Interval& a, const Interval& b) { return (a.lower > 0.0 && b.lower > 0.0) || (a.upper < 0.0 && b.upper < 0.0); }

}  // namespace

CellScope whole_scope(const SharpField& sharp) {
  CellScope scope;
  scope.nodes = whole_tree(sharp);
  for (size_t i = 0; i < sharp.branches.size(); ++i) {
    scope.owned.push_back(std::make_unique<FieldEvaluator>(sharp.branches[i]));
    scope.branches.push_back(static_cast<int>(i));
    scope.evaluators.push_back(scope.owned.back().get());
  }
  return scope;
}

CellScope with_own_evaluators(const SharpField& sharp, const CellScope& scope) {
  CellScope result;
  result.branches = scope.branches;
  result.nodes = scope.nodes;
  for (const int branch : scope.branches) {
    result.owned.push_back(std::make_unique<FieldEvaluator>(sharp.branches[static_cast<size_t>(branch)]));
    result.evaluators.push_back(result.owned.back().get());
  }
  return result;
}

CellScope shortened(const CellScope& scope, const Box& box, double reach) {
  CellScope result;
  result.branches = scope.branches;
  result.nodes = scope.nodes;
  const Box around = dilate(box, reach);
  for (FieldEvaluator* evaluator : scope.evaluators) {
    result.evaluators.push_back(evaluator);
    if (evaluator->field().program().instructions.size() < 2) continue;
    const Field field = evaluator->restricted(around);
    if (&field.program() == &evaluator->field().program()) continue;
    result.owned.push_back(std::make_unique<FieldEvaluator>(field));
    result.evaluators.back() = result.owned.back().get();
  }
  return result;
}

CellScope narrowed(const CellScope& scope, const std::vector<size_t>& relevant) {
  CellScope result;
  for (const size_t i : relevant) {
    result.branches.push_back(scope.branches[i]);
    result.evaluators.push_back(scope.evaluators[i]);
  }
  result.nodes = narrowed_tree(scope.nodes, scope.branches.size(), relevant);
  return result;
}

std::vector<size_t> relevant_branches(const SharpField& sharp, std::vector<FieldEvaluator>& evaluators, const Box& box) {
  std::vector<Interval> values;
  values.reserve(evaluators.size());
  for (FieldEvaluator& evaluator : evaluators) values.push_back(evaluator.bounds(box));
  const std::vector<ScopeNode> nodes = whole_tree(sharp);
  return relevant_in(nodes, node_bounds(nodes, values), values.size(), sharp.hair * static_cast<double>(evaluators.size()));
}

Survivors survivors_in(const CellSearch& search, const CellScope& scope, const Box& box) {
  Survivors result;
  std::vector<Interval> values(scope.branches.size());
  for (size_t i = 0; i < values.size(); ++i) values[i] = scope.evaluators[i]->bounds(box);
  if (values.empty()) return result;
  const double hair = search.sharp.hair * static_cast<double>(search.sharp.branches.size());
  const std::vector<Interval> of_nodes = node_bounds(scope.nodes, values);
  if (of_nodes.back().lower > hair || of_nodes.back().upper < -hair) return result;
  std::vector<size_t> candidates;
  std::vector<std::array<Interval, kCurveFamilies>> facing;
  for (const size_t i : relevant_in(scope.nodes, of_nodes, values.size(), hair)) {
    result.relevant.push_back(i);
    if (!values[i].contains(0.0)) continue;
    const GradientBounds bounds = scope.evaluators[i]->gradient_bounds(box);
    if (!bounds.value.contains(0.0)) continue;
    candidates.push_back(i);
    facing.push_back(facing_bounds(search, box, bounds));
    LiveBranch live{i, 0};
    for (size_t family = 0; family < kCurveFamilies; ++family) {
      if ((search.families >> family & 1u) && facing.back()[family].contains(0.0)) live.families |= 1u << family;
    }
    if (live.families != 0) result.branches.push_back(live);
  }
  for (size_t j = 1; j < candidates.size(); ++j) {
    for (size_t i = 0; i < j; ++i) {
      bool live = search.whole_seams;
      for (size_t family = 0; family < kCurveFamilies; ++family) {
        live = live || ((search.families >> family & 1u) && !apart(facing[i][family], facing[j][family]));
      }
      if (live) result.seams.push_back({candidates[i], candidates[j]});
    }
  }
  return result;
}

}  // namespace limn
