#pragma once
// Internal: on which side of a closed mesh the faces of blocks lie that are filled already.

#include <array>
#include <glm/glm.hpp>
#include <map>
#include <utility>

namespace limn {

/// The nodes of a block that face the next one along an axis, and on which side of the surface they lie.
struct BlockFace {
  std::array<double, 64> distances{};  ///< By the other two coordinates, 8 times the first of them.
  std::array<int, 64> numbers{};       ///< The winding numbers.
};
using BlockFaces = std::array<BlockFace, 3>;

/// Faces of blocks that are filled, for those behind them; of blocks filled in the order of x, y and z, as long as they are needed.
class FilledBlocks {
 public:
  void add(const glm::ivec3& origin, const BlockFaces& faces);
  /// That of the block before `origin` along the axis; null where none is known.
  const BlockFace* before(const glm::ivec3& origin, int axis) const;

 private:
  /// Blocks of one x.
  struct Slab {
    int x = 0;
    std::map<std::pair<int, int>, BlockFaces> blocks{};  ///< By y and z.
  };
  std::array<Slab, 2> slabs_{};  ///< The last, and the one before it.
};

}  // namespace limn
