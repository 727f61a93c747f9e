#pragma once
// The flat program behind a Field: shapes at the leaves, and a list of instructions over slots. The list is plain data, so that it can be
// shortened (instructions whose outcome interval bounds decide) or run with wider number types without touching any shape.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "sdf/closed_form.h"
#include "sdf/field.h"
#include "sdf/number.h"
#include "sdf/number_recorded.h"

namespace limn {

/// Evaluates one shape at `count` points of its own space, given as one array for each coordinate.
template <class T>
using ShapeFunction = void (*)(const void* shape, const T* x, const T* y, const T* z, T* values, size_t count);

/// A shape's formula for every number type.
struct ShapeFunctions {
  std::tuple<ShapeFunction<float>, ShapeFunction<double>, ShapeFunction<Dual>, ShapeFunction<Jet>, ShapeFunction<Interval>,
             ShapeFunction<Slope>, ShapeFunction<BoxSlope>>
      evaluate;
  /// The greatest dot(direction, p) over the points p with f(p) <= level, or more; -infinity where there are none.
  /// `direction` need not be unit.
  double (*support)(const void* shape, const glm::dvec3& direction, double level);
  /// Evaluates the formula with a number type that writes down its steps (sdf/tape.h). Null where it branches on values.
  void (*record)(const void* shape, const Vector3<Recorded>& point, Recorded& value);
  /// Where {f <= 0} is an ellipsoid about the origin: 1 / its half axes. Null elsewhere.
  glm::dvec3 (*ball_from_object)(const void* shape);
  /// {f <= level} for levels up to 0 put together from smooth faces by minimum and maximum, in object space: its sharp edges are where two
  /// of them meet. Null where the shape has none, or they are not known one by one.
  Field (*faces)(const void* shape);
  /// Where the surface has a point and no normal, as a cone has at its tip; object space. Null where it has none.
  glm::dvec3 (*tip)(const void* shape);
  /// {f <= level} in closed form, object space; nothing for levels at which there is none. Null where the shape has none at any level.
  std::optional<ClosedForm> (*closed_form)(const void* shape, double level) = nullptr;
  /// What `evaluate` gives of a Jet, to the bit, at one place in object space: derivatives by world coordinates, of which the place is a
  /// linear function. Null where that is no quicker.
  FieldJet (*jet)(const void* shape, const glm::dvec3& place, const glm::dmat3& object_from_world) = nullptr;
  bool together = false;  ///< Many points at once take little longer than one.
};

inline constexpr int kNoMaterial = -1;

/// f(p) = value_scale * shape(object_from_world p).
struct FieldLeaf {
  std::shared_ptr<const void> shape;
  const ShapeFunctions* functions = nullptr;
  Affine object_from_world;
  double value_scale = 1.0;
  double lipschitz = 1.0;            ///< Of f, in world space.
  int material = kNoMaterial;        ///< Of the surface that this shape makes; kNoMaterial: the object's.
  std::optional<glm::vec3> color{};  ///< Linear, the same; empty: the object's.
};

enum class FieldOperation : std::uint8_t {
  leaf,            ///< target = leaf[index]
  minimum,         ///< target = min(left, right)
  maximum,         ///< target = max(left, right)
  smooth_minimum,  ///< ... with the blend radius `constant`
  smooth_maximum,
  negate,    ///< target = -left
  add,       ///< target = left + constant
  absolute,  ///< target = |left|
};

/// A slot may be overwritten by the instruction that reads it. Slots below `target` are left alone.
struct FieldInstruction {
  FieldOperation operation = FieldOperation::leaf;
  std::uint32_t target = 0;
  std::uint32_t left = 0;
  std::uint32_t right = 0;
  std::uint32_t leaf = 0;
  double constant = 0.0;  ///< World units: carries every scale around it.
};

struct FieldProgram {
  std::vector<FieldLeaf> leaves;
  std::vector<FieldInstruction> instructions;  ///< The result is in slot 0 after the last one.
  std::uint32_t slots = 1;
  FieldTraits traits;
};

/// A box that holds {f <= level}: the leaves' support functions, joined and cut as the instructions join and cut.
Box sublevel_bounds(const FieldProgram& program, double level);

/// Wraps a shape: a struct with
///   template <class T> T operator()(const Vector3<T>& p) const;          its value in object space
///   double support(const glm::dvec3& direction, double level) const;     see ShapeFunctions
/// and, where they apply,
///   static constexpr bool kBranches = true;                              the formula compares values, and cannot be recorded
///   glm::dvec3 ball_from_object() const;                                 see ShapeFunctions
///   Field faces() const;                                                 see ShapeFunctions
///   glm::dvec3 tip() const;                                              see ShapeFunctions
///   std::optional<ClosedForm> closed_form(double level) const;           see ShapeFunctions
/// `lipschitz` and `exact` are as in FieldTraits; object_from_world must be rigid.
template <class Shape>
glm::dvec3 tip_of_shape(const void* shape) {
  return static_cast<const Shape*>(shape)->tip();
}
template <class Shape>
constexpr auto tip_of() {
  if constexpr (requires(const Shape& s) { s.tip(); }) {
    return tip_of_shape<Shape>;
  } else {
    return nullptr;
  }
}

template <class Shape>
Field field_from_shape(Shape shape, double lipschitz, bool exact, const Affine& object_from_world = {});

Field field_from_leaf(FieldLeaf leaf, bool exact);

template <class Shape, class T>
void evaluate_shape(const void* shape, const T* x, const T* y, const T* z, T* values, size_t count) {
  // A copy on the stack tells the compiler that writing values does not change the shape, so that it may vectorise.
  const auto evaluate = [=](const Shape& s) {
    for (size_t i = 0; i < count; ++i) values[i] = s(Vector3<T>{x[i], y[i], z[i]});
  };
  if constexpr (std::is_trivially_copyable_v<Shape>) {
    const Shape copy = *static_cast<const Shape*>(shape);
    evaluate(copy);
  } else {
    evaluate(*static_cast<const Shape*>(shape));
  }
}

template <class Shape>
void record_shape(const void* shape, const Vector3<Recorded>& point, Recorded& value) {
  value = (*static_cast<const Shape*>(shape))(point);
}
template <class Shape>
glm::dvec3 ball_from_object_of(const void* shape) {
  return static_cast<const Shape*>(shape)->ball_from_object();
}
template <class Shape>
constexpr auto recorder_of() {
  if constexpr (requires { Shape::kBranches; }) {
    return nullptr;
  } else {
    return record_shape<Shape>;
  }
}
template <class Shape>
constexpr auto ball_of() {
  if constexpr (requires(const Shape& s) { s.ball_from_object(); }) {
    return ball_from_object_of<Shape>;
  } else {
    return nullptr;
  }
}

template <class Shape>
Field faces_of_shape(const void* shape) {
  return static_cast<const Shape*>(shape)->faces();
}
template <class Shape>
constexpr auto faces_of() {
  if constexpr (requires(const Shape& s) { s.faces(); }) {
    return faces_of_shape<Shape>;
  } else {
    return nullptr;
  }
}

template <class Shape>
std::optional<ClosedForm> closed_form_of_shape(const void* shape, double level) {
  return static_cast<const Shape*>(shape)->closed_form(level);
}
template <class Shape>
constexpr auto closed_form_of() {
  if constexpr (requires(const Shape& s) { s.closed_form(0.0); }) {
    return closed_form_of_shape<Shape>;
  } else {
    return nullptr;
  }
}

template <class Shape>
Field field_from_shape(Shape shape, double lipschitz, bool exact, const Affine& object_from_world) {
  static constexpr ShapeFunctions functions{
      {evaluate_shape<Shape, float>, evaluate_shape<Shape, double>, evaluate_shape<Shape, Dual>, evaluate_shape<Shape, Jet>,
       evaluate_shape<Shape, Interval>, evaluate_shape<Shape, Slope>, evaluate_shape<Shape, BoxSlope>},
      [](const void* s, const glm::dvec3& direction, double level) { return static_cast<const Shape*>(s)->support(direction, level); },
      recorder_of<Shape>(),
      ball_of<Shape>(),
      faces_of<Shape>(),
      tip_of<Shape>(),
      closed_form_of<Shape>()};
  FieldLeaf leaf;
  leaf.shape = std::make_shared<const Shape>(std::move(shape));
  leaf.functions = &functions;
  leaf.object_from_world = object_from_world;
  leaf.lipschitz = lipschitz;
  return field_from_leaf(std::move(leaf), exact);
}

}  // namespace limn
