#include "raymarch/level_set/brick_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <limits>

#include "raymarch/level_set/brick_layout.h"
#include "sdf/error.h"

namespace limn {
namespace {

size_t count_of(const RayBricks& bricks) { return bricks.neighbors.size(); }

/// Of the cells that are kept those with nodes on either side.
CrossedCells crossed_in(const RayBricks& bricks, size_t brick) {
  CrossedCells crossed;
  for (int cell = 0; cell < 512; ++cell) {
    if (!bricks.keeps(brick, cell)) continue;
    int inside = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const int x = (cell >> 6) + (corner >> 2), y = (cell >> 3 & 7) + (corner >> 1 & 1), z = (cell & 7) + (corner & 1);
      inside += bricks.value(brick, brick_element(x, y, z)) < 0 ? 1 : 0;
    }
    if (inside == 0 || inside == 8) continue;
    crossed.cells[cell >> 6][cell >> 3 & 7] = static_cast<std::uint8_t>(crossed.cells[cell >> 6][cell >> 3 & 7] | 1 << (cell & 7));
    crossed.any = true;
  }
  return crossed;
}

/// Rows of nine values along z that the brick's own cells and stencils read: of the others nothing is kept.
BrickRows rows_of(const RayBricks& bricks, size_t brick) { return rows_read(crossed_in(bricks, brick)); }

template <class Three>
std::string vector_text(const Three& v) {
  return fmt::format("[{} {} {}]", v[0], v[1], v[2]);
}

std::string line_of(const RayBricks& bricks, size_t brick) {
  const SurfaceBound& bound = bricks.groups.front().bounds[brick];
  const BrickRows rows = rows_of(bricks, brick);
  std::int16_t least = std::numeric_limits<std::int16_t>::max(), largest = std::numeric_limits<std::int16_t>::lowest();
  for (int k = 0; k < kBrickElements; ++k)
    if (rows.has(k / kBrickNodes)) least = std::min(least, bricks.value(brick, k)), largest = std::max(largest, bricks.value(brick, k));
  return fmt::format("brick {}: origin {}, values {} to {}, crossed {}, cells {} to {}, slab {}\n", brick, vector_text(bound.origin), least,
                     largest, crossed_cells_in(bricks, brick), vector_text(bound.lower), vector_text(bound.upper), bound.slab);
}

std::string header_of(const RayBricks& bricks) {
  size_t crossed = 0;
  for (size_t brick = 0; brick < count_of(bricks); ++brick) crossed += static_cast<size_t>(crossed_cells_in(bricks, brick));
  std::string text = fmt::format("bricks: {}, crossed cells {} from {} to {}, values {}\n", count_of(bricks), crossed,
                                 vector_text(bricks.lower), vector_text(bricks.upper), bricks.values.size());
  text += fmt::format("grid: voxel_size {}, origin {}, half_width_voxels {}, world_per_step {}\n", bricks.voxel_size,
                      vector_text(bricks.world_from_index.translation), bricks.half_width_voxels, bricks.world_per_step);
  text += fmt::format("bytes: {}, of these spline {}\n", bricks.bytes(), bricks.spline.bytes());
  // The first groups are the bricks themselves.
  for (size_t i = 1; i < bricks.groups.size(); ++i)
    text += fmt::format("groups of {} cells to a side: {}\n", 1 << bricks.groups[i].shift, bricks.groups[i].bounds.size());
  return text;
}

}  // namespace

int crossed_cells_in(const RayBricks& bricks, size_t brick) {
  int count = 0;
  for (const auto& column : crossed_in(bricks, brick).cells)
    for (const std::uint8_t bits : column) count += std::popcount(bits);
  return count;
}

std::string text_of(const RayBricks& bricks) {
  std::string text = header_of(bricks);
  for (size_t brick = 0; brick < count_of(bricks); ++brick) text += line_of(bricks, brick);
  return text;
}

std::string text_of_brick(const RayBricks& bricks, size_t brick) {
  const size_t count = count_of(bricks);
  if (brick >= count) {
    throw InputError({.file = {},
                      .field = "brick",
                      .value = std::to_string(brick),
                      .problem = "no such brick",
                      .expected = count == 0 ? "nothing: the surface crosses no cell" : fmt::format("0 to {}", count - 1)});
  }
  const BrickRows rows = rows_of(bricks, brick);
  std::string text = line_of(bricks, brick);
  for (int z = 0; z < kBrickNodes; ++z) {
    text += fmt::format("slice z {}\n", z);
    for (int y = 0; y < kBrickNodes; ++y) {
      for (int x = 0; x < kBrickNodes; ++x)
        text += rows.has(kBrickNodes * x + y) ? fmt::format("{:>7}", bricks.value(brick, brick_element(x, y, z))) : "      .";
      text += "\n";
    }
  }
  return text;
}

}  // namespace limn
