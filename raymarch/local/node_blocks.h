#pragma once
// Internal: nodes of one voxel size of a local level set, in blocks of 8^3.

#include <array>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "raymarch/local/surface_part.h"
#include "sdf/large_pages.h"

namespace limn {

/// Bits as in LevelSetBlock.
struct NodeBlock {
  NodeBlock(const glm::ivec3& first, SurfacePart of) : origin(first), part(std::move(of)) {}
  glm::ivec3 origin{0};
  SurfacePart part;  ///< Asked for its nodes.
  std::array<std::uint64_t, 8> wanted{}, known{};
  std::array<float, 512> values;  ///< Of the known ones.
  bool measured = false;          ///< Of a mesh: the values of the others are those that they will have if they are wanted.
};

/// Blocks in the order in which they came; they stay where they are. In chunks of large pages: the first touch of small ones takes longer
/// than what is asked of the surface.
class NodeBlocks {
 public:
  NodeBlocks() = default;
  NodeBlocks(NodeBlocks&& other) noexcept : chunks_(std::move(other.chunks_)), size_(std::exchange(other.size_, 0)) {}
  NodeBlocks& operator=(NodeBlocks&& other) noexcept {
    std::swap(chunks_, other.chunks_), std::swap(size_, other.size_);
    return *this;
  }
  ~NodeBlocks() {
    for (size_t i = 0; i < size_; ++i) std::destroy_at(&(*this)[i]);
    for (size_t c = 0; c < chunks_.size(); ++c) LargePages::give_back(chunks_[c], bytes_of(c));
  }

  NodeBlock& add(const glm::ivec3& origin, const SurfacePart& part) {
    if (size_ == first_of(chunks_.size())) {
      chunks_.reserve(chunks_.size() + 1);
      chunks_.push_back(static_cast<NodeBlock*>(LargePages::take(bytes_of(chunks_.size()))));
    }
    NodeBlock& block = *std::construct_at(place_of(size_), origin, part);
    ++size_;
    return block;
  }
  size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  NodeBlock& operator[](size_t i) { return *place_of(i); }
  const NodeBlock& operator[](size_t i) const { return *place_of(i); }

 private:
  /// A small surface takes no large page.
  static constexpr size_t kChunkBytes = size_t{2} << 20, kFirst = 32, kOthers = kChunkBytes / sizeof(NodeBlock);
  static constexpr size_t bytes_of(size_t chunk) { return chunk == 0 ? kFirst * sizeof(NodeBlock) : kChunkBytes; }
  static constexpr size_t first_of(size_t chunk) { return chunk == 0 ? 0 : kFirst + (chunk - 1) * kOthers; }
  NodeBlock* place_of(size_t i) const { return i < kFirst ? chunks_[0] + i : chunks_[1 + (i - kFirst) / kOthers] + (i - kFirst) % kOthers; }

  std::vector<NodeBlock*> chunks_{};
  size_t size_ = 0;
};

}  // namespace limn
