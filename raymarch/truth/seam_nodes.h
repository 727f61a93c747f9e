#pragma once
// Internal: where patches of a limit surface meet. Samples there that lie at one place are one node, and those of a node that share a
// normal are one side.

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "sdf/key_numbers.h"

namespace limn {

class SeamNodes {
 public:
  struct Node {
    glm::dvec3 position{0.0};
    std::uint32_t number = 0;  ///< As LimitCorner::node.
    std::uint32_t first_side = 0xffffffffu;
    std::uint32_t next = 0xffffffffu;  ///< In its cell.
  };
  struct Side {
    glm::dvec3 normal{0.0};
    std::uint32_t number = 0;  ///< As LimitCorner::side.
    std::uint32_t node = 0;    ///< Its node's number.
    std::uint32_t next = 0xffffffffu;
  };

  /// Places nearer to each other than `tolerance` are one.
  explicit SeamNodes(double tolerance) : tolerance_(tolerance) {}
  /// The node at `p`, an index of nodes(). A new one takes `next_number`, which grows.
  std::uint32_t node_at(const glm::dvec3& p, std::uint32_t& next_number);
  /// The number of the node's side that has this normal. A new one takes `next_number`, which grows.
  std::uint32_t side_of(std::uint32_t node, const glm::dvec3& normal, std::uint32_t& next_number);

  std::span<const Node> nodes() const { return nodes_; }
  std::span<const Side> sides() const { return sides_; }

 private:
  double tolerance_;
  std::vector<Node> nodes_{};
  std::vector<Side> sides_{};
  /// By cells twice as wide as the tolerance, of which a point's neighbourhood touches at most eight.
  KeyNumbers cells_{};
  std::vector<std::uint32_t> first_in_cell_{};  ///< The latest node, by the cell's number.
};

}  // namespace limn
