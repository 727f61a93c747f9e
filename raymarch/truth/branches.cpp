#include "raymarch/truth/branches.h"

#include <algorithm>
#include <limits>

#include "sdf/field_tree.h"

namespace limn {
namespace {

constexpr double kEpsilon = 1e-10;

/// A program and the tree of its steps.
struct Source {
  const FieldProgram& program;
  std::vector<FieldNode> tree;
  explicit Source(const FieldProgram& of) : program(of), tree(tree_of(of)) {}
  const FieldNode& node(int i) const { return tree[static_cast<size_t>(i)]; }
  int root() const { return static_cast<int>(tree.size()) - 1; }
};

class Splitter {
 public:
  Splitter(const Field& field, bool into_faces) : into_faces_(into_faces) {
    traits_ = field.traits();
    const Source source(field.program());
    split(source, source.root(), 1.0, 0.0);
  }

  SharpField finish() {
    for (size_t i = 0; i < sharp_.nodes.size(); ++i) {
      const SharpNode& node = sharp_.nodes[i];
      if (node.branch >= 0) continue;
      sharp_.nodes[static_cast<size_t>(node.left)].parent = static_cast<int>(i);
      sharp_.nodes[static_cast<size_t>(node.right)].parent = static_cast<int>(i);
    }
    return std::move(sharp_);
  }

 private:
  /// The node for sign * step + added.
  int split(const Source& source, int at, double sign, double added) {
    const FieldInstruction& instruction = source.node(at).instruction;
    const int left = source.node(at).left, right = source.node(at).right;
    switch (instruction.operation) {
      case FieldOperation::minimum:
      case FieldOperation::maximum: {
        const bool maximum = (instruction.operation == FieldOperation::maximum) == (sign > 0.0);
        const int a = split(source, left, sign, added), b = split(source, right, sign, added);
        return add_node({maximum, a, b, -1, -1});
      }
      case FieldOperation::absolute: {
        const int a = split(source, left, 1.0, added), b = split(source, left, -1.0, added);
        return add_node({sign > 0.0, a, b, -1, -1});
      }
      case FieldOperation::negate:
        return split(source, left, -sign, added);
      case FieldOperation::add:
        return split(source, left, sign, added + sign * instruction.constant);
      case FieldOperation::leaf:
        return split_leaf(source, at, sign, added);
      default:
        return add_branch(source, at, sign, added);
    }
  }

  /// A shape with sharp edges, at a level where they are still sharp.
  int split_leaf(const Source& source, int at, double sign, double added) {
    const FieldLeaf& leaf = source.program.leaves[source.node(at).instruction.leaf];
    if (!into_faces_ || leaf.functions->faces == nullptr || sign * added < 0.0) return add_branch(source, at, sign, added);
    FieldProgram faces = leaf.functions->faces(leaf.shape.get()).program();
    for (FieldLeaf& face : faces.leaves) {
      face.object_from_world = compose(face.object_from_world, leaf.object_from_world);
      face.value_scale *= leaf.value_scale;
      face.lipschitz = leaf.lipschitz;
      face.material = leaf.material;
      face.color = leaf.color;
    }
    const Source placed(faces);
    return split(placed, placed.root(), sign, added);
  }

  int add_node(const SharpNode& node) {
    sharp_.nodes.push_back(node);
    return static_cast<int>(sharp_.nodes.size()) - 1;
  }

  int add_branch(const Source& source, int at, double sign, double added) {
    FieldProgram branch;
    branch.traits = traits_;
    branch.traits.exact_distance = false;
    append_subtree(source.program, source.tree, at, 0, branch);
    if (sign < 0.0) branch.instructions.push_back({FieldOperation::negate, 0, 0, 0, 0, 0.0});
    if (added != 0.0) branch.instructions.push_back({FieldOperation::add, 0, 0, 0, 0, added});
    const int number = static_cast<int>(sharp_.branches.size());
    sharp_.branches.emplace_back(std::make_shared<const FieldProgram>(std::move(branch)));
    sharp_.node_of.push_back(add_node({false, -1, -1, -1, number}));
    return sharp_.node_of.back();
  }

