#pragma once
// Internal: a program taken apart at the minima and maxima that it ends in, so that what is left between them is smooth: the unions and
// intersections of a field (sdf/field_program.h).

#include "sdf/vm/vm_program.h"

namespace limn::vm {

/// A part: scale * value + added, of one step of the program.
struct Part {
  std::uint32_t step = 0;
  double scale = 1.0, added = 0.0;
};
/// Minimum or maximum of two nodes, or a part.
struct Node {
  bool maximum = false;
  int left = -1, right = -1;  ///< Nodes; -1 in a part's.
  int part = -1;
};
struct SplitProgram {
  std::vector<Part> parts{};
  std::vector<Node> nodes{};  ///< Children before parents; the last is the root.
};

/// Where the tree would have more parts than this the program stays whole.
inline constexpr size_t kMostParts = 4096;

SplitProgram split(const Program& program);
/// The steps that `result` is computed from, renumbered, `result` last.
Program steps_for(const Program& program, std::uint32_t result);
/// What a part needs of the program, its own value last.
Program part_of(const Program& program, const Part& part);

}  // namespace limn::vm
