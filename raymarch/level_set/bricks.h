#pragma once
// Internal: the ray-ready form of a level set. Of the blocks of 8^3 cells that the surface crosses, those of their 9^3 node values are
// kept, in 16 bits, that cells which it crosses and the stencils of their gradients read, and what bounds the surface in each.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "raymarch/level_set/spline_bricks.h"
#include "sdf/geometry.h"
#include "sdf/large_pages.h"
#include "sdf/level_set.h"

namespace limn {

inline constexpr int kBrickCells = 8;
inline constexpr int kBrickNodes = 9;
inline constexpr int kBrickElements = kBrickNodes * kBrickNodes * kBrickNodes;
/// Elements behind the last one that loads may bring along.
inline constexpr int kReadBeyond = 16;
/// The element of node (x, y, z) of a brick, each in 0..8.
inline constexpr int brick_element(int x, int y, int z) { return (x * kBrickNodes + y) * kBrickNodes + z; }

/// Smaller bricks hold a brick's cells by blocks of 2^3. The bit of the block that holds the cell (x, y, z), each in 0..7.
inline constexpr int covered_bit(int x, int y, int z) { return (x >> 1) << 4 | (y >> 1) << 2 | z >> 1; }

/// What bounds the surface in a cube of cells: a brick, or a group of bricks. Places are index coordinates, local ones from `origin`;
/// values are the bricks' 16-bit steps. Within the cells that the surface crosses the interpolant f satisfies
/// |f(p) - (normal.p - offset)| <= slab at every local p: f and the plane's function are both trilinear in a cell, so their difference is
/// largest at a node. A ray meets the surface nowhere else than where |normal.p - offset| <= slab, and that in lower <= p <= upper.
struct SurfaceBound {
  std::int32_t origin[3] = {};  ///< First cell, multiples of the cube's side.
  std::uint8_t lower[3] = {};   ///< Around the crossed cells, local: 0..31.
  std::uint8_t upper[3] = {};   ///< 1..32.
  std::uint16_t unused = 0;
  float normal[3] = {};
  float offset = 0.0f;
  float slab = 0.0f;
  /// In the crossed cells each component of the interpolant's gradient lies within `spread` of `normal`'s.
  float spread[3] = {};
};

/// The crossed bricks, seen from farther away: in cubes of 2^shift cells to a side. A picture takes the cubes that are as large as a packet
/// of its rays, so that what it costs to find them does not grow with the resolution.
struct BrickGroups {
  int shift = 3;
  std::vector<SurfaceBound> bounds{};
  /// For each group the bricks in it, in the order of their x, y, z; -1 where the surface does not cross. Empty for shift 3, whose groups
  /// are the bricks themselves.
  std::vector<std::int32_t> bricks{};
};

/// Where nodes beyond a brick's faces are, by face: -x, +x, -y, +y, -z, +z. Bytes from the first node of a cell at that face to the node
/// before it, or to the one behind its last. Zero where no stencil of a crossed cell reaches over the face.
struct BrickNeighbors {
  std::int32_t face[6] = {};
};

struct RayBricks {
  std::vector<BrickGroups> groups{};        ///< Of shift 3, 4 and 5; none where the surface crosses no cell.
  std::vector<BrickNeighbors> neighbors{};  ///< As many.
  /// Rows of nine nodes along z that rays read, of all bricks and of layers that only stencils read, in each other's gaps; then
  /// kReadBeyond.
  std::vector<std::int16_t, LargePageAllocator<std::int16_t>> values{};
  /// For each crossed brick where its first node's value lies or would lie, in bytes. The others lie from there on as brick_element() has
  /// them.
  std::vector<std::int32_t> first{};
  /// For each crossed brick the cells that rays look into: whose values are all kept, and that no smaller brick holds. Among them are those
  /// that the surface crosses and those beside them, in which a ray may find it by rounding. Eight words, bits as cells are numbered in
  /// BrickHits.
  std::vector<std::uint64_t> kept{};
  SplineBricks spline{};          ///< Of the crossed bricks; empty where nobody asked for it.
  glm::ivec3 lower{0}, upper{0};  ///< Around the crossed cells, index coordinates.
  double world_per_step = 0.0;    ///< What one step of a value stands for.
  // What the bricks were made of, for their dump (brick_text.h): rays do not read it.
  Affine world_from_index{};  ///< The level set's.
  double voxel_size = 0.0, half_width_voxels = 0.0;
  double prepare_ms = 0.0;

  std::int64_t bytes() const;
  bool keeps(size_t brick, int cell) const { return (kept[8 * brick + static_cast<size_t>(cell >> 6)] >> (cell & 63) & 1) != 0; }
  /// Of a node of a kept cell.
  std::int16_t value(size_t brick, int element) const {
    return values[static_cast<size_t>(first[brick]) / 2 + static_cast<size_t>(element)];
  }
};

/// The steps that stand for a value. No node lies on the surface itself: half a step to its side keeps its sign. In float until the end, so
/// that loops over it become SIMD.
inline std::int16_t quantised(float value, float steps_per_unit) {
  constexpr float kLargest = 32767.0f;
  const float steps = std::max(std::min(std::abs(value * steps_per_unit), kLargest) + 0.5f, 1.0f);
  return static_cast<std::int16_t>(static_cast<std::int32_t>(value < 0.0f ? -steps : steps));
}

/// Made from the grid in parallel. Null where the form would not do: more bricks than 32-bit offsets reach, or values whose range over the
/// crossed cells differs so much from place to place that 16 bits would not tell them apart (a grid far from a distance field).
/// Signs are kept: a node is inside (< 0) in the bricks exactly where it is inside in the grid.
std::shared_ptr<const RayBricks> make_bricks(const LevelSet& level_set, bool with_spline = false);

}  // namespace limn
