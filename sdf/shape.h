#pragma once
// Shapes by name, and the operations that build fields from fields.

#include <span>

#include "sdf/field.h"
#include "sdf/registry.h"

namespace limn {

/// A registry entry: one file in sdf/shapes/ and one line in sdf/shapes/all_shapes.cpp.
struct ShapeDescriptor {
  Description about{};                  ///< Name, help and source.
  std::vector<Parameter> parameters{};  ///< What `make` reads, in the order of help.
  Field (*make)(const Parameters&);     ///< Throws InputError for combinations that no single range can exclude.
};

/// All shapes, in the order of sdf/shapes/all_shapes.cpp.
const Registry<ShapeDescriptor>& shapes();
/// Throws InputError naming the nearest known shape. `file` and `field` go into the message.
inline const ShapeDescriptor& find_shape(const std::string& name, const std::string& file = {}, const std::string& field = {}) {
  return shapes().find(name, file, field);
}

/// Shape with defaults overridden by name, for code: make_shape("torus", {{"major", {1.0}}, {"minor", {0.3}}}).
Field make_shape(const std::string& name, const std::map<std::string, std::vector<double>>& values = {});

// The operations throw InputError for numbers that are not finite or out of the ranges given (fields "smooth", "shell", "offset",
// "translate", "rotate", "scale").

/// How two fields become one; `difference`: the first without the second.
enum class Csg { union_, intersection, difference };

/// `smooth_radius` (world, >= 0): 0 is sharp (min, max); above it a polynomial blend of second-order contact (C2), whose zones
/// reach `smooth_radius` from the seam, whose Lipschitz constant is that of the children and whose value is no longer a distance.
Field combine(Csg operation, const Field& a, const Field& b, double smooth_radius = 0.0);
/// Left fold over at least one field (a tree for union and intersection).
Field combine(Csg operation, std::span<const Field> fields, double smooth_radius = 0.0);

Field offset(const Field& field, double distance);  ///< f - distance: grown where distance > 0 (world).
Field shell(const Field& field, double thickness);  ///< |f| - thickness/2: a wall of that thickness (world, > 0).
/// The surface moved by `by` (world).
Field translate(const Field& field, const glm::dvec3& by);
Field rotate(const Field& field, const glm::dvec3& axis, double angle);  ///< Radians, right-handed; axis need not be unit.
Field scale(const Field& field, double factor);                          ///< Exact; not 0, negative ones mirror.
Field scale(const Field& field, const glm::dvec3& factors);  ///< None 0; lower bound of the distance, keeps the Lipschitz constant.

/// Brings `point` onto the surface: damped Newton along the gradient in double precision.
/// Returns false (and the best point) where it does not reach |f| <= tolerance * radius of the bounds (or a few units in the last place of
/// the coordinates, where that is more) within 50 steps: in a centre, or caught in a crease. Unbounded fields count as max(1, |point|)
/// large.
bool project_to_surface(FieldEvaluator& evaluator, glm::dvec3& point, double tolerance = 1e-12);

}  // namespace limn
