#pragma once
// Internal: fidget's and libfive's .vm files, a list of arithmetic operations, one a line: "NAME OPERATION OPERANDS". The last one's value
// is the field. Jumps (floor, compare, and the like) are not read: a field with jumps has no surface where it is 0.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace limn::vm {

enum class Operation : std::uint8_t {
  x,
  y,
  z,
  constant,
  negate,
  absolute,
  square,
  sine,
  cosine,
  square_root,
  tangent,
  arc_sine,
  arc_cosine,
  arc_tangent,
  exponential,
  logarithm,
  reciprocal,
  add_constant,  ///< Made by simplified(), as are those below multiply.
  multiply_constant,
  add,
  subtract,
  multiply,
  divide,
  minimum,
  maximum,
  norm2,
  norm3,
};

struct Step {
  Operation operation = Operation::constant;
  std::uint32_t a = 0, b = 0, c = 0;  ///< Earlier steps.
  double constant = 0.0;
  std::uint32_t line = 0;
};
int operands(Operation operation);

/// Step i makes value i, the last one's is the result.
using Program = std::vector<Step>;

inline constexpr size_t kMostOperations = 10'000;

/// Throws InputError with file and line.
Program parse(std::string_view text, const std::string& file);
/// The same function in fewer steps: constants folded, x * x as a square, square roots of sums of squares as lengths, what nobody reads
/// left out.
Program simplified(const Program& program);

}  // namespace limn::vm
