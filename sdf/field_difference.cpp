// The difference of two fields' values, as a shape for every number type.

#include <algorithm>
#include <limits>

#include "sdf/field_run.h"
#include "sdf/field_tree.h"
#include "sdf/number_recorded.h"

namespace limn {
namespace {

/// A field's program at one point, with any number type, recorded ones among them.
template <class T>
T value_at(const FieldProgram& program, const Vector3<T>& p) {
  std::vector<T> slots(program.slots);
  for (const FieldInstruction& step : program.instructions) {
    if (step.operation != FieldOperation::leaf) {
      slots[step.target] = combined(step.operation, slots[step.left], slots[step.right], scalar<T>(step.constant));
      continue;
    }
    const FieldLeaf& leaf = program.leaves[step.leaf];
    const auto row = [&](int axis) {
      const glm::dmat3& m = leaf.object_from_world.linear;
      return p.x * scalar<T>(m[0][axis]) + p.y * scalar<T>(m[1][axis]) + p.z * scalar<T>(m[2][axis]) +
             scalar<T>(leaf.object_from_world.translation[axis]);
    };
    const Vector3<T> q{row(0), row(1), row(2)};
    T& value = slots[step.target];
    if constexpr (std::is_same_v<T, Recorded>) {
      leaf.functions->record(leaf.shape.get(), q, value);
    } else {
      std::get<ShapeFunction<T>>(leaf.functions->evaluate)(leaf.shape.get(), &q.x, &q.y, &q.z, &value, 1);
    }
    value = value * scalar<T>(leaf.value_scale);
  }
  return slots[0];
}

struct Difference {
  Field a, b;

  template <class T>
  T operator()(const Vector3<T>& p) const {
    return value_at(a.program(), p) - value_at(b.program(), p);
  }
  double support(const glm::dvec3&, double) const { return std::numeric_limits<double>::infinity(); }
};

/// Where a shape in it cannot be recorded, neither can the difference.
struct UnrecordedDifference : Difference {
  static constexpr bool kBranches = true;
};

bool recordable(const Field& field) {
  const auto& leaves = field.program().leaves;
  return std::all_of(leaves.begin(), leaves.end(), [](const FieldLeaf& leaf) { return leaf.functions->record != nullptr; });
}

}  // namespace

Field difference_of_values(const Field& a, const Field& b) {
  const double lipschitz = a.traits().lipschitz + b.traits().lipschitz;
  if (recordable(a) && recordable(b)) return field_from_shape(Difference{a, b}, lipschitz, false);
  return field_from_shape(UnrecordedDifference{{a, b}}, lipschitz, false);
}

}  // namespace limn
