#pragma once
// Internal: the surface's distances at the nodes of a local level set's bricks.

#include "raymarch/local/larger_bricks.h"
#include "raymarch/local/mesh_part.h"

namespace limn {

/// How the nodes of one size are measured.
struct NodeMeasure {
  const LocalChoice& choice;
  NodeLattice lattice;
  float steps_per_unit = 0.0f;
  const Larger* larger = nullptr;  ///< Null: nothing is taken from larger bricks.

  std::int16_t steps(double value) const { return quantised(static_cast<float>(value), steps_per_unit); }
};

/// Makes all wanted nodes known, in parallel.
void measure_wanted(NodeBlocks& blocks, const NodeMeasure& measure);

}  // namespace limn
