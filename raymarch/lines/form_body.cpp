#include "raymarch/lines/form_body.h"

#include <algorithm>

#include "raymarch/truth/branches.h"
#include "sdf/field_program.h"

namespace limn {
namespace {

// Of the extent: surfaces that coincide count as this far apart, the first one outside. Far below what rays are lifted by, far above
// rounding.
constexpr double kEpsilon = 2e-12;
constexpr double kMargin = 1e-3;  // of the extent, around the body
constexpr size_t kFew = 5;        // surfaces, so that cutting a cell costs more than it saves
constexpr int kDeepest = 36;      // cuts
constexpr int kMostVain = 3;      // cuts one after the other that leave as many surfaces to a cell

/// sign * leaf + added <= 0 as a surface.
std::optional<FormSurface> surface_of(const Field& branch, double epsilon) {
  const FieldProgram& program = branch.program();
  if (program.leaves.size() != 1) return {};
  const FieldLeaf& leaf = program.leaves[0];
  if (leaf.functions->closed_form == nullptr) return {};
  double sign = 1.0, added = -epsilon;
  for (auto step = program.instructions.rbegin(); step != program.instructions.rend(); ++step) {
    if (step->operation == FieldOperation::negate) {
      sign = -sign;
    } else if (step->operation == FieldOperation::add) {
      added += sign * step->constant;
    } else if (step->operation != FieldOperation::leaf) {
      return {};
    }
  }
  const auto form = leaf.functions->closed_form(leaf.shape.get(), -sign * added / leaf.value_scale);
  if (!form) return {};
  return form_surface(*form, leaf.object_from_world, sign < 0.0);
}

/// What each node comes to in a box: decided, or the node that it is there.
struct Reduced {
  BoxSide side = BoxSide::crossed;
  int as = -1;
};

Reduced reduced(const FormNode& node, const Reduced& a, const Reduced& b, int own) {
  const BoxSide wins = node.intersection ? BoxSide::outside : BoxSide::inside;
  if (a.side == wins || b.side == wins) return {wins, -1};
  if (a.side != BoxSide::crossed) return b;
  if (b.side != BoxSide::crossed) return a;
  return {BoxSide::crossed, own};
}

FormTree pruned(const FormBody& body, const FormTree& tree, const Box& box) {
  if (tree.nodes.empty()) return tree;
  const size_t n = tree.nodes.size();
  std::vector<Reduced> all(n);
  for (size_t i = 0; i < n; ++i) {
    const FormNode& node = tree.nodes[i];
    if (node.surface >= 0) {
      all[i] = {side_of(body.surfaces[static_cast<size_t>(node.surface)], box), static_cast<int>(i)};
    } else {
      all[i] = reduced(node, all[static_cast<size_t>(node.left)], all[static_cast<size_t>(node.right)], static_cast<int>(i));
    }
  }
  FormTree result;
  const Reduced& root = all.back();
  if (root.side != BoxSide::crossed) {
    result.inside = root.side == BoxSide::inside;
    return result;
  }
  std::vector<int> number(n, -1);
  number[static_cast<size_t>(root.as)] = 0;
  const auto needed = [&](int child) { return static_cast<size_t>(all[static_cast<size_t>(child)].as); };
  for (size_t i = n; i-- > 0;) {
    if (number[i] < 0 || tree.nodes[i].surface >= 0) continue;
    number[needed(tree.nodes[i].left)] = number[needed(tree.nodes[i].right)] = 0;
  }
  for (size_t i = 0; i < n; ++i) {
    if (number[i] < 0) continue;
    FormNode node = tree.nodes[i];
    if (node.surface < 0) {
      node.left = number[needed(node.left)];
      node.right = number[needed(node.right)];
    }
    number[i] = static_cast<int>(result.nodes.size());
    result.nodes.push_back(node);
  }
  return result;
}

size_t surfaces_in(const FormTree& tree) { return (tree.nodes.size() + 1) / 2; }

void cut(FormBody& body, size_t at, int depth, int vain) {
  const Box box = body.cells[at].box;
  const size_t count = surfaces_in(body.cells[at].tree);
  if (count <= kFew || depth >= kDeepest || vain >= kMostVain) return;
  const glm::dvec3 size = box.size(), middle = box.center();
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  Box halves[2] = {box, box};
  halves[0].upper[axis] = halves[1].lower[axis] = middle[axis];
  const size_t first = body.cells.size();
  for (const Box& half : halves) body.cells.push_back({half, -1, -1, pruned(body, body.cells[at].tree, half)});
  body.cells[at].lower = static_cast<int>(first);
  body.cells[at].upper = static_cast<int>(first + 1);
  for (size_t i = first; i < first + 2; ++i) cut(body, i, depth + 1, surfaces_in(body.cells[i].tree) == count ? vain + 1 : 0);
}

bool holds(const Box& outer, const Box& inner) {
  return glm::all(glm::lessThanEqual(outer.lower, inner.lower)) && glm::all(glm::greaterThanEqual(outer.upper, inner.upper));
}

}  // namespace

std::optional<FormBody> form_body(const Field& field) {
  const Box bounds = field.traits().bounds;
  if (!bounds.finite()) return {};
  FormBody body;
  body.extent = bounds.radius();
  const SharpField sharp = split_branches(field, body.extent, true);
  for (size_t i = 0; i < sharp.branches.size(); ++i) {
    const std::optional<FormSurface> surface =
        surface_of(sharp.branches[i], kEpsilon * body.extent * static_cast<double>(sharp.branches.size() - 1 - i));
    if (!surface) return {};
    body.surfaces.push_back(*surface);
  }
  FormTree whole;
  for (const SharpNode& node : sharp.nodes) whole.nodes.push_back({node.maximum, node.left, node.right, node.branch});
  const Box box = dilate(bounds, kMargin * body.extent);
  body.cells.push_back({box, -1, -1, pruned(body, whole, box)});
  cut(body, 0, 0, 0);
  return body;
}

FormTree tree_in(const FormBody& body, const Box& box) {
  size_t at = 0;
  for (bool deeper = true; deeper && body.cells[at].lower >= 0;) {
    deeper = false;
    for (const int child : {body.cells[at].lower, body.cells[at].upper}) {
      if (!holds(body.cells[static_cast<size_t>(child)].box, box)) continue;
      at = static_cast<size_t>(child);
      deeper = true;
      break;
    }
  }
  return pruned(body, body.cells[at].tree, box);
}

const FormTree& tree_at(const FormBody& body, const glm::dvec3& p) {
  const FormCell* cell = &body.cells[0];
  while (cell->lower >= 0) {
    const FormCell& lower = body.cells[static_cast<size_t>(cell->lower)];
    cell = glm::all(glm::lessThanEqual(p, lower.box.upper)) ? &lower : &body.cells[static_cast<size_t>(cell->upper)];
  }
  return cell->tree;
}

unsigned outcomes(const FormBody& body, const FormTree& tree, const glm::dvec3& p, int first, int second, std::vector<unsigned>& scratch) {
  if (tree.nodes.empty()) return tree.inside ? 15u : 0u;
  scratch.resize(tree.nodes.size());
  for (size_t i = 0; i < tree.nodes.size(); ++i) {
    const FormNode& node = tree.nodes[i];
    if (node.surface < 0) {
      const unsigned a = scratch[static_cast<size_t>(node.left)], b = scratch[static_cast<size_t>(node.right)];
      scratch[i] = node.intersection ? a & b : a | b;
    } else if (node.surface == first) {
      scratch[i] = 12u;
    } else if (node.surface == second) {
      scratch[i] = 10u;
    } else {
      scratch[i] = signed_value(body.surfaces[static_cast<size_t>(node.surface)], p) <= 0.0 ? 15u : 0u;
    }
  }
  return scratch.back();
}

}  // namespace limn
