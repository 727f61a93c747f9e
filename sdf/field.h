#pragma once
// The field contract. A Field is an immutable expression: shapes at the leaves, CSG and offsets above, every transform folded into
// the leaves. It is negative inside, zero on the surface, positive outside. Copying a Field copies a pointer.

#include <array>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <string>

#include "sdf/geometry.h"

namespace limn {

struct FieldProgram;  // sdf/field_program.h: the flat list of instructions behind a Field

/// What is true of a field everywhere.
struct FieldTraits {
  double lipschitz = 1.0;       ///< |f(p) - f(q)| <= lipschitz * |p - q|; finite and above 0.
  bool exact_distance = false;  ///< Outside and inside, |f| is the Euclidean distance to the surface.
  Box bounds{};                 ///< Holds the surface; infinite for planes and unbounded lattices; empty for an empty surface.
};

/// An immutable implicit surface. Copies share one program; any number of threads may read it. Made by sdf/shape.h, field_from_formula(),
/// field_from_functions() and vm_field().
class Field {
 public:
  /// For makers of programs in limn itself; `program` is not null.
  explicit Field(std::shared_ptr<const FieldProgram> program) : program_(std::move(program)) {}
  const FieldProgram& program() const { return *program_; }  ///< Valid as long as a copy of the field is.
  const FieldTraits& traits() const;                         ///< Valid as long as a copy of the field is.

 private:
  std::shared_ptr<const FieldProgram> program_;
};

/// Value and slope bounds along a stretch of a ray.
struct RayBounds {
  Interval value;  ///< Holds f at every point of the stretch.
  Interval slope;  ///< Holds every one-sided derivative of f by t on the stretch (Clarke), so 0 outside it means monotone.
};

/// Value and gradient bounds over a box.
struct GradientBounds {
  Interval value{};                    ///< Holds f at every point of the box.
  std::array<Interval, 3> gradient{};  ///< Holds every element of Clarke's generalised gradient: at creases, the hull of both sides.
};

/// Value, gradient and Hessian at a point.
struct FieldJet {
  double value = 0.0;        ///< f
  glm::dvec3 gradient{0.0};  ///< grad f, world.
  glm::dmat3 hessian{0.0};   ///< Symmetric. At a crease or a CSG seam: that of one of the two sides.
};

/// Evaluates one field; owns its scratch memory, so keep one for each thread. All points are world points.
/// At a crease the gradient is that of one of the two sides; where it is undefined (centre of a sphere) it is finite.
class FieldEvaluator {
 public:
  /// Keeps a copy of the field.
  explicit FieldEvaluator(const Field& field);
  /// Frees the scratch memory.
  ~FieldEvaluator();
  /// Takes the other's scratch memory; the other can only be assigned to or destroyed.
  FieldEvaluator(FieldEvaluator&&) noexcept;
  /// Takes the other's scratch memory; the other can only be assigned to or destroyed.
  FieldEvaluator& operator=(FieldEvaluator&&) noexcept;

  const Field& field() const { return field_; }  ///< Valid as long as the evaluator is.

  /// f at each point; sizes equal.
  void values(std::span<const glm::dvec3> points, std::span<double> values);
  /// The same in single precision, for marching: relative error about 1e-6 of the field's extent.
  void values(std::span<const glm::vec3> points, std::span<float> values);
  /// f and grad f at each point; sizes equal.
  void gradients(std::span<const glm::dvec3> points, std::span<double> values, std::span<glm::dvec3> gradients);
  /// f, grad f and the Hessian at each point; sizes equal.
  void jets(std::span<const glm::dvec3> points, std::span<FieldJet> jets);

  /// f at one point. Many points at once (values()) take less time each.
  double value(const glm::dvec3& point);
  /// f, grad f and the Hessian at one point.
  FieldJet jet(const glm::dvec3& point);

  /// Bounds of f over a box: never too narrow; the tighter of interval arithmetic and the Lipschitz bound about the centre.
  Interval bounds(const Box& box);
  /// The same over each of several boxes; sizes equal. A field from a function of many points (FieldFunctions::values) is asked once.
  void bounds(std::span<const Box> boxes, std::span<Interval> bounds);
  /// True for such a field.
  bool asks_together() const;
  /// Bounds of f and of its slope on origin + t * direction, t in `t`.
  RayBounds bounds_along(const glm::dvec3& origin, const glm::dvec3& direction, Interval t);
  /// Bounds of f and grad f over a box; the whole line for a box that is not finite.
  GradientBounds gradient_bounds(const Box& box);

  /// A field that equals this one in `box`, to the last bit, without the parts that bounds show to be without influence there (Keeter,
  /// "Massively parallel rendering of complex closed-form implicit surfaces", 2020). Its traits are those of the whole field.
  Field restricted(const Box& box);

 private:
  struct Scratch;
  Field field_;
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace limn
