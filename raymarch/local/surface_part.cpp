#include "raymarch/local/surface_part.h"

#include <cmath>

#include "raymarch/local/brick_demand.h"
#include "raymarch/local/mesh_part.h"
#include "sdf/number.h"

namespace limn {
namespace {

/// By bounds of the value, then by those of its slope about the middle.
bool field_passes(FieldEvaluator& evaluator, const Box& box) {
  if (!evaluator.bounds(box).contains(0.0)) return false;
  const GradientBounds bounds = evaluator.gradient_bounds(box);
  const glm::dvec3 half = 0.5 * box.size();
  double reach = 0.0;
  for (int axis = 0; axis < 3; ++axis) reach += half[axis] * magnitude(bounds.gradient[static_cast<size_t>(axis)]);
  // Corners are nowhere nearer to the middle than rounding makes them.
  return std::abs(evaluator.value(box.center())) <= reach * (1.0 + 1e-9) + 1e-12 * glm::length(half);
}

std::variant<FieldEvaluator, MeshPart> evaluator_of(const SurfacePart& part) {
  if (const Field* field = std::get_if<Field>(&part)) return FieldEvaluator(*field);
  return std::get<MeshPart>(part);
}

}  // namespace

Box bounds_of(const SurfacePart& part) {
  const Field* const field = std::get_if<Field>(&part);
  return field ? field->traits().bounds : std::get<MeshPart>(part).body->bounds();
}

PartEvaluator::PartEvaluator(const SurfacePart& part) : part_(evaluator_of(part)) {}

bool PartEvaluator::may_hold_surface(const Box& box) {
  if (auto* field = std::get_if<FieldEvaluator>(&part_)) return field_passes(*field, box);
  return limn::may_hold_surface(std::get<MeshPart>(part_), box);
}

bool PartEvaluator::may_come_near(const Box& box) {
  if (auto* field = std::get_if<FieldEvaluator>(&part_)) return field->bounds(box).contains(0.0);
  return limn::may_hold_surface(std::get<MeshPart>(part_), box);
}

SurfacePart PartEvaluator::restricted(const Box& box) {
  if (auto* field = std::get_if<FieldEvaluator>(&part_)) return field->restricted(box);
  return std::get<MeshPart>(part_);
}

bool PartEvaluator::is_inside(const glm::dvec3& point) {
  if (auto* field = std::get_if<FieldEvaluator>(&part_)) return field->value(point) < 0.0;
  return std::get<MeshPart>(part_).body->winding().number(point) > 0.5;
}

bool PartEvaluator::needs_smaller_voxels(const Box& box, double voxel_size, double smaller, const LocalBrickSettings& settings) {
  if (auto* field = std::get_if<FieldEvaluator>(&part_)) return limn::needs_smaller_voxels(*field, box, voxel_size, smaller, settings);
  return limn::needs_smaller_voxels(std::get<MeshPart>(part_), box, voxel_size, smaller, settings);
}

}  // namespace limn
