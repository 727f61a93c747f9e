#pragma once
// Internal: the surface's distances at the nodes of a local level set's bricks.

#include <array>
#include <optional>

#include "raymarch/local/larger_bricks.h"
#include "raymarch/local/mesh_part.h"
#include "sdf/level_set_distance.h"

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

/// Tells of blocks whose wanted nodes are known on which side of the surface the others lie. Keep one for each thread.
class NodeSides {
 public:
  /// Of nodes origin + h * node, in the space of the blocks' parts.
  NodeSides(const glm::dvec3& origin, double h) : origin_(origin), h_(h) {}

  /// Bits as in LevelSetBlock: inside. Those of known nodes say nothing.
  std::array<std::uint64_t, 8> inside(const NodeBlock& block);

 private:
  glm::dvec3 origin_;
  double h_;
  std::optional<DistanceEvaluator> distance_{};
};

}  // namespace limn
