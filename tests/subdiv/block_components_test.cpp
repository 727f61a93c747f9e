// Which nodes of a block hang together, against a plain search.

#include "subdiv/block_components.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "subdiv/filled_blocks.h"
#include "tests/random_seed.h"

namespace limn {
namespace {

constexpr double kVoxel = 0.7;

/// Each node's lowest fellow, by repeating all steps until nothing changes.
std::array<int, 512> lowest_fellows(const BlockDistanceArray& distances) {
  std::array<int, 512> lowest;
  for (int node = 0; node < 512; ++node) lowest[static_cast<size_t>(node)] = node;
  for (bool more = true; more;) {
    more = false;
    for (int node = 0; node < 512; ++node)
      for (const auto& [stride, place] : {std::pair(64, node >> 6), std::pair(8, node >> 3 & 7), std::pair(1, node & 7)}) {
        if (place == 7) continue;
        const auto a = static_cast<size_t>(node), b = static_cast<size_t>(node + stride);
        if (!(distances[a] + distances[b] > 1.000001 * kVoxel) || lowest[a] == lowest[b]) continue;
        lowest[a] = lowest[b] = std::min(lowest[a], lowest[b]);
        more = true;
      }
  }
  return lowest;
}

/// So that few, many, or nearly all steps are clear; far nodes as they are beyond a band.
BlockDistanceArray random_distances(std::mt19937& random) {
  const double most = kVoxel * std::uniform_real_distribution<double>(0.3, 1.5)(random);
  BlockDistanceArray distances;
  for (double& d : distances) {
    d = std::uniform_real_distribution<double>(0.0, most)(random);
    if (random() % 50 == 0) d = std::numeric_limits<double>::infinity();
  }
  return distances;
}

TEST(BlockComponents, AreThoseOfAPlainSearchInEitherOrder) {
  std::mt19937 random(random_seed());
  int most = 0;
  for (int round = 0; round < 60; ++round) {
    const BlockDistanceArray distances = random_distances(random);
    const std::array<int, 512> expected = lowest_fellows(distances);
    for (const bool from_first : {false, true}) {
      const BlockComponents found = components_of(distances, kVoxel, from_first);
      ASSERT_EQ(found.members.size(), 512u);
      for (size_t node = 0; node < 512; ++node)
        ASSERT_EQ(found.components[static_cast<size_t>(found.of[node])].first, expected[node]) << "node " << node;
      for (size_t i = 0; i + 1 < found.components.size(); ++i) ASSERT_GE(found.components[i].size(), found.components[i + 1].size());
      for (const BlockComponent& component : found.components) {
        const std::span<const int> members = found.members_of(component);
        ASSERT_EQ(members.front(), component.first);
        ASSERT_TRUE(from_first || std::is_sorted(members.begin(), members.end()));
      }
      most = std::max(most, static_cast<int>(found.components.size()));
    }
  }
  EXPECT_GT(most, 100);
}

TEST(FilledBlocks, TellOfTheBlocksBeforeOneAlongEachAxis) {
  FilledBlocks filled;
  const auto add = [&](const glm::ivec3& origin) {
    BlockFaces faces;
    for (int axis = 0; axis < 3; ++axis) faces[static_cast<size_t>(axis)].numbers[0] = 100 * origin.x + 10 * origin.y + origin.z + axis;
    filled.add(origin, faces);
  };
  for (const int x : {-8, 0, 8})
    for (const int y : {0, 8})
      for (const int z : {-8, 0}) add({x, y, z});
  const glm::ivec3 origin(8, 8, 0);
  for (int axis = 0; axis < 3; ++axis) {
    glm::ivec3 before = origin;
    before[axis] -= 8;
    const BlockFace* const face = filled.before(origin, axis);
    ASSERT_NE(face, nullptr);
    EXPECT_EQ(face->numbers[0], 100 * before.x + 10 * before.y + before.z + axis);
  }
  EXPECT_EQ(filled.before({8, 0, 0}, 1), nullptr);
  EXPECT_EQ(filled.before({8, 0, -8}, 2), nullptr);
  EXPECT_EQ(filled.before({24, 0, 0}, 0), nullptr);
}

}  // namespace
}  // namespace limn
