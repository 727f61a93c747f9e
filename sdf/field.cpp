#include "sdf/field.h"

#include <algorithm>

#include "sdf/error.h"
#include "sdf/field_program.h"

namespace limn {
namespace {

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

template <class R>
void load_points(const FieldLeaf& leaf, std::span<const glm::vec<3, R>> points, Registers<R>& registers) {
  for (int axis = 0; axis < 3; ++axis) {
    const RowMap<R> map(leaf.object_from_world, axis);
    R* const out = registers.coordinate(static_cast<size_t>(axis));
    for (size_t i = 0; i < points.size(); ++i) out[i] = map(points[i]);
  }
}

template <Differential D>
void load_points(const FieldLeaf& leaf, std::span<const glm::dvec3> points, Registers<D>& registers) {
  for (int axis = 0; axis < 3; ++axis) {
    const RowMap<double> map(leaf.object_from_world, axis);
    D seed;
    seed.gradient = {map.x, map.y, map.z};
    D* const out = registers.coordinate(static_cast<size_t>(axis));
    for (size_t i = 0; i < points.size(); ++i) {
      seed.value = map(points[i]);
      out[i] = seed;
    }
  }
}

/// Calls `consume(first, count, values)` for each batch.
template <class T, class P, class Consume>
void run_batches(const FieldProgram& program, Registers<T>& registers, std::span<const P> points, const Consume& consume) {
  registers.prepare(program);
  for (size_t first = 0; first < points.size(); first += batch_size<T>()) {
    const auto batch = points.subspan(first, std::min(batch_size<T>(), points.size() - first));
    const auto load = [&](const FieldLeaf& leaf) { load_points(leaf, batch, registers); };
    consume(first, batch.size(), run(program, registers, batch.size(), load, [](const FieldLeaf&, T*) {}));
  }
}

Interval row_bounds(const RowMap<double>& map, const Box& box) {
  const auto term = [](double factor, double low, double high) { return Interval{low, high} * factor; };
  return term(map.x, box.lower.x, box.upper.x) + term(map.y, box.lower.y, box.upper.y) + term(map.z, box.lower.z, box.upper.z) + map.offset;
}

/// f(centre) +- lipschitz * radius, with slack for the rounding of f(centre), whose terms are as large as `extent`.
Interval lipschitz_bounds(double center_value, double lipschitz, double radius, double extent) {
  const double reach = lipschitz * radius;
  const double slack = 1e-14 * (std::fabs(center_value) + reach + extent);
  return {center_value - reach - slack, center_value + reach + slack};
}

double leaf_value(const FieldLeaf& leaf, const glm::dvec3& world) {
  const glm::dvec3 p = leaf.object_from_world.point(world);
  double value = 0.0;
  std::get<ShapeFunction<double>>(leaf.functions->evaluate)(leaf.shape.get(), &p.x, &p.y, &p.z, &value, 1);
  return leaf.value_scale * value;
}

double largest(const glm::dvec3& v) { return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}); }

double leaf_extent(const FieldLeaf& leaf, const glm::dvec3& world) {
  return leaf.lipschitz * largest(world) + leaf.value_scale * largest(leaf.object_from_world.translation);
}

}  // namespace

const FieldTraits& Field::traits() const { return program_->traits; }

struct FieldEvaluator::Scratch {
  std::tuple<Registers<float>, Registers<double>, Registers<Dual>, Registers<Jet>, Registers<Interval>, Registers<Slope>> registers;

  template <class T>
  Registers<T>& get() {
    return std::get<Registers<T>>(registers);
  }
};

FieldEvaluator::FieldEvaluator(const Field& field) : field_(field), scratch_(std::make_unique<Scratch>()) {}
FieldEvaluator::~FieldEvaluator() = default;
FieldEvaluator::FieldEvaluator(FieldEvaluator&&) noexcept = default;
FieldEvaluator& FieldEvaluator::operator=(FieldEvaluator&&) noexcept = default;

void FieldEvaluator::values(std::span<const glm::dvec3> points, std::span<double> values) {
  LIMN_CHECK(points.size() == values.size());
  run_batches(field_.program(), scratch_->get<double>(), points,
              [&](size_t first, size_t count, const double* results) { std::copy_n(results, count, values.data() + first); });
}

void FieldEvaluator::values(std::span<const glm::vec3> points, std::span<float> values) {
  LIMN_CHECK(points.size() == values.size());
  run_batches(field_.program(), scratch_->get<float>(), points,
              [&](size_t first, size_t count, const float* results) { std::copy_n(results, count, values.data() + first); });
}

