// Jump flooding over the silhouette's crossings. A pixel holds the offset from its centre to the nearest crossing known so far. Passes go
// over blocks of pixels, and only over those that lie within reach and have a neighbour, at the pass's step, that knows a crossing.

#include <array>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>

#include "raymarch/border/jump_flood_blocks.h"
#include "raymarch/border/jump_flood_pass.h"
#include "raymarch/border/silhouette.h"
#include "raymarch/gbuffer/picture_rows.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr std::array<glm::ivec2, 8> kDirections{{{-1, 0}, {1, 0}, {-1, -1}, {0, -1}, {1, -1}, {-1, 1}, {0, 1}, {1, 1}}};

/// A picture of whole blocks with one more around it, so that reading beside an edge needs no test. In memory of somebody else.
class OffsetPicture {
 public:
  static std::ptrdiff_t stride(const BlockFlags& blocks) {
    const std::ptrdiff_t cache_lines = (blocks.columns + 2) * kBlockWidth_px / 16;
    return 16 * (cache_lines | 1);  // odd: lines above each other fall on different sets of the caches
  }
  static size_t count(const BlockFlags& blocks) {
    return static_cast<size_t>(stride(blocks)) * static_cast<size_t>((blocks.rows + 2) * kBlockHeight_px);
  }
  OffsetPicture(const BlockFlags& blocks, Offset* offsets)
      : stride_(stride(blocks)), first_(offsets + kBlockHeight_px * stride_ + kBlockWidth_px) {}
  Offset* at(int x, int y) { return first_ + y * stride_ + x; }
  Offset* block(int column, int row) { return at(column * kBlockWidth_px, row * kBlockHeight_px); }
  void forget_block(int column, int row) {
    for (int y = 0; y < kBlockHeight_px; ++y) std::fill_n(block(column, row) + y * stride_, kBlockWidth_px, kUnknownOffset);
  }

 private:
  std::ptrdiff_t stride_;
  Offset* first_;
};

/// The crossings about a pixel, in a fixed order: their offsets, and the pixels on their other sides.
struct Crossings {
  std::array<Offset, 4> offsets;
  std::array<glm::ivec2, 4> partners;
  int count = 0;
  int nearest = -1;
};

Crossings crossings_about(const Silhouette& silhouette, int x, int y) {
  Crossings found;
  const auto add = [&](int along, bool across, glm::ivec2 partner) {
    const auto k = static_cast<size_t>(found.count);
    found.offsets[k] = {static_cast<std::int16_t>(across ? along : 0), static_cast<std::int16_t>(across ? 0 : along)};
    found.partners[k] = partner;
    const auto length = [&](int i) {
      const Offset offset = found.offsets[static_cast<size_t>(i)];
      return std::abs(offset.x) + std::abs(offset.y);
    };
    if (found.nearest < 0 || length(found.count) < length(found.nearest)) found.nearest = found.count;
    ++found.count;
  };
  const auto& right = silhouette.to_right;
  const auto& down = silhouette.downwards;
  if (right.at(x, y) >= 0) add(right.at(x, y), true, {x + 1, y});
  if (x > 0 && right.at(x - 1, y) >= 0) add(right.at(x - 1, y) - kSubPixels, true, {x - 1, y});
  if (down.at(x, y) >= 0) add(down.at(x, y), false, {x, y + 1});
  if (y > 0 && down.at(x, y - 1) >= 0) add(down.at(x, y - 1) - kSubPixels, false, {x, y - 1});
  return found;
}

