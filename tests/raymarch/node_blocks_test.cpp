// Blocks of nodes that keep no more than is wanted, against a map.

#include "raymarch/local/node_blocks.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "sdf/shape.h"
#include "tests/random_seed.h"

namespace limn {
namespace {

/// A share of the nodes, a plane, a row each, all of them: as bricks and stencils want them.
std::array<std::uint64_t, 8> random_nodes(std::mt19937_64& random) {
  std::array<std::uint64_t, 8> bits{};
  switch (random() % 5) {
    case 0:
      bits[random() % 8] = ~std::uint64_t{0};
      break;
    case 1:
      bits.fill(std::uint64_t{0xff} << 8 * (random() % 8));
      break;
    case 2:
      bits.fill(std::uint64_t{0x0101010101010101} << random() % 8);
      break;
    case 3:
      bits.fill(~std::uint64_t{0});
      break;
    default:
      for (std::uint64_t& word : bits) word = random() & random();
  }
  return bits;
}

template <class Visit>
void for_each_node(const std::array<std::uint64_t, 8>& bits, const Visit& visit) {
  for (size_t n = 0; n < 512; ++n)
    if ((bits[n >> 6] >> (n & 63) & 1) != 0) visit(n);
}

TEST(NodeBlocks, KeepWhatIsSetWhenMoreIsWanted) {
  const std::uint64_t seed = random_seed();
  std::mt19937_64 random(seed);
  const SurfacePart part = make_shape("sphere");
  for (const bool whole : {false, true}) {
    NodeBlocks blocks;
    std::map<std::pair<size_t, size_t>, std::int16_t> set;
    for (int round = 0; round < 4; ++round) {
      for (int k = 0; k < 60; ++k) blocks.add(glm::ivec3(8 * static_cast<int>(blocks.size()), 0, 0), part);
      for (size_t i = 0; i < blocks.size(); ++i) {
        const std::array<std::uint64_t, 8> more = random_nodes(random);
        if (round == 0 || random() % 2 == 0)
          for (size_t word = 0; word < 8; ++word) blocks[i].wanted[word] |= more[word];
      }
      blocks.make_room(whole);
      for (size_t i = 0; i < blocks.size(); ++i) {
        NodeBlock& block = blocks[i];
        std::array<std::uint64_t, 8> pending = block.wanted;
        for (size_t word = 0; word < 8; ++word) pending[word] &= ~block.known[word];
        for_each_node(pending, [&](size_t n) {
          const auto step = static_cast<std::int16_t>(random());
          block.set(n, step);
          set[{i, n}] = step;
        });
        block.known = block.wanted;
        if (whole && block.wanted != std::array<std::uint64_t, 8>{}) {
          EXPECT_TRUE(block.whole);
        }
      }
      size_t known = 0;
      for (size_t i = 0; i < blocks.size(); ++i)
        for_each_node(blocks[i].known, [&](size_t n) {
          ++known;
          ASSERT_EQ(blocks[i].step(n), set.at({i, n})) << i << " " << n << " round " << round << " seed " << seed;
        });
      EXPECT_EQ(known, set.size());
    }
    // Rows of which all nodes have room are copied as they lie.
    for (size_t i = 0; i < blocks.size(); ++i)
      for (size_t row = 0; row < 512; row += 8) {
        if ((blocks[i].known[row >> 6] >> (row & 63) & 0xff) != 0xff) continue;
        for (size_t z = 0; z < 8; ++z) ASSERT_EQ(blocks[i].steps[blocks[i].slot(row) + z], set.at({i, row + z}));
      }
  }
}

}  // namespace
}  // namespace limn
