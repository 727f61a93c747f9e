#pragma once
// Internal: what the nodes of smaller bricks take from the larger ones beside them, so that the surface has no crack between two sizes.

#include "raymarch/local/local_nodes.h"

namespace limn {

/// Bits of blocks of 2^3 cells (see covered_bit).
struct SurfaceBlocks {
  std::uint64_t near = 0;    ///< With values nearer to the surface than asked, or on both sides of it.
  std::uint64_t inside = 0;  ///< Of the others those inside the surface.
};

/// The bricks of the next larger size, and their values.
struct Larger {
  const LevelNodes* nodes = nullptr;
  int step = 0;  ///< How often the smaller voxels are doubled.
  KeyNumbers bricks{};
  std::vector<std::uint64_t> open{};    ///< [number of a brick]: the blocks of its cells that no smaller brick holds.
  std::vector<SurfaceBlocks> blocks{};  ///< As many.
};

/// `nodes` are theirs; `h`: the smaller voxels, doubled `step` times.
Larger larger_of(const LevelNodes& nodes, int step, const std::vector<LocalBrick>& bricks, double h);

/// The open cells of larger bricks that nodes of a block (of the smaller voxels) lie on.
class LargerBeside {
 public:
  LargerBeside(const Larger& larger, const glm::ivec3& origin);

  bool any() const { return (near_ | inside_ | outside_) != 0; }
  /// Bits of the block's nodes along x = `word` that lie on cells that their surface passes or comes near to (as in LevelSetBlock).
  std::uint64_t near_nodes(size_t word) const;
  /// True where the node lies on cells that are wholly on the other side of their surface than `inside` says.
  bool on_other_side(const glm::ivec3& node, bool inside) const { return ((inside ? outside_ : inside_) >> before(node) & 1) != 0; }

  /// False: what the surface tells stands wherever nodes are not near.
  bool may_be_on_other_side() const { return (inside_ | outside_) != 0; }

  double interpolated(const glm::ivec3& node);

 private:
  /// Larger nodes about the block along each axis: five of twice the size.
  static constexpr int kMostLargerNodes = 5;

  void load_values();
  size_t at(const glm::ivec3& larger) const {
    const glm::ivec3 from = larger - first_;
    const int place = (from.x * kMostLargerNodes + from.y) * kMostLargerNodes + from.z;
    return static_cast<size_t>(place);
  }

  /// The axes along which the node lies on the block's first face.
  static unsigned before(const glm::ivec3& node) {
    return ((node.x & 7) == 0 ? 1u : 0u) | ((node.y & 7) == 0 ? 2u : 0u) | ((node.z & 7) == 0 ? 4u : 0u);
  }
  /// [k]: bit b is set where nodes on the first faces along the axes of b lie on what is before the block along those of k.
  static constexpr unsigned kTouchedFrom[8] = {0xff, 0xaa, 0xcc, 0x88, 0xf0, 0xa0, 0xc0, 0x80};

  const Larger& larger_;
  glm::ivec3 first_{0};                           ///< The larger node at the block's first one.
  unsigned near_ = 0, inside_ = 0, outside_ = 0;  ///< Bits as in kTouchedFrom.
  bool is_loaded_ = false;
  std::array<double, size_t{kMostLargerNodes} * kMostLargerNodes * kMostLargerNodes> values_;  ///< Of the larger nodes, once loaded.
};

}  // namespace limn