/// A pixel holds one crossing and has up to four. The outer pixels hold their nearest; the inner ones the nearest that its outer pixel
/// leaves out, so that few crossings are lost: the greater part of what jump flooding gets wrong otherwise.
Offset first_crossing(const Silhouette& silhouette, int x, int y) {
  const Crossings own = crossings_about(silhouette, x, y);
  if (own.count == 0) return kUnknownOffset;
  const Offset nearest = own.offsets[static_cast<size_t>(own.nearest)];
  if (!silhouette.inside.at(x, y)) return nearest;
  Offset best = nearest;
  int best_length = std::numeric_limits<int>::max();
  for (size_t k = 0; k < static_cast<size_t>(own.count); ++k) {
    const glm::ivec2 partner = own.partners[k], step = partner - glm::ivec2(x, y);
    const Crossings theirs = crossings_about(silhouette, partner.x, partner.y);
    const Offset held = theirs.offsets[static_cast<size_t>(theirs.nearest)];
    const bool taken = held.x + kSubPixels * step.x == own.offsets[k].x && held.y + kSubPixels * step.y == own.offsets[k].y;
    const int length = std::abs(own.offsets[k].x) + std::abs(own.offsets[k].y);
    if (taken || length >= best_length) continue;
    best = own.offsets[k];
    best_length = length;
  }
  return best;
}

/// Most of a line is far from any crossing; eight pixels at a time are passed over. Writes pixels [x0, x1) of `out`, a line, where there is
/// a crossing; returns whether there was one.
bool first_crossings(const Silhouette& silhouette, int x0, int x1, int y, Offset* out) {
  const int width = silhouette.inside.width;
  const std::int8_t* right = &silhouette.to_right.at(0, y);
  const std::int8_t* down = &silhouette.downwards.at(0, y);
  const std::int8_t* up = y > 0 ? down - width : down;
  const auto none = [](const std::int8_t* eight) {
    std::uint64_t bits;
    std::memcpy(&bits, eight, 8);
    return bits == ~std::uint64_t{0};  // kNoCrossing is -1
  };
  bool any = false;
  for (int x = x0; x < x1;) {
    if (x + 8 <= x1 && none(right + x) && none(down + x) && none(up + x) && (x == 0 || right[x - 1] == kNoCrossing)) {
      x += 8;
      continue;
    }
    out[x] = first_crossing(silhouette, x, y);
    any = any || known(out[x]);
    ++x;
  }
  return any;
}

struct Block {
  int column, row;
};

template <class Work>
void for_each_block(const std::vector<Block>& blocks, const Work& work) {
  constexpr size_t together = 16;
  parallel_parts(blocks.size(), together, [&](const IndexRange<size_t>& range) {
    for (size_t i = range.begin(); i < range.end(); ++i) work(blocks[i]);
  });
}

/// Every pixel's first offset, and unknown ones in all that will be read; returns the blocks in which some are known.
BlockFlags start(const Silhouette& silhouette, const BlockFlags& beside, const BlockFlags& active, OffsetPicture& from, OffsetPicture& to) {
  const int width = silhouette.inside.width, height = silhouette.inside.height;
  BlockFlags knowing(beside.columns, beside.rows);
  std::vector<Block> read;
  for (int row = -1; row <= active.rows; ++row) {
    for (int column = -1; column <= active.columns; ++column) {
      if (active.any(column - 1, row - 1, column + 1, row + 1)) read.push_back({column, row});
    }
  }
  for_each_block(read, [&](const Block& block) {
    from.forget_block(block.column, block.row);
    to.forget_block(block.column, block.row);
    if (!beside.any(block.column, block.row, block.column, block.row)) return;
    const int x0 = block.column * kBlockWidth_px, y0 = block.row * kBlockHeight_px;
    bool any = false;
    for (int y = y0; y < std::min(height, y0 + kBlockHeight_px); ++y) {
      any |= first_crossings(silhouette, x0, std::min(width, x0 + kBlockWidth_px), y, from.at(0, y));
    }
    knowing.flags[knowing.index(block.column, block.row)] = any;
  });
  return knowing;
}

/// Where the neighbours of a block's pixels lie, in blocks from it.
struct SourceBlocks {
  int column0, column1, row0, row1;
};

SourceBlocks source_blocks(const glm::ivec2& shift_px) {
  const auto floor_divide = [](int a, int b) { return a >= 0 ? a / b : -((-a + b - 1) / b); };
  return {floor_divide(shift_px.x, kBlockWidth_px), floor_divide(shift_px.x + kBlockWidth_px - 1, kBlockWidth_px),
          floor_divide(shift_px.y, kBlockHeight_px), floor_divide(shift_px.y + kBlockHeight_px - 1, kBlockHeight_px)};
}

