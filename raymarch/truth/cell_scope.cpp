#include "raymarch/truth/cell_scope.h"

#include <optional>

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

/// Bounds of all nodes; empty where everything below is without influence in the box.
using NodeBounds = std::vector<std::optional<Interval>>;

NodeBounds node_bounds(const SharpField& sharp, const CellScope& scope, const std::vector<Interval>& of_branches) {
  NodeBounds bounds(sharp.nodes.size());
  for (size_t i = 0; i < scope.branches.size(); ++i) {
    bounds[static_cast<size_t>(sharp.node_of[static_cast<size_t>(scope.branches[i])])] = of_branches[i];
  }
  for (size_t i = 0; i < sharp.nodes.size(); ++i) {
    const SharpNode& node = sharp.nodes[i];
    if (node.branch >= 0) continue;
    const auto &a = bounds[static_cast<size_t>(node.left)], &b = bounds[static_cast<size_t>(node.right)];
    if (a && b) {
      bounds[i] = node.maximum ? maximum(*a, *b) : minimum(*a, *b);
    } else {
      bounds[i] = a ? a : b;
    }
  }
  return bounds;
}

/// A side is without influence where the other one decides: on the value, or on where it is zero.
void mark_relevant(const SharpField& sharp, const NodeBounds& bounds, double hair, int at, std::vector<bool>& relevant) {
  const SharpNode& node = sharp.nodes[static_cast<size_t>(at)];
  if (!bounds[static_cast<size_t>(at)]) return;
  if (node.branch >= 0) {
    relevant[static_cast<size_t>(node.branch)] = true;
    return;
  }
  const auto matters = [&](int one, int other) {
    const auto &a = bounds[static_cast<size_t>(one)], &b = bounds[static_cast<size_t>(other)];
    if (!a) return false;
    if (node.maximum) return !(a->upper < -hair) && !(b && a->upper < b->lower - hair);
    return !(a->lower > hair) && !(b && a->lower > b->upper + hair);
  };
  // Where both are decided against, the box is empty of surface, and what remains says so.
  if (matters(node.left, node.right)) mark_relevant(sharp, bounds, hair, node.left, relevant);
  if (matters(node.right, node.left)) mark_relevant(sharp, bounds, hair, node.right, relevant);
}

bool apart(const Interval& a, const Interval& b) { return (a.lower > 0.0 && b.lower > 0.0) || (a.upper < 0.0 && b.upper < 0.0); }

}  // namespace

CellScope whole_scope(const SharpField& sharp) {
  CellScope scope;
  for (size_t i = 0; i < sharp.branches.size(); ++i) {
    scope.owned.push_back(std::make_unique<FieldEvaluator>(sharp.branches[i]));
    scope.branches.push_back(static_cast<int>(i));
    scope.evaluators.push_back(scope.owned.back().get());
  }
  return scope;
}

CellScope shortened(const CellScope& scope, const Box& box, double reach) {
  CellScope result;
  result.branches = scope.branches;
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
  return result;
}

std::vector<size_t> relevant_branches(const SharpField& sharp, std::vector<FieldEvaluator>& evaluators, const Box& box) {
  CellScope scope;
  std::vector<Interval> values;
  for (size_t i = 0; i < evaluators.size(); ++i) {
    scope.branches.push_back(static_cast<int>(i));
    values.push_back(evaluators[i].bounds(box));
  }
  std::vector<bool> relevant(evaluators.size(), false);
  const double hair = sharp.hair * static_cast<double>(evaluators.size());
  mark_relevant(sharp, node_bounds(sharp, scope, values), hair, static_cast<int>(sharp.nodes.size()) - 1, relevant);
  std::vector<size_t> result;
  for (size_t i = 0; i < relevant.size(); ++i) {
    if (relevant[i]) result.push_back(i);
  }
  return result;
}

Survivors survivors_in(const CellSearch& search, const CellScope& scope, const Box& box) {
  Survivors result;
  std::vector<Interval> values(scope.branches.size());
  for (size_t i = 0; i < values.size(); ++i) values[i] = scope.evaluators[i]->bounds(box);
  const NodeBounds nodes = node_bounds(search.sharp, scope, values);
  const double hair = search.sharp.hair * static_cast<double>(search.sharp.branches.size());
  if (!nodes.back() || nodes.back()->lower > hair || nodes.back()->upper < -hair) return result;
  std::vector<bool> relevant(search.sharp.branches.size(), false);
  mark_relevant(search.sharp, nodes, hair, static_cast<int>(search.sharp.nodes.size()) - 1, relevant);
  std::vector<size_t> candidates;
  std::vector<std::array<Interval, kCurveFamilies>> facing;
  for (size_t i = 0; i < values.size(); ++i) {
    if (!relevant[static_cast<size_t>(scope.branches[i])]) continue;
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
