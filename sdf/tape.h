#pragma once
// A field as a flat list of elementary steps over registers, the form that SIMD lanes run (sdf/tape_lanes.h). A shape's formula is recorded
// once, by evaluating it with a number type that writes down what is done to it; pruning such a list for a region copies plain data and
// leaves out everything without influence there (Keeter, "Massively parallel rendering of complex closed-form implicit surfaces", 2020).

#include <cstdint>
#include <span>
#include <vector>

#include "sdf/field.h"
#include "sdf/geometry.h"

namespace limn {

struct FieldLeaf;  // sdf/field_program.h

enum class TapeOperation : std::uint8_t {
  coordinates,  ///< target, target + 1, target + 2 = the point in the object space of `leaf`; of these only the `axes`.
  shape,        ///< target = the formula of `leaf` at (a, b, c), which takes other ways at other points and so cannot be recorded
  narrow,       ///< Bounds of a, the value of `leaf`, cut to what its Lipschitz constant allows; nothing for other numbers. In place.
  copy,
  constant,
  negate,
  square,
  absolute,
  sine,
  cosine,
  add_constant,
  multiply_constant,
  add,
  subtract,
  multiply,
  norm2,
  norm3,
  corner2,
  corner3,
  power_norm,  ///< `constant` is the power.
  minimum,
  maximum,
  smooth_minimum,  ///< `constant` is the blend radius.
  smooth_maximum,
};

struct TapeStep {
  TapeOperation operation = TapeOperation::copy;
  bool inside_shape = false;  ///< Others may read its operands too.
  bool flat = false;          ///< What it reads has no second derivatives anywhere, and is not asked for them (runs_flat).
  bool bare = false;          ///< The same of its result: jets leave it without them.
  bool sign_decides = false;  ///< Between its result and the field's there are nothing but minima, maxima and changes of sign.
  std::uint8_t axes = 7;      ///< Bit i: the i-th coordinate is read.
  std::uint32_t target = 0;
  std::uint32_t a = 0, b = 0, c = 0;
  std::uint32_t leaf = 0;
  double constant = 0.0;
};

struct TapeLeaf {
  const FieldLeaf* leaf = nullptr;
  double row[3][4]{};            ///< Object from world: row . (x, y, z, 1).
  bool translated_only = false;  ///< The rows are those of the unit matrix.
  double lipschitz = 1.0;        ///< Of the value, in world space.
  double offset_extent = 0.0;    ///< How large the translation's part of the value may be: for rounding.
  /// Where {f <= 0} is a ball or an ellipsoid: object space times these is the space in which it is the unit ball. 0: it is neither.
  glm::dvec3 ball_from_object{0.0};
};

/// The result is in register 0 after the last step.
struct FieldTape {
  explicit FieldTape(const Field& field);
  Field field;  ///< Keeps the shapes alive.
  std::vector<TapeLeaf> leaves;
  std::vector<TapeStep> steps;
  std::uint32_t registers = 0;
  size_t joints = 0;  ///< Minima and maxima, smooth ones among them.
  /// Where f is nearer to 0 than this, pruned tapes give it to the last bit; elsewhere its sign, and a value no nearer to 0.
  double margin = 0.0;
};

/// What bounds say of a step that chooses among its operands: bit i set where operand a, b or c has no influence in lane i, be it on the
/// value or (TapeStep::sign_decides) on the sign: in a union whatever is positive may go, although it may be the lesser of two positive
/// values. Of `absolute`: bit i of the first set where its operand is negative there, of the second where it is positive.
struct TapeChoice {
  std::uint16_t idle[3] = {0, 0, 0};
};

/// What a pruned tape is for: bounds narrow the leaves' values, nothing else does.
enum class TapeUse { bounds, points };

/// Writes to `pruned` the steps that have influence in the lanes of `lanes`, in order; `choices` has one entry a step. In those lanes the
/// result is as good as the same, see FieldTape::margin.
void prune_tape(std::span<const TapeStep> steps, std::span<const TapeChoice> choices, std::uint16_t lanes, std::uint32_t registers,
                TapeUse use, std::vector<TapeStep>& pruned);

/// Registers that steps of a tape of so many may use: pruned ones of few steps take a fresh one for each, so that none has to copy.
std::uint32_t registers_used(std::uint32_t registers);

}  // namespace limn
