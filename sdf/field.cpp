#include "sdf/field.h"

#include "sdf/field_run.h"

namespace limn {
namespace {

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

}  // namespace

const FieldTraits& Field::traits() const { return program_->traits; }

FieldEvaluator::FieldEvaluator(const Field& field) : field_(field), scratch_(std::make_unique<Scratch>()) {}
FieldEvaluator::~FieldEvaluator() = default;
FieldEvaluator::FieldEvaluator(FieldEvaluator&&) noexcept = default;
FieldEvaluator& FieldEvaluator::operator=(FieldEvaluator&&) noexcept = default;

void FieldEvaluator::values(std::span<const glm::dvec3> points, std::span<double> values) {
  LIMN_CHECK(points.size() == values.size());
  constexpr size_t kFewest = 16;
  if (const FieldTape* const tape = asks_together() ? nullptr : scratch_->tape_for(field_, points.size(), kFewest))
    return tape_values_at(*tape, points, scratch_->lanes, values);
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
  constexpr size_t kFewest = 8;
  if (const FieldTape* const tape = asks_together() ? nullptr : scratch_->tape_for(field_, points.size(), kFewest))
    return tape_gradients_at(*tape, points, scratch_->lanes, values, gradients);
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
  const FieldProgram& program = field_.program();
  if (program.instructions.size() == 1) {
    const FieldLeaf& leaf = program.leaves[program.instructions[0].leaf];
    const Affine& map = leaf.object_from_world;
    if (leaf.functions->jet != nullptr && leaf.value_scale == 1.0) {
      const auto along = [&](int axis) { return RowMap<double>(map, axis)(point); };
      return leaf.functions->jet(leaf.shape.get(), {along(0), along(1), along(2)}, map.linear);
    }
  }
  FieldJet result;
  jets(std::span(&point, 1), std::span(&result, 1));
  return result;
}

}  // namespace limn
