#pragma once
// Internal: nodes of one voxel size of a local level set, in blocks of 8^3.

#include <array>
#include <bit>
#include <cstdint>
#include <utility>
#include <vector>

#include "raymarch/local/surface_part.h"
#include "sdf/large_pages.h"

namespace limn {

/// Bits as in LevelSetBlock. Between a brick and what lies beside it there are many blocks of few nodes.
struct NodeBlock {
  NodeBlock(const glm::ivec3& first, const SurfacePart& of) : origin(first), part(&of) {}
  glm::ivec3 origin{0};
  bool measured = false;              ///< Of a mesh: the steps of the others are those that they will have if they are wanted.
  bool whole = false;                 ///< Has room for all nodes; else for those that were wanted when room was made.
  const SurfacePart* part = nullptr;  ///< Asked for its nodes: of a brick, as long as there are nodes to be measured.
  std::array<std::uint64_t, 8> wanted{}, known{};
  std::array<std::uint16_t, 8> before{};  ///< How many nodes with room come before those of each word.
  std::int16_t* steps = nullptr;          ///< Room for the steps of nodes, in their order.

  bool is_known(size_t n) const { return (known[n >> 6] >> (n & 63) & 1) != 0; }
  std::int16_t step(size_t n) const { return steps[slot(n)]; }  ///< Of a known node.
  /// Of a node with room.
  void set(size_t n, std::int16_t step) { steps[slot(n)] = step; }
  /// Nodes of a row along z that all have room lie one behind the other.
  size_t slot(size_t n) const {
    if (whole) return n;
    return before[n >> 6] + static_cast<size_t>(std::popcount(wanted[n >> 6] & ((std::uint64_t{1} << (n & 63)) - 1)));
  }
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
  /// For all nodes that are wanted and not known; once they are there, `step` and `set` serve until other nodes are wanted. `whole`: for
  /// every node of such blocks.
  void make_room(bool whole);
  NodeBlock& operator[](size_t i) { return chunks_[chunk_of(i)][i - first_of(chunk_of(i))]; }
  const NodeBlock& operator[](size_t i) const { return chunks_[chunk_of(i)][i - first_of(chunk_of(i))]; }

 private:
  /// A small surface takes no large page.
  static constexpr size_t kFirst = 32, kOthers = (size_t{4} << 20) / sizeof(NodeBlock);
  static constexpr size_t chunk_of(size_t i) { return i < kFirst ? 0 : 1 + (i - kFirst) / kOthers; }
  static constexpr size_t first_of(size_t chunk) { return chunk == 0 ? 0 : kFirst + (chunk - 1) * kOthers; }

  std::int16_t* room_for(size_t nodes);

  std::vector<std::vector<NodeBlock, LargePageAllocator<NodeBlock>>> chunks_{};
  std::vector<std::vector<std::int16_t, LargePageAllocator<std::int16_t>>> rooms_{};
  size_t taken_ = 0;  ///< Of the last room.
};

}  // namespace limn
