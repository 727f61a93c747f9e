#pragma once
// Internal: on which side of an open mesh the nodes of a block lie.

#include <array>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "subdiv/block_nodes.h"
#include "subdiv/block_potential.h"
#include "subdiv/mesh_distance.h"

namespace limn {

/// Near the holes of a mesh its winding number changes smoothly through one half. Bounds of its slope tell how far one node speaks for
/// others; where they say too little, each node's own number is asked for. The surface {w = 1/2}, which closes the hole, counts as surface
/// with its distance to first order, |w - 1/2| / |grad w|.
class OpenSides {
 public:
  /// `inside` becomes true of nodes that are found to be.
  OpenSides(const BlockNodes& nodes, const Winding& winding, double half_width, std::array<bool, kBlockNodes>& inside)
      : nodes_(nodes), winding_(winding), half_width_(half_width), inside_(inside) {}

  /// No slope within the block and in reach of its nodes is larger.
  double slope_bound();
  /// Whether all nodes within `reach` of one where the winding is `number` are on its side, and the membrane out of their band's reach.
  /// Within the block, which no border enters, the number is a smooth potential and whole numbers: along a component's ways only the
  /// potential changes, by no more than its slope times the straight distance.
  bool decides(double number, double reach, double slope, double error = Winding::kFarError) const;
  /// Nodes of one component of the block, for which no single one speaks.
  void settle(std::span<const int> nodes);

  /// Nodes, and their distances once the continuation over holes counts.
  const std::vector<std::pair<int, double>>& near_membrane() const { return near_membrane_; }
  /// The continuation over a hole runs through the block or near by.
  bool has_membrane() const { return has_membrane_; }

 private:
  double number_at(int node) const;
  std::optional<double> number_from(int node, double number, int next) const;
  void near_hole(int node, double number);

  BlockNodes nodes_;
  const Winding& winding_;
  double half_width_;
  std::array<bool, kBlockNodes>& inside_;
  double slope_bound_ = -1.0;  ///< Below 0: not asked for yet.
  std::optional<BlockPotential> potential_{};
  std::vector<std::pair<int, double>> near_membrane_{};
  bool has_membrane_ = false;
};

}  // namespace limn