/// One pass over the blocks, of which `knowing` says whether they know a crossing, before and after.
void pass(int step, const std::vector<Block>& blocks, FloodBlock flood, OffsetPicture& from, OffsetPicture& to, BlockFlags& knowing) {
  const BlockFlags before = knowing;
  std::array<SourceBlocks, 8> offsets;
  for (size_t k = 0; k < 8; ++k) offsets[k] = source_blocks(kDirections[k] * step);
  for_each_block(blocks, [&](const Block& block) {
    const int column = block.column, row = block.row;
    BlockSources sources;
    for (size_t k = 0; k < 8; ++k) {
      const SourceBlocks& at = offsets[k];
      if (!before.any(column + at.column0, row + at.row0, column + at.column1, row + at.row1)) continue;
      const auto i = static_cast<size_t>(sources.count++);
      const glm::ivec2 shift = kDirections[k] * step;
      sources.from[i] = from.at(column * kBlockWidth_px + shift.x, row * kBlockHeight_px + shift.y);
      sources.move[i] = {static_cast<std::int16_t>(shift.x * kSubPixels), static_cast<std::int16_t>(shift.y * kSubPixels)};
    }
    if (sources.count == 0 && !before.at(column, row)) return;  // unknown in both pictures, as it was at the start
    flood(from.block(column, row), sources, to.at(0, 1) - to.at(0, 0), to.block(column, row));
    knowing.flags[knowing.index(column, row)] = 1;
  });
}

std::vector<int> steps_for(int reach_px, int extra_passes) {
  int step = 1;
  while (2 * step - 1 < reach_px + 1) step *= 2;
  std::vector<int> steps;
  for (; step >= 1; step /= 2) steps.push_back(step);
  for (int extra = extra_passes; extra >= 1; --extra) steps.push_back(extra);
  return steps;
}

void write_squares(const std::vector<Block>& blocks, OffsetPicture& offsets, int reach_px, Image<std::int32_t>& squares) {
  const std::int32_t largest = reach_px * reach_px * kSubPixels * kSubPixels;
  for_each_block(blocks, [&](const Block& block) {
    const int x0 = block.column * kBlockWidth_px, y0 = block.row * kBlockHeight_px, count = std::min(kBlockWidth_px, squares.width - x0);
    for (int y = y0; y < std::min(squares.height, y0 + kBlockHeight_px); ++y) {
      const Offset* own = offsets.at(x0, y);
      std::int32_t* out = &squares.at(x0, y);
      for (int x = 0; x < count; ++x) {
        const std::int32_t distance = square(own[x]);
        out[x] = distance <= largest ? distance : kFarSquared;
      }
    }
  });
}

}  // namespace

Image<std::int32_t> jump_flood_squares(const Silhouette& silhouette, int reach_px, int extra_passes) {
  LIMN_CHECK(reach_px >= 0 && reach_px <= kLargestReach_px && extra_passes >= 0 && extra_passes <= 2);
  Image<std::int32_t> squares(silhouette.inside.width, silhouette.inside.height, kFarSquared);
  if (silhouette.crossings == 0) return squares;
  const BlockFlags beside = blocks_beside_crossings(silhouette);
  // A crossing lies up to a pixel from the pixels beside it.
  const BlockFlags active = within_reach(beside, reach_px + 1);
  std::vector<Block> blocks;
  for (int row = 0; row < active.rows; ++row) {
    for (int column = 0; column < active.columns; ++column) {
      if (active.at(column, row)) blocks.push_back({column, row});
    }
  }
  const size_t count = OffsetPicture::count(active);
  const std::unique_ptr<Offset[]> memory(new Offset[2 * count]);  // not initialised: all that is read is written first
  OffsetPicture from(active, memory.get()), to(active, memory.get() + count);
  BlockFlags knowing = start(silhouette, beside, active, from, to);
  const FloodBlock flood = flood_kernels().back().flood;
  for (const int step : steps_for(reach_px, extra_passes)) {
    pass(step, blocks, flood, from, to, knowing);
    std::swap(from, to);
  }
  write_squares(blocks, from, reach_px, squares);
  return squares;
}

}  // namespace limn
