#include "sdf/field_tree.h"

#include <algorithm>
#include <limits>

#include "sdf/field_run.h"

namespace limn {

bool is_binary(FieldOperation operation) {
  return operation == FieldOperation::minimum || operation == FieldOperation::maximum || operation == FieldOperation::smooth_minimum ||
         operation == FieldOperation::smooth_maximum;
}

namespace {

constexpr double kEpsilon = 1e-10;

bool is_smooth(FieldOperation operation) {
  return operation == FieldOperation::smooth_minimum || operation == FieldOperation::smooth_maximum;
}

bool takes_lower(FieldOperation operation) { return operation == FieldOperation::minimum || operation == FieldOperation::smooth_minimum; }

}  // namespace

std::vector<FieldNode> tree_of(const FieldProgram& program) {
  std::vector<int> maker(program.slots, -1);
  std::vector<FieldNode> tree;
  tree.reserve(program.instructions.size());
  for (const FieldInstruction& instruction : program.instructions) {
    FieldNode node{instruction};
    const int own = static_cast<int>(tree.size());
    if (instruction.operation != FieldOperation::leaf) node.left = maker[instruction.left];
    if (is_binary(instruction.operation)) node.right = maker[instruction.right];
    for (const int child : {node.left, node.right}) {
      if (child >= 0) tree[static_cast<size_t>(child)].parent = own;
    }
    maker[instruction.target] = own;
    tree.push_back(node);
  }
  return tree;
}

void append_subtree(const FieldProgram& program, std::span<const FieldNode> tree, int node, std::uint32_t target, FieldProgram& out) {
  const FieldNode& at = tree[static_cast<size_t>(node)];
  if (at.left >= 0) append_subtree(program, tree, at.left, target, out);
  if (at.right >= 0) append_subtree(program, tree, at.right, target + 1, out);
  FieldInstruction instruction = at.instruction;
  if (instruction.operation == FieldOperation::leaf) {
    out.leaves.push_back(program.leaves[instruction.leaf]);
    instruction.leaf = static_cast<std::uint32_t>(out.leaves.size() - 1);
  }
  instruction.target = target;
  instruction.left = target;
  instruction.right = is_binary(instruction.operation) ? target + 1 : target;
  out.slots = std::max(out.slots, target + 1);
  out.instructions.push_back(instruction);
}

Field subtree(const Field& field, std::span<const FieldNode> tree, int node) {
  FieldProgram part;
  part.traits = field.traits();
  part.traits.exact_distance = false;
  append_subtree(field.program(), tree, node, 0, part);
  return Field(std::make_shared<const FieldProgram>(std::move(part)));
}

Field with_material(const Field& field, int material, const std::optional<glm::vec3>& color) {
  auto program = std::make_shared<FieldProgram>(field.program());
  for (FieldLeaf& leaf : program->leaves) {
    if (leaf.material == kNoMaterial) leaf.material = material;
    if (!leaf.color) leaf.color = color;
  }
  return Field(std::move(program));
}

bool has_materials(const Field& field) {
  const auto& leaves = field.program().leaves;
  return std::any_of(leaves.begin(), leaves.end(), [](const FieldLeaf& leaf) { return leaf.material != kNoMaterial; });
}

bool has_colors(const Field& field) {
  const auto& leaves = field.program().leaves;
  return std::any_of(leaves.begin(), leaves.end(), [](const FieldLeaf& leaf) { return leaf.color.has_value(); });
}

FieldParts::FieldParts(const Field& field) : field_(field), tree_(tree_of(field.program())) {
  const Box& bounds = field.traits().bounds;
  if (!bounds.empty() && bounds.finite()) epsilon_ = kEpsilon * bounds.radius();
}

void FieldParts::look(const glm::dvec3& p, Place& place) const {
  place.values.resize(tree_.size());
  place.owners.resize(tree_.size());
  const auto value_of = [&](int node) { return place.values[static_cast<size_t>(node)]; };
  for (size_t i = 0; i < tree_.size(); ++i) {
    const FieldNode& node = tree_[i];
    const FieldInstruction& step = node.instruction;
    if (step.operation == FieldOperation::leaf) {
      const FieldLeaf& shape = leaf(step.leaf);
      const glm::dvec3 q = shape.object_from_world.point(p);
      double value = 0.0;
      std::get<ShapeFunction<double>>(shape.functions->evaluate)(shape.shape.get(), &q.x, &q.y, &q.z, &value, 1);
      place.values[i] = shape.value_scale * value;
      place.owners[i] = step.leaf;
      continue;
    }
    const double a = value_of(node.left), b = node.right >= 0 ? value_of(node.right) : a;
    place.values[i] = combined(step.operation, a, b, step.constant);
    const double epsilon = is_smooth(step.operation) ? 0.0 : epsilon_;
    const bool second = node.right >= 0 && (takes_lower(step.operation) ? b < a - epsilon : b > a - epsilon);
    place.owners[i] = place.owners[static_cast<size_t>(second ? node.right : node.left)];
  }
}

double FieldParts::ownership(const Place& place, int node) const {
  double least = std::numeric_limits<double>::infinity();
  for (int at = node; at >= 0; at = tree_[static_cast<size_t>(at)].parent) {
    const int parent = tree_[static_cast<size_t>(at)].parent;
    if (parent < 0) break;
    const FieldNode& above = tree_[static_cast<size_t>(parent)];
    if (above.right < 0) continue;
    const double own = place.values[static_cast<size_t>(at)],
                 other = place.values[static_cast<size_t>(above.left == at ? above.right : above.left)];
    least = std::min(least, takes_lower(above.instruction.operation) ? other - own : own - other);
  }
  return least;
}

}  // namespace limn