  bool into_faces_ = false;
  FieldTraits traits_;
  SharpField sharp_;
};

/// The first branch is moved farthest, the last not at all.
double outward(const SharpField& sharp, int branch) { return sharp.epsilon * (static_cast<double>(sharp.branches.size()) - 1.0 - branch); }

void set_node_value(const SharpField& sharp, std::span<const double> branch_values, size_t i, std::vector<double>& values) {
  const SharpNode& node = sharp.nodes[i];
  if (node.branch >= 0) {
    values[i] = branch_values[static_cast<size_t>(node.branch)] - outward(sharp, node.branch);
    return;
  }
  const double a = values[static_cast<size_t>(node.left)], b = values[static_cast<size_t>(node.right)];
  values[i] = node.maximum ? std::max(a, b) : std::min(a, b);
}

/// From a branch's node up to the root.
std::vector<int> path_of(const SharpField& sharp, int branch) {
  std::vector<int> path;
  for (int node = sharp.node_of[static_cast<size_t>(branch)]; node >= 0; node = sharp.nodes[static_cast<size_t>(node)].parent) {
    path.push_back(node);
  }
  return path;
}

int first_common(const std::vector<int>& path, const std::vector<int>& other) {
  // Both end at the root: from there they are the same down to where they part.
  int common = -1;
  for (size_t k = 1; k <= std::min(path.size(), other.size()) && path[path.size() - k] == other[other.size() - k]; ++k)
    common = path[path.size() - k];
  return common;
}

}  // namespace

SharpField split_branches(const Field& field, double extent, bool into_faces) {
  SharpField sharp = Splitter(field, into_faces).finish();
  sharp.epsilon = kEpsilon * extent;
  return sharp;
}

SharpField cut_by(SharpField sharp, const Field& branch) {
  const int root = static_cast<int>(sharp.nodes.size()) - 1, added = root + 1, whole = root + 2;
  sharp.nodes.back().parent = whole;
  sharp.nodes.push_back({false, -1, -1, whole, static_cast<int>(sharp.branches.size())});
  sharp.node_of.push_back(added);
  sharp.branches.push_back(branch);
  sharp.nodes.push_back({true, root, added, -1, -1});
  return sharp;
}

void node_values(const SharpField& sharp, std::span<const double> branch_values, std::vector<double>& values) {
  values.resize(sharp.nodes.size());
  for (size_t i = 0; i < sharp.nodes.size(); ++i) set_node_value(sharp, branch_values, i, values);
}

std::vector<int> nodes_above(const SharpField& sharp, std::span<const size_t> branches) {
  std::vector<char> is_above(sharp.nodes.size(), 0);
  for (const size_t branch : branches)
    for (int node = sharp.node_of[branch]; node >= 0 && !is_above[static_cast<size_t>(node)];
         node = sharp.nodes[static_cast<size_t>(node)].parent)
      is_above[static_cast<size_t>(node)] = 1;
  std::vector<int> nodes;
  for (size_t i = 0; i < is_above.size(); ++i)
    if (is_above[i]) nodes.push_back(static_cast<int>(i));
  return nodes;
}

void update_node_values(const SharpField& sharp, std::span<const double> branch_values, std::span<const int> nodes,
                        std::vector<double>& values) {
  for (const int node : nodes) set_node_value(sharp, branch_values, static_cast<size_t>(node), values);
}

std::vector<MarginSide> margin_sides(const SharpField& sharp, int first, int second) {
  const std::vector<int> path = path_of(sharp, first);
  const std::vector<int> other = second >= 0 ? path_of(sharp, second) : std::vector<int>{};
  const int common = first_common(path, other);
  std::vector<MarginSide> sides;
  const auto climb = [&](const std::vector<int>& from, int branch, bool beyond) {
    const double own = -outward(sharp, branch);
    for (const int node : from) {
      if (node == common && !beyond) return;
      const int parent = sharp.nodes[static_cast<size_t>(node)].parent;
      if (parent < 0) return;
      if (parent == common) continue;  // There the two meet.
      const SharpNode& above = sharp.nodes[static_cast<size_t>(parent)];
      sides.push_back({above.left == node ? above.right : above.left, above.maximum, own});
    }
  };
  climb(path, first, true);
  if (second >= 0) climb(other, second, false);
  return sides;
}

double surface_margin(std::span<const MarginSide> sides, std::span<const double> values) {
  double margin = std::numeric_limits<double>::infinity();
  for (const MarginSide& side : sides) {
    const double sibling = values[static_cast<size_t>(side.node)];
    margin = std::min(margin, side.maximum ? side.own - sibling : sibling - side.own);
  }
  return margin;
}

double surface_margin(const SharpField& sharp, std::span<const double> values, int first, int second) {
  return surface_margin(margin_sides(sharp, first, second), values);
}

bool meet_as_intersection(const SharpField& sharp, int first, int second) {
  return sharp.nodes[static_cast<size_t>(first_common(path_of(sharp, first), path_of(sharp, second)))].maximum;
}

}  // namespace limn
