#pragma once
// Internal: the values of a local level set at the nodes of its bricks.

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "raymarch/level_set/brick_layout.h"
#include "raymarch/local/local_choice.h"
#include "raymarch/local/node_blocks.h"
#include "sdf/key_numbers.h"
#include "sdf/level_set_metadata.h"

namespace limn {

inline glm::ivec3 block_of(const glm::ivec3& node) { return node & ~7; }
inline size_t place_in_block(const glm::ivec3& node) { return static_cast<size_t>((node.x & 7) << 6 | (node.y & 7) << 3 | (node.z & 7)); }

struct LevelNodes {
  NodeBlocks blocks{};
  KeyNumbers at{};              ///< By key_of.
  float steps_per_unit = 0.0f;  ///< Values are whole numbers of steps, none of them 0.
  /// For each brick of the level the numbers of the blocks that hold its nodes: its own, and at [k] the one behind it along the axes of k.
  std::vector<std::array<std::uint32_t, 8>> of_brick{};
  std::vector<CrossedCells> crossed{};  ///< For each brick its cells that the surface crosses and no smaller brick holds.

  float value_of(std::int16_t steps) const { return static_cast<float>(steps) / steps_per_unit; }
  /// Of a node that is known.
  float value(const glm::ivec3& node) const;
  /// Null where there is none. `last`: the block found before, or null; becomes the one that is found.
  const NodeBlock* find(const glm::ivec3& origin, const NodeBlock*& last) const;
  std::int64_t known() const;
  NodeReader reader() const;  ///< Valid as long as the nodes are. Nodes that are not known are far outside.
};

/// Of a brick of the level, whose nodes are known.
void load_brick(const LevelNodes& nodes, size_t brick, NodeSteps& steps);

/// Samples the surface at the nodes of the chosen bricks and at those that the gradient's stencils read beside them, and nowhere else; from
/// the largest voxels to the smallest. A node that lies on open cells of a larger brick takes that brick's interpolant, where its surface
/// is near, and else its sign: on the face between two sizes both sides have the same surface, without a crack.
/// `take` is called for each level as soon as no smaller one asks for its nodes.
void sample_bricks(const LocalChoice& choice, const GradientDescriptor& gradient, double half_width_voxels,
                   const std::function<void(size_t level, LevelNodes nodes)>& take);
/// The same, all at once.
std::vector<LevelNodes> sample_bricks(const LocalChoice& choice, const GradientDescriptor& gradient, double half_width_voxels);

/// What the grid of a file has besides.
struct FiledLevel {
  std::function<bool(const glm::dvec3&)> inside{};  ///< Whether a place of the bricks' parts (see SurfacePart) lies inside.
  GridMetadata said{};                              ///< Goes into the file.
  glm::dvec3 part_origin{0.0};                      ///< Where that space's origin stands in the world.
};

/// The level's nodes as an ordinary level set. Where it is filed what is not known has its sign from the surface, else from its neighbours.
LevelSet level_set_of(const LevelNodes& nodes, const LocalChoice& choice, size_t level, double half_width_voxels, const std::string& name,
                      const FiledLevel* filed = nullptr);

}  // namespace limn
