#pragma once
// Internal: which nodes of a block hang together off a mesh.

#include <array>
#include <span>
#include <vector>

namespace limn {

/// Unsigned distances (world) of a block's 512 nodes (64 x + 8 y + z); infinite beyond the band.
using BlockDistanceArray = std::array<double, 512>;

/// Nodes that steps join which cannot cross a triangle.
struct BlockComponent {
  int first = 0, begin = 0, end = 0;  ///< Its lowest node; its nodes in BlockComponents::members.
  int speaker = -1;                   ///< The node that answered for all of it; -1: not yet, or not for all.
  double number = 0.0;                ///< The mesh's winding number there.
  int size() const { return end - begin; }
};

struct BlockComponents {
  std::array<int, 512> of{};                 ///< [node]: its component.
  std::vector<int> members{};                ///< Nodes, component by component.
  std::vector<BlockComponent> components{};  ///< Large ones first: small ones may learn their side from them.

  std::span<const int> members_of(const BlockComponent& component) const {
    return std::span(members).subspan(static_cast<size_t>(component.begin), static_cast<size_t>(component.size()));
  }
};

/// A straight step from p to q of length h cannot meet a triangle while d(p) + d(q) > h; with room for rounding.
inline constexpr double kClearStep = 1.000001;

/// Of steps along the axes. `from_first`: members in the order in which steps from the first one reach them, which takes longer; else in
/// their own.
BlockComponents components_of(const BlockDistanceArray& distances, double voxel_size, bool from_first);

}  // namespace limn
