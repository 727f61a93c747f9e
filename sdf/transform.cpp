// Transforms of fields: folded into the leaves, so that they cost nothing at evaluation.

#include <fmt/format.h>

#include <cmath>

#include "sdf/error.h"
#include "sdf/field_program.h"
#include "sdf/shape.h"

namespace limn {
namespace {

[[noreturn]] void fail(const char* field, const glm::dvec3& value, const char* problem, const char* expected) {
  throw InputError({{}, field, fmt::format("{},{},{}", value.x, value.y, value.z), problem, expected});
}

bool finite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// f(p) becomes value_scale * f(old_from_new p). Every operation in between is homogeneous, so scaling its constant is enough.
Field transformed(const Field& field, const Affine& old_from_new, double value_scale, bool keeps_distance) {
  auto program = std::make_shared<FieldProgram>(field.program());
  for (FieldLeaf& leaf : program->leaves) {
    leaf.object_from_world = compose(leaf.object_from_world, old_from_new);
    leaf.value_scale *= value_scale;
  }
  for (FieldInstruction& step : program->instructions) step.constant *= value_scale;
  program->traits.exact_distance = program->traits.exact_distance && keeps_distance;
  program->traits.bounds = sublevel_bounds(*program, 0.0);
  return Field(std::move(program));
}

}  // namespace

Field translate(const Field& field, const glm::dvec3& by) {
  if (!finite(by)) fail("translate", by, "not finite", "three finite numbers");
  return transformed(field, {glm::dmat3(1.0), -by}, 1.0, true);
}

Field rotate(const Field& field, const glm::dvec3& axis, double angle) {
  const double length = glm::length(axis);
  if (!(length > 0.0) || !std::isfinite(length)) fail("rotate", axis, "not an axis", "three finite numbers, not all 0");
  if (!std::isfinite(angle)) throw InputError({{}, "rotate", fmt::format("{}", angle), "not finite", "a finite angle"});
  const glm::dvec3 k = axis / length;
  const double c = std::cos(angle), s = std::sin(angle);
  const glm::dmat3 cross(0.0, k.z, -k.y, -k.z, 0.0, k.x, k.y, -k.x, 0.0);
  const glm::dmat3 new_from_old = glm::dmat3(c) + s * cross + (1.0 - c) * glm::outerProduct(k, k);
  return transformed(field, {glm::transpose(new_from_old), glm::dvec3(0.0)}, 1.0, true);
}

Field scale(const Field& field, double factor) { return scale(field, glm::dvec3(factor)); }

// f(S^-1 p) may be as much as 1 / min|factors| times as steep as f; times min|factors| it is no steeper, and a lower bound of the distance.
// Negative factors mirror; what is inside stays inside.
Field scale(const Field& field, const glm::dvec3& factors) {
  const glm::dvec3 size = glm::abs(factors);
  const double least = std::min({size.x, size.y, size.z});
  if (!finite(factors) || !(least > 0.0)) fail("scale", factors, "not a scale", "one or three finite factors, none of them 0");
  const glm::dvec3 inverse_factors = 1.0 / factors;
  const glm::dmat3 old_from_new(inverse_factors.x, 0.0, 0.0, 0.0, inverse_factors.y, 0.0, 0.0, 0.0, inverse_factors.z);
  const bool uniform = size.x == size.y && size.y == size.z;
  return transformed(field, {old_from_new, glm::dvec3(0.0)}, least, uniform);
}

}  // namespace limn
