#pragma once
// Internal: nodes of one voxel size of a local level set, in blocks of 8^3.

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "raymarch/local/surface_part.h"
#include "sdf/large_pages.h"

namespace limn {

/// Bits as in LevelSetBlock.
struct NodeBlock {
  NodeBlock(const glm::ivec3& first, const SurfacePart& of) : origin(first), part(&of) {}
  glm::ivec3 origin{0};
  bool measured = false;              ///< Of a mesh: the steps of the others are those that they will have if they are wanted.
  const SurfacePart* part = nullptr;  ///< Asked for its nodes: of a brick, as long as there are nodes to be measured.
  std::array<std::uint64_t, 8> wanted{}, known{};
  std::array<std::int16_t, 512> steps;  ///< Of the known ones.

  bool is_known(size_t n) const { return (known[n >> 6] >> (n & 63) & 1) != 0; }
};

/// Blocks in the order in which they came; they stay where they are. In chunks of large pages: the first touch of small ones takes longer
/// than what is asked of the surface.
class NodeBlocks {
 public:
  NodeBlock& add(const glm::ivec3& origin, const SurfacePart& part) {
    if (size() == first_of(chunks_.size())) chunks_.emplace_back().reserve(chunks_.size() == 1 ? kFirst : kOthers);
    return chunks_.back().emplace_back(origin, part);
  }
  size_t size() const { return empty() ? 0 : first_of(chunks_.size() - 1) + chunks_.back().size(); }
  bool empty() const { return chunks_.empty(); }
  NodeBlock& operator[](size_t i) { return chunks_[chunk_of(i)][i - first_of(chunk_of(i))]; }
  const NodeBlock& operator[](size_t i) const { return chunks_[chunk_of(i)][i - first_of(chunk_of(i))]; }

 private:
  /// A small surface takes no large page.
  static constexpr size_t kFirst = 32, kOthers = (size_t{4} << 20) / sizeof(NodeBlock);
  static constexpr size_t chunk_of(size_t i) { return i < kFirst ? 0 : 1 + (i - kFirst) / kOthers; }
  static constexpr size_t first_of(size_t chunk) { return chunk == 0 ? 0 : kFirst + (chunk - 1) * kOthers; }

  std::vector<std::vector<NodeBlock, LargePageAllocator<NodeBlock>>> chunks_{};
};

}  // namespace limn
