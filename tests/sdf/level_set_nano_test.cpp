// NanoVDB grids made straight from blocks, beside OpenVDB's own way to them.

#include "sdf/level_set_nano.h"

#include <gtest/gtest.h>
#include <nanovdb/util/OpenToNanoVDB.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/SignedFloodFill.h>

#include <atomic>
#include <random>
#include <set>
#include <tuple>

#include "sdf/read_vdb.h"
#include "tests/random_seed.h"

namespace limn::test {
namespace {

openvdb::FloatGrid::Ptr flood_filled(std::span<const LevelSetBlock> blocks, float background) {
  openvdb::initialize();
  const auto grid = openvdb::FloatGrid::create(background);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  for (const LevelSetBlock& block : blocks) {
    if (!has_active_node(block)) continue;
    auto* leaf = new openvdb::FloatTree::LeafNodeType(openvdb::Coord(block.origin.x, block.origin.y, block.origin.z));
    std::copy(std::begin(block.values), std::end(block.values), leaf->buffer().data());
    openvdb::FloatTree::LeafNodeType::NodeMaskType mask;
    for (openvdb::Index word = 0; word < 8; ++word) mask.getWord<openvdb::Index64>(word) = block.active[word];
    leaf->setValueMask(mask);
    grid->tree().addLeaf(leaf);
  }
  openvdb::tools::signedFloodFill(grid->tree());
  return grid;
}

nanovdb::GridHandle<nanovdb::HostBuffer> by_openvdb(std::span<const LevelSetBlock> blocks, float background) {
  return nanovdb::openToNanoVDB<nanovdb::HostBuffer, openvdb::FloatTree>(*flood_filled(blocks, background), nanovdb::StatsMode::BBox,
                                                                         nanovdb::ChecksumMode::Disable, 0);
}

/// What a file of this tree says: leaves with the signs of all their nodes, and the tiles inside.
struct Filed {
  std::vector<LevelSetBlock> blocks{};
  std::vector<VdbTile> tiles{};
};
Filed filed(const openvdb::FloatGrid& grid) {
  Filed result;
  for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
    LevelSetBlock& block = result.blocks.emplace_back();
    block.origin = {leaf->origin().x(), leaf->origin().y(), leaf->origin().z()};
    for (openvdb::Index word = 0; word < 8; ++word) block.active[word] = leaf->valueMask().getWord<openvdb::Index64>(word);
    for (openvdb::Index n = 0; n < 512; ++n) block.values[n] = leaf->getValue(n);
  }
  auto tile = grid.tree().cbeginValueOff();
  tile.setMaxDepth(openvdb::FloatTree::ValueOffCIter::LEAF_DEPTH - 1);
  for (; tile; ++tile)
    if (*tile < 0.0f)
      result.tiles.push_back({{tile.getCoord().x(), tile.getCoord().y(), tile.getCoord().z()}, static_cast<std::int32_t>(tile.getLevel())});
  return result;
}

template <class Node>
void expect_same_internal(const Node& a, const Node& b) {
  const auto &one = *a.data(), &other = *b.data();
  ASSERT_EQ(one.mBBox, other.mBBox);
  ASSERT_TRUE(one.mChildMask == other.mChildMask && one.mValueMask == other.mValueMask);
  for (std::uint32_t n = 0; n < Node::SIZE; ++n) {
    if (one.mChildMask.isOn(n)) {
      ASSERT_EQ(one.getChild(n)->origin(), other.getChild(n)->origin());
    } else {
      ASSERT_EQ(one.getValue(n), other.getValue(n)) << n;
    }
  }
}

void expect_same(const nanovdb::FloatGrid& a, const nanovdb::FloatGrid& b) {
  ASSERT_TRUE(a.isValid() && b.isValid());
  const auto &one = a.tree(), &other = b.tree();
  for (int level = 0; level < 3; ++level) ASSERT_EQ(one.nodeCount(level), other.nodeCount(level)) << level;
  EXPECT_EQ(one.activeVoxelCount(), other.activeVoxelCount());
  EXPECT_EQ(one.bbox(), other.bbox());
  EXPECT_EQ(one.background(), other.background());
  EXPECT_EQ(a.gridClass(), b.gridClass());
  EXPECT_EQ(a.indexBBox(), b.indexBBox());
  EXPECT_EQ(a.worldBBox(), b.worldBBox());
  ASSERT_EQ(one.root().tileCount(), other.root().tileCount());
  for (std::uint32_t i = 0; i < one.root().tileCount(); ++i) {
    const auto &tile = *one.root().data()->tile(i), &peer = *other.root().data()->tile(i);
    ASSERT_EQ(tile.key, peer.key);
    ASSERT_EQ(tile.isChild(), peer.isChild());
    if (tile.isValue()) {
      ASSERT_EQ(tile.value, peer.value);
    }
  }
  for (std::uint32_t i = 0; i < one.nodeCount(2); ++i) expect_same_internal(one.getFirstNode<2>()[i], other.getFirstNode<2>()[i]);
  for (std::uint32_t i = 0; i < one.nodeCount(1); ++i) expect_same_internal(one.getFirstNode<1>()[i], other.getFirstNode<1>()[i]);
  for (std::uint32_t i = 0; i < one.nodeCount(0); ++i) {
    const auto &leaf = *one.getFirstNode<0>()[i].data(), &peer = *other.getFirstNode<0>()[i].data();
    ASSERT_EQ(leaf.mBBoxMin, peer.mBBoxMin);
    ASSERT_TRUE(std::equal(leaf.mBBoxDif, leaf.mBBoxDif + 3, peer.mBBoxDif) && leaf.mFlags == peer.mFlags);
    ASSERT_TRUE(leaf.mValueMask == peer.mValueMask);
    ASSERT_TRUE(std::equal(std::begin(leaf.mValues), std::end(leaf.mValues), std::begin(peer.mValues)));
  }
}

/// Blocks anywhere, with any nodes active, of values of any sign: no distances of anything, which is harder than a level set.
std::vector<LevelSetBlock> random_blocks(std::mt19937& random, int count, int reach) {
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  std::vector<LevelSetBlock> blocks(static_cast<size_t>(count));
  for (LevelSetBlock& block : blocks) {
    for (int axis = 0; axis < 3; ++axis) block.origin[axis] = 8 * (below(2 * reach) - reach);
    // Rows of nodes beyond each other along z now and then.
    if (below(3) == 0) block.origin.x = block.origin.y = 0;
    const int kind = below(4);
    for (std::uint64_t& word : block.active)
      word = kind == 0 ? 0 : (std::uint64_t{random()} << 32 | random()) & (kind == 1 ? 0x10010ull : ~0ull);
    const bool inside = below(2) == 0;
    for (float& value : block.values) value = (static_cast<float>(below(2000)) / 1000.0f - (inside ? 1.9f : 0.1f));
  }
  return blocks;
}

TEST(NanoGrid, IsTheOneThatOpenVdbMakesOfTheSameBlocks) {
  std::mt19937 random(random_seed());
  for (const int reach : {2, 40, 700, 4000})
    for (const int count : {1, 7, 300}) {
      const std::vector<LevelSetBlock> blocks = random_blocks(random, count, reach);
      if (std::none_of(blocks.begin(), blocks.end(), has_active_node)) continue;
      SCOPED_TRACE(testing::Message() << count << " blocks within " << reach);
      const auto own = nano_grid(blocks, 2.5f), peer = by_openvdb(blocks, 2.5f);
      ASSERT_NO_FATAL_FAILURE(expect_same(*own.grid<float>(), *peer.grid<float>()));
    }
}

TEST(NanoGrid, OfLeavesMadeWhenTheyAreWrittenHasTheSameBytes) {
  std::mt19937 random(random_seed());
  for (const int reach : {2, 40, 4000}) {
    std::vector<LevelSetBlock> blocks;
    std::set<std::tuple<int, int, int>> taken;
    for (const LevelSetBlock& block : random_blocks(random, 300, reach)) {
      if (has_active_node(block) && taken.insert({block.origin.x, block.origin.y, block.origin.z}).second) blocks.push_back(block);
    }
    ASSERT_GT(blocks.size(), 10u);
    std::vector<glm::ivec3> origins;
    for (const LevelSetBlock& block : blocks) origins.push_back(block.origin);
    std::atomic<size_t> asked{0};
    const FillLeaves fill = [&](const IndexRange<size_t>& part, const WriteLeaf& write) {
      for (size_t i = part.first; i < part.last; ++i) {
        write(i, blocks[i]);
        ++asked;
      }
    };
    const auto own = nano_grid(origins, fill, 2.5f), peer = nano_grid(blocks, 2.5f);
    EXPECT_EQ(asked, blocks.size());
    ASSERT_EQ(own.size(), peer.size());
    EXPECT_TRUE(std::equal(own.data(), own.data() + own.size(), peer.data())) << reach;
  }
}

TEST(NanoGrid, FillsRootTilesBetweenInsideNodes) {
  // Two blocks far apart along z that look at each other from inside: what lies between, 4096 nodes to a side, is inside.
  std::vector<LevelSetBlock> blocks(2);
  blocks[1].origin = {0, 0, 5 * 4096};
  for (LevelSetBlock& block : blocks) {
    std::fill(std::begin(block.active), std::end(block.active), ~std::uint64_t{0});
    std::fill(std::begin(block.values), std::end(block.values), -0.5f);
  }
  const auto own = nano_grid(blocks, 2.0f), peer = by_openvdb(blocks, 2.0f);
  ASSERT_NO_FATAL_FAILURE(expect_same(*own.grid<float>(), *peer.grid<float>()));
  EXPECT_EQ(own.grid<float>()->tree().root().tileCount(), 6u);
  EXPECT_EQ(own.grid<float>()->tree().getValue({1, 2, 3 * 4096}), -2.0f);
}

TEST(NanoGrid, OfAFileIsTheOneThatOpenVdbMakesWhereSignsAreThoseOfAFloodFill) {
  std::mt19937 random(random_seed());
  for (const int reach : {2, 40, 700, 4000}) {
    const openvdb::FloatGrid::Ptr tree = flood_filled(random_blocks(random, 300, reach), 2.5f);
    const Filed file = filed(*tree);
    const auto own = nano_grid_as_filed(file.blocks, file.tiles, 2.5f);
    ASSERT_TRUE(own) << reach;
    const auto peer =
        nanovdb::openToNanoVDB<nanovdb::HostBuffer, openvdb::FloatTree>(*tree, nanovdb::StatsMode::BBox, nanovdb::ChecksumMode::Disable, 0);
    ASSERT_NO_FATAL_FAILURE(expect_same(*own->grid<float>(), *peer.grid<float>())) << reach;
  }
}

TEST(NanoGrid, OfAFileIsNoneWhereASignOrATileIsAnother) {
  std::mt19937 random(random_seed());
  const auto below = [&](size_t n) { return random() % n; };
  int flipped = 0;
  for (const int reach : {2, 40, 700, 4000}) {
    const Filed right = filed(*flood_filled(random_blocks(random, 300, reach), 2.5f));
    ASSERT_FALSE(right.tiles.empty()) << reach;
    for (int i = 0; i < 20; ++i) {
      Filed wrong = right;
      LevelSetBlock& block = wrong.blocks[below(wrong.blocks.size())];
      const size_t n = below(512);
      if ((block.active[n / 64] >> (n % 64) & 1u) != 0) continue;
      ++flipped;
      block.values[n] = -block.values[n];
      EXPECT_FALSE(nano_grid_as_filed(wrong.blocks, wrong.tiles, 2.5f)) << reach << ": a sign";
    }
    for (int i = 0; i < 20; ++i) {
      Filed wrong = right;
      const size_t k = below(wrong.tiles.size());
      if (i % 2 == 0)
        wrong.tiles.erase(wrong.tiles.begin() + static_cast<std::ptrdiff_t>(k));
      else
        wrong.tiles[k].origin.x += wrong.tiles[k].level == 1 ? 1 << 20 : 1 << 25;
      EXPECT_FALSE(nano_grid_as_filed(wrong.blocks, wrong.tiles, 2.5f)) << reach << ": a tile";
    }
    Filed empty = right;
    std::fill(std::begin(empty.blocks[0].active), std::end(empty.blocks[0].active), std::uint64_t{0});
    EXPECT_FALSE(nano_grid_as_filed(empty.blocks, empty.tiles, 2.5f)) << reach << ": a leaf without active nodes";
  }
  EXPECT_GT(flipped, 20);
  EXPECT_FALSE(nano_grid_as_filed({}, {}, 2.5f));
}

}  // namespace
}  // namespace limn::test
