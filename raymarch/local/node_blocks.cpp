#include "raymarch/local/node_blocks.h"

#include <algorithm>
#include <numeric>

namespace limn {
namespace {

size_t count_of(const std::array<std::uint64_t, 8>& bits) {
  return std::accumulate(bits.begin(), bits.end(), size_t{0},
                         [](size_t sum, std::uint64_t word) { return sum + static_cast<size_t>(std::popcount(word)); });
}

/// A block with more nodes than these has room for all: their places need not be counted out.
constexpr size_t kMostCounted = 320;

}  // namespace

std::int16_t* NodeBlocks::room_for(size_t nodes) {
  constexpr size_t kFirstRoom = 512 * kFirst, kOtherRooms = (size_t{4} << 20) / sizeof(std::int16_t);
  if (rooms_.empty() || taken_ + nodes > rooms_.back().size()) {
    rooms_.emplace_back(rooms_.empty() ? kFirstRoom : kOtherRooms);
    taken_ = 0;
  }
  std::int16_t* const room = rooms_.back().data() + taken_;
  taken_ += nodes;
  return room;
}

void NodeBlocks::make_room(bool whole) {
  for (size_t i = 0; i < size(); ++i) {
    NodeBlock& block = (*this)[i];
    if (block.whole || block.wanted == block.known) continue;
    const std::int16_t* const from = block.steps;
    const size_t count = count_of(block.wanted);
    block.whole = whole || count > kMostCounted;
    block.steps = room_for(block.whole ? 512 : count);
    size_t sum = 0;
    for (size_t word = 0; word < 8; ++word) {
      block.before[word] = static_cast<std::uint16_t>(sum);
      sum += static_cast<size_t>(std::popcount(block.wanted[word]));
    }
    // What is known moves along; it lay in its own order.
    size_t at = 0;
    for (size_t word = 0; word < 8; ++word)
      for (std::uint64_t bits = block.known[word]; bits != 0; bits &= bits - 1)
        block.set(word << 6 | static_cast<size_t>(std::countr_zero(bits)), from[at++]);
  }
}

}  // namespace limn
