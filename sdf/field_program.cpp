#include "sdf/field_program.h"

#include <limits>

namespace limn {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Box everything() { return {glm::dvec3(-infinity), glm::dvec3(infinity)}; }

Box leaf_bounds(const FieldLeaf& leaf, double level) {
  const Affine world_from_object = inverse(leaf.object_from_world);
  const glm::dmat3 transposed = glm::transpose(world_from_object.linear);
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    const glm::dvec3 direction = transposed[axis];
    const double object_level = level / leaf.value_scale;
    box.upper[axis] = leaf.functions->support(leaf.shape.get(), direction, object_level) + world_from_object.translation[axis];
    box.lower[axis] = world_from_object.translation[axis] - leaf.functions->support(leaf.shape.get(), -direction, object_level);
  }
  return box.empty() ? Box{} : box;
}

}  // namespace

// The wanted level travels from the result down to the leaves (backwards through the list), the boxes travel up again.
Box sublevel_bounds(const FieldProgram& program, double level) {
  std::vector<double> levels(program.slots, level);
  std::vector<Box> leaf_boxes(program.leaves.size());
  for (auto step = program.instructions.rbegin(); step != program.instructions.rend(); ++step) {
    const double wanted = levels[step->target];
    switch (step->operation) {
      case FieldOperation::leaf:
        leaf_boxes[step->leaf] = leaf_bounds(program.leaves[step->leaf], wanted);
        break;
      case FieldOperation::smooth_minimum:  // at most constant / 6 below the minimum
        levels[step->left] = levels[step->right] = wanted + step->constant / 6.0;
        break;
      case FieldOperation::add:
        levels[step->left] = wanted - step->constant;
        break;
      case FieldOperation::negate:  // never read: what is outside has no bounds
        levels[step->left] = infinity;
        break;
      case FieldOperation::absolute:  // |f| <= level is part of f <= level
      case FieldOperation::minimum:
      case FieldOperation::maximum:
      case FieldOperation::smooth_maximum:
        levels[step->left] = levels[step->right] = wanted;
        break;
    }
  }
  std::vector<Box> boxes(program.slots);
  for (const FieldInstruction& step : program.instructions) {
    Box& target = boxes[step.target];
    switch (step.operation) {
      case FieldOperation::leaf:
        target = leaf_boxes[step.leaf];
        break;
      case FieldOperation::minimum:
      case FieldOperation::smooth_minimum:
        target = merge(boxes[step.left], boxes[step.right]);
        break;
      case FieldOperation::maximum:
      case FieldOperation::smooth_maximum:
        target = intersect(boxes[step.left], boxes[step.right]);
        if (target.empty()) target = Box{};
        break;
      case FieldOperation::negate:
        target = everything();
        break;
      case FieldOperation::add:
      case FieldOperation::absolute:
        target = boxes[step.left];
        break;
    }
  }
  return boxes[0];
}

Field field_from_leaf(FieldLeaf leaf, bool exact) {
  auto program = std::make_shared<FieldProgram>();
  program->traits.lipschitz = leaf.lipschitz;
  program->traits.exact_distance = exact;
  program->leaves.push_back(std::move(leaf));
  program->instructions.push_back({});
  program->traits.bounds = sublevel_bounds(*program, 0.0);
  return Field(std::move(program));
}

}  // namespace limn
