#pragma once
// Internal: how a field's program is run, for any number type.

#include <algorithm>
#include <array>
#include <optional>

#include "sdf/error.h"
#include "sdf/field_program.h"
#include "sdf/tape.h"
#include "sdf/tape_jets.h"

namespace limn {

/// Points evaluated at once: enough to hide the interpreter, few enough that all slots stay in the first-level cache.
template <class T>
constexpr size_t batch_size() {
  return std::max<size_t>(1, std::min<size_t>(256, 2048 / sizeof(T)));
}
template <>
constexpr size_t batch_size<Interval>() {
  return 1;
}
template <>
constexpr size_t batch_size<Slope>() {
  return 1;
}
template <>
constexpr size_t batch_size<BoxSlope>() {
  return 1;
}

/// Slots and object-space coordinates of one number type; grows once.
template <class T>
struct Registers {
  std::vector<T> slots;
  std::vector<T> coordinates;

  void prepare(const FieldProgram& program) {
    slots.resize(program.slots * batch_size<T>());
    coordinates.resize(3 * batch_size<T>());
  }
  T* slot(std::uint32_t index) { return slots.data() + index * batch_size<T>(); }
  T* coordinate(size_t axis) { return coordinates.data() + axis * batch_size<T>(); }
};

template <class T>
T combined(FieldOperation operation, const T& a, const T& b, Scalar<T> constant) {
  switch (operation) {
    case FieldOperation::minimum:
      return minimum(a, b);
    case FieldOperation::maximum:
      return maximum(a, b);
    case FieldOperation::smooth_minimum:
      return smooth_minimum(a, b, constant);
    case FieldOperation::smooth_maximum:
      return -smooth_minimum(-a, -b, constant);
    case FieldOperation::negate:
      return -a;
    case FieldOperation::add:
      return a + constant;
    case FieldOperation::absolute:
      return abs(a);
    case FieldOperation::leaf:
      break;
  }
  return a;
}

template <FieldOperation operation, class T>
void combine_batch(const T* a, const T* b, T* target, Scalar<T> constant, size_t count) {
  for (size_t i = 0; i < count; ++i) target[i] = combined(operation, a[i], b[i], constant);
}

template <class T>
void combine_slots(const FieldInstruction& step, Registers<T>& registers, size_t count) {
  const T* const a = registers.slot(step.left);
  const T* const b = registers.slot(step.right);
  T* const target = registers.slot(step.target);
  const auto constant = scalar<T>(step.constant);
  switch (step.operation) {
    case FieldOperation::minimum:
      return combine_batch<FieldOperation::minimum>(a, b, target, constant, count);
    case FieldOperation::maximum:
      return combine_batch<FieldOperation::maximum>(a, b, target, constant, count);
    case FieldOperation::smooth_minimum:
      return combine_batch<FieldOperation::smooth_minimum>(a, b, target, constant, count);
    case FieldOperation::smooth_maximum:
      return combine_batch<FieldOperation::smooth_maximum>(a, b, target, constant, count);
    case FieldOperation::negate:
      return combine_batch<FieldOperation::negate>(a, a, target, constant, count);
    case FieldOperation::add:
      return combine_batch<FieldOperation::add>(a, a, target, constant, count);
    case FieldOperation::absolute:
      return combine_batch<FieldOperation::absolute>(a, a, target, constant, count);
    case FieldOperation::leaf:
      break;
  }
}

/// Runs the program over one batch. `load(leaf, axis)` fills registers.coordinate(axis); `finish(leaf, values)` may narrow a leaf's bounds.
template <class T, class Load, class Finish>
const T* run(const FieldProgram& program, Registers<T>& registers, size_t count, const Load& load, const Finish& finish) {
  for (const FieldInstruction& step : program.instructions) {
    if (step.operation != FieldOperation::leaf) {
      combine_slots(step, registers, count);
      continue;
    }
    const FieldLeaf& leaf = program.leaves[step.leaf];
    load(leaf);
    T* const values = registers.slot(step.target);
    const auto evaluate = std::get<ShapeFunction<T>>(leaf.functions->evaluate);
    evaluate(leaf.shape.get(), registers.coordinate(0), registers.coordinate(1), registers.coordinate(2), values, count);
    if (leaf.value_scale != 1.0) {
      const auto scale = scalar<T>(leaf.value_scale);
      for (size_t i = 0; i < count; ++i) values[i] = values[i] * scale;
    }
    finish(leaf, values);
  }
  return registers.slot(0);
}

/// A world point's coordinate in object space, `row` being the axis.
template <class R>
struct RowMap {
  R x, y, z, offset;
  RowMap(const Affine& map, int row)
      : x(static_cast<R>(map.linear[0][row])),
        y(static_cast<R>(map.linear[1][row])),
        z(static_cast<R>(map.linear[2][row])),
        offset(static_cast<R>(map.translation[row])) {}
  R operator()(const glm::vec<3, R>& p) const { return x * p.x + y * p.y + z * p.z + offset; }
};

struct FieldEvaluator::Scratch {
  std::tuple<Registers<float>, Registers<double>, Registers<Dual>, Registers<Jet>, Registers<Interval>, Registers<Slope>,
             Registers<BoxSlope>>
      registers;

  std::optional<FieldTape> tape{};
  bool tape_has_bits = false;  ///< Of the field, where there is a tape.
  TapeScratch lanes{};

  /// For at least so many points that lanes take less time; made where it is asked for first. Null for fewer, and where lanes have other
  /// bits than the field.
  const FieldTape* tape_for(const Field& field, size_t points, size_t fewest) {
    if (points < fewest) return nullptr;
    if (!tape) {
      tape.emplace(field);
      tape_has_bits = has_bits_of_field(*tape);
    }
    return tape_has_bits ? &*tape : nullptr;
  }

  template <class T>
  Registers<T>& get() {
    return std::get<Registers<T>>(registers);
  }
};

}  // namespace limn