void FieldEvaluator::gradients(std::span<const glm::dvec3> points, std::span<double> values, std::span<glm::dvec3> gradients) {
  LIMN_CHECK(points.size() == values.size() && points.size() == gradients.size());
  run_batches(field_.program(), scratch_->get<Dual>(), points, [&](size_t first, size_t count, const Dual* results) {
    for (size_t i = 0; i < count; ++i) {
      const auto& g = results[i].gradient;
      values[first + i] = results[i].value;
      gradients[first + i] = {g[0], g[1], g[2]};
    }
  });
}

void FieldEvaluator::jets(std::span<const glm::dvec3> points, std::span<FieldJet> jets) {
  LIMN_CHECK(points.size() == jets.size());
  run_batches(field_.program(), scratch_->get<Jet>(), points, [&](size_t first, size_t count, const Jet* results) {
    for (size_t i = 0; i < count; ++i) {
      const auto& g = results[i].gradient;
      const auto& h = results[i].hessian;
      jets[first + i] = {results[i].value, {g[0], g[1], g[2]}, {h[0], h[1], h[2], h[1], h[3], h[4], h[2], h[4], h[5]}};
    }
  });
}

double FieldEvaluator::value(const glm::dvec3& point) {
  double result = 0.0;
  values(std::span(&point, 1), std::span(&result, 1));
  return result;
}

FieldJet FieldEvaluator::jet(const glm::dvec3& point) {
  FieldJet result;
  jets(std::span(&point, 1), std::span(&result, 1));
  return result;
}

Interval FieldEvaluator::bounds(const Box& box) {
  if (!box.finite()) return {};
  const FieldProgram& program = field_.program();
  const glm::dvec3 center = box.center();
  // Measured from the centre as it was rounded, so that the ball holds every corner.
  const double radius = glm::length(glm::max(box.upper - center, center - box.lower)) * (1.0 + 1e-15);
  auto& registers = scratch_->get<Interval>();
  registers.prepare(program);
  const auto load = [&](const FieldLeaf& leaf) {
    for (int axis = 0; axis < 3; ++axis) {
      registers.coordinate(static_cast<size_t>(axis))[0] = row_bounds(RowMap<double>(leaf.object_from_world, axis), box);
    }
  };
  const auto narrow = [&](const FieldLeaf& leaf, Interval* value) {
    *value = tighter(*value, lipschitz_bounds(leaf_value(leaf, center), leaf.lipschitz, radius, leaf_extent(leaf, center)));
  };
  const Interval result = run(program, registers, 1, load, narrow)[0];
  if (program.instructions.size() == 1) return result;
  double extent = 0.0;
  for (const FieldLeaf& leaf : program.leaves) extent = std::max(extent, leaf_extent(leaf, center));
  return tighter(result, lipschitz_bounds(value(center), program.traits.lipschitz, radius, extent));
}

RayBounds FieldEvaluator::bounds_along(const glm::dvec3& origin, const glm::dvec3& direction, Interval t) {
  LIMN_CHECK(t.lower <= t.upper);
  if (!std::isfinite(t.width())) return {};
  const FieldProgram& program = field_.program();
  const double middle = 0.5 * (t.lower + t.upper);
  const glm::dvec3 center = origin + middle * direction;
  const double speed = glm::length(direction);
  const double radius = speed * std::max(t.upper - middle, middle - t.lower) * (1.0 + 1e-15);
  auto& registers = scratch_->get<Slope>();
  registers.prepare(program);
  const auto load = [&](const FieldLeaf& leaf) {
    for (int axis = 0; axis < 3; ++axis) {
      const RowMap<double> map(leaf.object_from_world, axis);
      const Interval start = row_bounds(map, {origin, origin});
      const Interval speed_here = Interval{direction.x, direction.x} * map.x + Interval{direction.y, direction.y} * map.y +
                                  Interval{direction.z, direction.z} * map.z;
      registers.coordinate(static_cast<size_t>(axis))[0] = {t * speed_here + start, speed_here};
    }
  };
  const double extent_of_ray = largest(origin) + speed * magnitude(t);
  const auto narrow = [&](const FieldLeaf& leaf, Slope* s) {
    const double steepest = leaf.lipschitz * speed * (1.0 + 1e-14);
    const double extent = leaf_extent(leaf, center) + leaf.lipschitz * extent_of_ray;
    s->value = tighter(s->value, lipschitz_bounds(leaf_value(leaf, center), leaf.lipschitz, radius, extent));
    s->slope = tighter(s->slope, {-steepest, steepest});
  };
  const Slope result = run(program, registers, 1, load, narrow)[0];
  return {result.value, result.slope};
}

}  // namespace limn
