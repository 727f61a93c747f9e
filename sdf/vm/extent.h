#pragma once
// Internal: where a program's values can be at or below a level, found by interval arithmetic.

#include "sdf/geometry.h"
#include "sdf/vm/evaluate.h"

namespace limn::vm {

/// The search looks this far from the origin, in the file's units.
inline constexpr double kFarthest = 1048576.0;

struct Extent {
  /// Holds {f < level} within kFarthest, sheets thinner than rounding left out; infinite along axes where it reaches that far. Empty: there
  /// is nothing.
  Box box{};
  bool proven[3][2] = {};  ///< Along each axis, downwards and upwards: a point below the level was found that far out.
};

/// By branch and bound: the part of the box that reaches farthest is halved until it is small or holds nothing.
Extent find_extent(const RegisterProgram& program, const bool reads_axis[3], double level);

/// Bounds of |grad f| over a box, cut into 6 x 6 x 6 cells; infinite where it has none.
double steepest(const RegisterProgram& program, const Box& box, const bool reads_axis[3]);

}  // namespace limn::vm
