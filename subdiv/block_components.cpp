#include "subdiv/block_components.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <utility>

namespace limn {
namespace {

/// A bit for each node of a block: 8 y + z of the word of its x.
using Bits = std::array<std::uint64_t, 8>;

/// [axis]: bits of nodes that a clear step joins to the next one along it.
using Joined = std::array<Bits, 3>;

Joined joined_nodes(const BlockDistanceArray& distances, double voxel_size) {
  constexpr std::array<size_t, 3> kStrides{64, 8, 1};
  const double length = kClearStep * voxel_size;
  Joined joined{};
  for (size_t axis = 0; axis < 3; ++axis)
    for (size_t x = 0; x < (axis == 0 ? 7 : 8); ++x) {
      std::uint64_t bits = 0;
      const size_t rows = axis == 1 ? 7 : 8;
      for (size_t row = 0; row < rows; ++row) {
        const double* const here = distances.data() + 64 * x + 8 * row;
        const double* const next = here + kStrides[axis];
        unsigned clear = 0;
        const size_t nodes = axis == 2 ? 7 : 8;
        for (size_t z = 0; z < nodes; ++z) clear |= (here[z] + next[z] > length ? 1u : 0u) << z;
        bits |= std::uint64_t{clear} << (8 * row);
      }
      joined[axis][x] = bits;
    }
  return joined;
}

/// All that steps reach from `found`, into it.
void flood(const Joined& joined, Bits& found) {
  const Bits &across = joined[0], &rows = joined[1], &nodes = joined[2];
  const auto spread = [&](size_t x) {
    std::uint64_t bits = found[x];
    if (x > 0) bits |= found[x - 1] & across[x - 1];
    if (x < 7) bits |= found[x + 1] & across[x];
    bits |= (bits & rows[x]) << 8 | (bits >> 8 & rows[x]);
    bits |= (bits & nodes[x]) << 1 | (bits >> 1 & nodes[x]);
    const bool more = bits != found[x];
    found[x] = bits;
    return more;
  };
  for (bool more = true; more;) {
    more = false;
    for (size_t x = 0; x < 8; ++x) more = spread(x) || more;
    for (size_t x = 8; x-- > 0;) more = spread(x) || more;
  }
}

/// Members in their own order.
void gather_by_bits(const Joined& joined, BlockComponents& out) {
  Bits left;
  left.fill(~std::uint64_t{0});
  for (size_t word = 0; word < 8; ++word)
    while (left[word] != 0) {
      Bits found{};
      found[word] = left[word] & (~left[word] + 1);
      flood(joined, found);
      const auto begin = static_cast<int>(out.members.size());
      for (size_t x = word; x < 8; ++x) {
        left[x] &= ~found[x];
        for (std::uint64_t bits = found[x]; bits != 0; bits &= bits - 1)
          out.members.push_back(static_cast<int>(64 * x) + std::countr_zero(bits));
      }
      out.components.push_back(
          {.first = out.members[static_cast<size_t>(begin)], .begin = begin, .end = static_cast<int>(out.members.size())});
    }
}

void gather_by_steps(const Joined& joined, BlockComponents& out) {
  constexpr std::array<int, 3> kStrides{64, 8, 1};
  const auto is_set = [](const Bits& bits, int node) { return (bits[static_cast<size_t>(node) >> 6] >> (node & 63) & 1) != 0; };
  std::array<bool, 512> reached{};
  const auto take = [&](int node) {
    if (std::exchange(reached[static_cast<size_t>(node)], true)) return;
    out.members.push_back(node);
  };
  for (int first = 0; first < 512; ++first) {
    if (reached[static_cast<size_t>(first)]) continue;
    const auto begin = static_cast<int>(out.members.size());
    take(first);
    for (auto i = static_cast<size_t>(begin); i < out.members.size(); ++i) {
      const int from = out.members[i];
      for (size_t axis = 0; axis < 3; ++axis) {
        if (const int before = from - kStrides[axis]; before >= 0 && is_set(joined[axis], before)) take(before);
        if (is_set(joined[axis], from)) take(from + kStrides[axis]);
      }
    }
    out.components.push_back({.first = first, .begin = begin, .end = static_cast<int>(out.members.size())});
  }
}

}  // namespace

BlockComponents components_of(const BlockDistanceArray& distances, double voxel_size, bool from_first) {
  BlockComponents result;
  result.members.reserve(512);
  const Joined joined = joined_nodes(distances, voxel_size);
  if (from_first)
    gather_by_steps(joined, result);
  else
    gather_by_bits(joined, result);
  std::stable_sort(result.components.begin(), result.components.end(),
                   [](const BlockComponent& a, const BlockComponent& b) { return a.size() > b.size(); });
  for (size_t i = 0; i < result.components.size(); ++i)
    for (const int node : result.members_of(result.components[i])) result.of[static_cast<size_t>(node)] = static_cast<int>(i);
  return result;
}

}  // namespace limn
