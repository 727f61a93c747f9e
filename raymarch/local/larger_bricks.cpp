#include "raymarch/local/larger_bricks.h"

#include <algorithm>
#include <limits>

#include "sdf/parallel.h"

namespace limn {
namespace {

SurfaceBlocks surface_blocks(const NodeValues& values, float near) {
  SurfaceBlocks blocks;
  for (int block = 0; block < 64; ++block) {
    const glm::ivec3 first(2 * (block >> 4), 2 * (block >> 2 & 3), 2 * (block & 3));
    float least = std::numeric_limits<float>::max(), most = -least;
    for (int k = 0; k < 27; ++k) {
      const float value = values[static_cast<size_t>(brick_element(first.x + k / 9, first.y + k / 3 % 3, first.z + k % 3))];
      least = std::min(least, value), most = std::max(most, value);
    }
    const std::uint64_t bit = std::uint64_t{1} << block;
    if (least < near && most > -near)
      blocks.near |= bit;
    else if (most < 0.0f)
      blocks.inside |= bit;
  }
  return blocks;
}

}  // namespace

Larger larger_of(const LevelNodes& nodes, int step, const std::vector<LocalBrick>& bricks, double h) {
  constexpr double kNear_voxels = 0.5;
  Larger larger{&nodes, step, {}, std::vector<std::uint64_t>(bricks.size()), std::vector<SurfaceBlocks>(bricks.size())};
  for (const LocalBrick& brick : bricks) larger.bricks.add(key_of(8 * brick.place));
  parallel_parts(bricks.size(), size_t{64}, [&](const IndexRange<size_t>& range) {
    NodeValues values;
    for (size_t i = range.begin(); i < range.end(); ++i) {
      load_brick(nodes, 8 * bricks[i].place, values);
      larger.open[i] = ~bricks[i].covered;
      larger.blocks[i] = surface_blocks(values, static_cast<float>(kNear_voxels * h));
    }
  });
  return larger;
}

LargerBeside::LargerBeside(const Larger& larger, const glm::ivec3& origin) : larger_(larger) {
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

double LargerBeside::interpolated(const glm::ivec3& node) {
  const int times = 1 << larger_.step;
  const glm::ivec3 part = node & (times - 1);
  const double scale = 1.0 / static_cast<double>(times * times * times);
  double sum = 0.0;
  for (int k = 0; k < 8; ++k) {
    const glm::ivec3 side(k & 1, k >> 1 & 1, k >> 2), weights = side * part + (1 - side) * (times - part);
    const int weight = weights.x * weights.y * weights.z;
    if (weight == 0) continue;
    const glm::ivec3 at = (node >> larger_.step) + side;
    // All are powers of two: exact.
    sum += scale * weight * static_cast<double>(larger_.nodes->find(block_of(at), last_)->values[place_in_block(at)]);
  }
  return sum;
}

}  // namespace limn
