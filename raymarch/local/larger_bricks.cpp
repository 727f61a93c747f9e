#include "raymarch/local/larger_bricks.h"

#include <algorithm>
#include <limits>

#include "sdf/parallel.h"

namespace limn {
namespace {

/// The least and the most of each three numbers that stand `apart`.
template <size_t kCount>
struct Extremes {
  std::array<std::int16_t, kCount> least, most;

  void of_three(const std::int16_t* low, const std::int16_t* high, size_t apart) {
    for (size_t k = 0; k < kCount; ++k) {
      least[k] = std::min({low[k], low[k + apart], low[k + 2 * apart]});
      most[k] = std::max({high[k], high[k + apart], high[k + 2 * apart]});
    }
  }
};

/// Planes, rows and single nodes of each 3^3 one after the other: most of it becomes SIMD.
SurfaceBlocks surface_blocks(const NodeSteps& steps, float near_steps) {
  constexpr size_t kRow = kBrickNodes, kPlane = kRow * kRow;
  SurfaceBlocks blocks;
  Extremes<kPlane> planes;
  Extremes<kRow> rows;
  std::uint64_t bit = 1;
  for (size_t x = 0; x < 4; ++x) {
    planes.of_three(&steps[2 * x * kPlane], &steps[2 * x * kPlane], kPlane);
    for (size_t y = 0; y < 4; ++y) {
      rows.of_three(&planes.least[2 * y * kRow], &planes.most[2 * y * kRow], kRow);
      for (size_t z = 0; z < 4; ++z, bit <<= 1) {
        const std::int16_t least = std::min({rows.least[2 * z], rows.least[2 * z + 1], rows.least[2 * z + 2]}),
                           most = std::max({rows.most[2 * z], rows.most[2 * z + 1], rows.most[2 * z + 2]});
        if (static_cast<float>(least) < near_steps && static_cast<float>(most) > -near_steps)
          blocks.near |= bit;
        else if (most < 0)
          blocks.inside |= bit;
      }
    }
  }
  return blocks;
}

}  // namespace

Larger larger_of(const LevelNodes& nodes, int step, const std::vector<LocalBrick>& bricks, double h) {
  constexpr double kNear_voxels = 0.5;
  Larger larger{&nodes, step, {}, std::vector<std::uint64_t>(bricks.size()), std::vector<SurfaceBlocks>(bricks.size())};
  for (const LocalBrick& brick : bricks) larger.bricks.add(key_of(8 * brick.place));
  parallel_parts(bricks.size(), size_t{64}, [&](const IndexRange<size_t>& range) {
    NodeSteps steps;
    for (size_t i = range.begin(); i < range.end(); ++i) {
      load_brick(nodes, i, steps);
      larger.open[i] = ~bricks[i].covered;
      larger.blocks[i] = surface_blocks(steps, static_cast<float>(kNear_voxels * h) * nodes.steps_per_unit);
    }
  });
  return larger;
}

LargerBeside::LargerBeside(const Larger& larger, const glm::ivec3& origin) : larger_(larger), first_(origin >> larger.step) {
  for (unsigned k = 0; k < 8; ++k) {
    // Those of the block itself, and before it along the axes of k: a node on a face between two belongs to both.
    const glm::ivec3 place = (origin >> 3) - glm::ivec3(k & 1, k >> 1 & 1, k >> 2), part = place & ((1 << larger.step) - 1);
    const size_t number = larger.bricks.find(key_of(8 * (place >> larger.step)));
    if (number == KeyNumbers::kNone) continue;
    const std::uint64_t cells = covered_by(part, larger.step) & larger.open[number];
    const SurfaceBlocks& blocks = larger.blocks[number];
    if ((cells & blocks.near) != 0) near_ |= kTouchedFrom[k];
    if ((cells & blocks.inside) != 0) inside_ |= kTouchedFrom[k];
    if ((cells & ~blocks.near & ~blocks.inside) != 0) outside_ |= kTouchedFrom[k];
  }
}

std::uint64_t LargerBeside::near_nodes(size_t word) const {
  constexpr std::uint64_t kFirstRow = 0xff, kFirstColumn = 0x0101010101010101;
  const auto if_near = [&](unsigned before, std::uint64_t nodes) {
    return (near_ >> (before | (word == 0 ? 1u : 0u)) & 1) != 0 ? nodes : 0;
  };
  return if_near(0, ~kFirstRow & ~kFirstColumn) | if_near(2, kFirstRow & ~kFirstColumn) | if_near(4, kFirstColumn & ~kFirstRow) |
         if_near(6, kFirstRow & kFirstColumn);
}

void LargerBeside::load_values() {
  const NodeBlock* last = nullptr;
  const int count = (8 >> larger_.step) + 1;
  for (int x = 0; x < count; ++x)
    for (int y = 0; y < count; ++y)
      for (int z = 0; z < count; ++z) {
        const glm::ivec3 node = first_ + glm::ivec3(x, y, z);
        const NodeBlock* const block = larger_.nodes->find(block_of(node), last);
        const size_t n = place_in_block(node);
        // Nobody asks for what no brick has.
        values_[at(node)] = block && block->is_known(n) ? static_cast<double>(larger_.nodes->value_of(block->step(n))) : 0.0;
      }
  is_loaded_ = true;
}

double LargerBeside::interpolated(const glm::ivec3& node) {
  if (!is_loaded_) load_values();
  const int times = 1 << larger_.step;
  const glm::ivec3 part = node & (times - 1);
  const double scale = 1.0 / static_cast<double>(times * times * times);
  double sum = 0.0;
  for (int k = 0; k < 8; ++k) {
    const glm::ivec3 side(k & 1, k >> 1 & 1, k >> 2), weights = side * part + (1 - side) * (times - part);
    const int weight = weights.x * weights.y * weights.z;
    if (weight == 0) continue;
    // All are powers of two: exact.
    sum += scale * weight * values_[at((node >> larger_.step) + side)];
  }
  return sum;
}

}  // namespace limn
