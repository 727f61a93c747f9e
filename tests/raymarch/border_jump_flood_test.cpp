// Jump flooding's passes: every kernel writes the same bytes, and what is left out of a pass could not have been reached.

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <tbb/task_arena.h>

#include <cstring>

#include "raymarch/border/jump_flood_blocks.h"
#include "raymarch/border/jump_flood_pass.h"
#include "tests/raymarch/image_buffers.h"

namespace limn {
namespace {

constexpr std::ptrdiff_t kStride = 3 * kBlockWidth_px;

/// Three by three blocks of offsets: small ones, with many ties, or anything that 16 bits hold, or the edges of their range.
std::vector<Offset> random_offsets(std::mt19937& random, int kind) {
  std::vector<Offset> offsets(static_cast<size_t>(kStride) * 3 * kBlockHeight_px);
  // Moves add up to 8192; a square of -32768 twice is the one that 32 bits do not hold, and no offset in use comes near it.
  constexpr int kLowest = 8192 - 32767;
  std::uniform_int_distribution<int> number(kind == 0 ? -3 : kLowest, kind == 0 ? 3 : 32767), edge(0, 3);
  const auto value = [&] {
    static constexpr std::array<int, 4> edges{kLowest, kLowest + 1, 32766, 32767};
    return static_cast<std::int16_t>(kind == 2 ? edges[static_cast<size_t>(edge(random))] : number(random));
  };
  for (Offset& offset : offsets) {
    offset = {value(), value()};
    if (edge(random) == 0) offset = kUnknownOffset;
  }
  return offsets;
}

/// The definition, pixel by pixel, in 64 bits.
Offset nearest_of(const Offset* own, const BlockSources& sources, std::ptrdiff_t i) {
  const auto square_of = [](std::int64_t x, std::int64_t y) { return x * x + y * y; };
  Offset best = own[i];
  for (size_t k = 0; k < static_cast<size_t>(sources.count); ++k) {
    const auto moved = [](int a, int b) { return std::clamp(a + b, -32768, 32767); };
    const int x = moved(sources.from[k][i].x, sources.move[k].x), y = moved(sources.from[k][i].y, sources.move[k].y);
    if (square_of(x, y) < square_of(best.x, best.y)) best = {static_cast<std::int16_t>(x), static_cast<std::int16_t>(y)};
  }
  return best;
}

RC_GTEST_PROP(JumpFlood, EveryKernelWritesTheSameBytesAsTheDefinition, ()) {
  const auto seed = *rc::gen::arbitrary<unsigned>();
  const int kind = *rc::gen::inRange(0, 3), count = *rc::gen::inRange(0, 9), step = *rc::gen::inRange(1, kBlockHeight_px + 1);
  RC_LOG() << "seed " << seed << "\n";
  std::mt19937 random(seed);
  const std::vector<Offset> offsets = random_offsets(random, kind);
  const Offset* own = offsets.data() + kBlockHeight_px * kStride + kBlockWidth_px;
  BlockSources sources;
  sources.count = count;
  std::uniform_int_distribution<int> sign(-1, 1);
  for (size_t k = 0; k < static_cast<size_t>(count); ++k) {
    const glm::ivec2 shift(sign(random) * step, sign(random) * step);
    sources.from[k] = own + shift.y * kStride + shift.x;
    // The longest move that a reach allows.
    const int length = kind == 0 ? 1 : 256 * kSubPixels;
    sources.move[k] = {static_cast<std::int16_t>(sign(random) * length), static_cast<std::int16_t>(sign(random) * length)};
  }
  const std::vector<FloodKernel> kernels = flood_kernels();
  RC_ASSERT(kernels.front().name == "scalar");
  for (const FloodKernel& kernel : kernels) {
    std::vector<Offset> out(static_cast<size_t>(kStride) * kBlockHeight_px, Offset{7, 7});
    kernel.flood(own, sources, kStride, out.data());
    for (std::ptrdiff_t y = 0; y < kBlockHeight_px; ++y) {
      for (std::ptrdiff_t x = 0; x < kStride; ++x) {
        const Offset expected = x < kBlockWidth_px ? nearest_of(own, sources, y * kStride + x) : Offset{7, 7};
        const Offset written = out[static_cast<size_t>(y * kStride + x)];
        if (written.x != expected.x || written.y != expected.y) RC_FAIL(kernel.name + " differs");
      }
    }
  }
}

/// Discs and single pixels in an otherwise empty picture of many blocks.
Silhouette sparse_silhouette(std::mt19937& random, int width, int height) {
  const Camera camera = test::straight_camera(width, height, Projection::orthographic, 10.0);
  std::uniform_real_distribution<double> place(-0.1, 1.1), size(0.3, 12.0);
  std::vector<glm::dvec3> discs(std::uniform_int_distribution<size_t>(1, 4)(random));
  for (glm::dvec3& disc : discs) disc = {place(random) * width, place(random) * height, size(random)};
  const GBuffer seen = test::mask_buffer(camera, [&](int x, int y) {
    return std::any_of(discs.begin(), discs.end(), [&](const glm::dvec3& disc) { return std::hypot(x - disc.x, y - disc.y) < disc.z; });
  });
  return find_silhouette(seen, false);
}

/// By brute force: a block is left out only if none of its pixels is in reach of one beside a crossing.
RC_GTEST_PROP(JumpFlood, NoBlockWithinReachIsLeftOut, ()) {
  const auto seed = *rc::gen::arbitrary<unsigned>();
  RC_LOG() << "seed " << seed << "\n";
  std::mt19937 random(seed);
  const int width = *rc::gen::inRange(1, 400), height = *rc::gen::inRange(1, 120), reach = *rc::gen::inRange(0, 150);
  const Silhouette silhouette = sparse_silhouette(random, width, height);
  const Image<std::int32_t> exact = exact_squares(silhouette, reach);
  const BlockFlags beside = blocks_beside_crossings(silhouette), active = within_reach(beside, reach + 1);
  bool all = true;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const int column = x / kBlockWidth_px, row = y / kBlockHeight_px;
      if (exact.at(x, y) != kFarSquared) RC_ASSERT(active.at(column, row));
      const bool has = silhouette.to_right.at(x, y) >= 0 || silhouette.downwards.at(x, y) >= 0 ||
                       (x > 0 && silhouette.to_right.at(x - 1, y) >= 0) || (y > 0 && silhouette.downwards.at(x, y - 1) >= 0);
      if (has) RC_ASSERT(beside.at(column, row));
      all = all && active.at(column, row);
    }
  }
  RC_CLASSIFY(!all, "some blocks left out");
}

/// A crossing is kept with one of its two pixels; where they belong to different blocks, both blocks lie beside it.
TEST(JumpFlood, BothBlocksLieBesideACrossingBetweenThem) {
  const Silhouette empty{.inside = {200, 40, 0}, .to_right = {200, 40, kNoCrossing}, .downwards = {200, 40, kNoCrossing}, .crossings = 1};
  Silhouette across = empty, down = empty;
  across.to_right.at(kBlockWidth_px - 1, 3) = 5;
  down.downwards.at(3, kBlockHeight_px - 1) = 5;
  EXPECT_TRUE(blocks_beside_crossings(across).at(0, 0));
  EXPECT_TRUE(blocks_beside_crossings(across).at(1, 0));
  EXPECT_TRUE(blocks_beside_crossings(down).at(0, 0));
  EXPECT_TRUE(blocks_beside_crossings(down).at(0, 1));
  EXPECT_FALSE(blocks_beside_crossings(across).any(2, 0, 3, 4));
  EXPECT_FALSE(blocks_beside_crossings(down).any(0, 2, 3, 4));
}

/// A single crossing is right everywhere in reach, at any distance and in any direction, and nowhere else: no block stops it on its way.
TEST(JumpFlood, OneCrossingReachesEveryPixelWithinReach) {
  for (const auto& [x, y] : {std::pair{0, 0}, {63, 7}, {64, 8}, {150, 60}, {299, 119}}) {
    Silhouette silhouette{
        .inside = {301, 121, 0}, .to_right = {301, 121, kNoCrossing}, .downwards = {301, 121, kNoCrossing}, .crossings = 1};
    silhouette.inside.at(x, y) = 1;
    silhouette.to_right.at(x, y) = 11;
    for (const int reach : {1, 2, 7, 33, 100, 500}) {
      for (int extra = 0; extra <= 2; ++extra) {
        ASSERT_EQ(jump_flood_squares(silhouette, reach, extra).pixels, exact_squares(silhouette, reach).pixels)
            << x << " " << y << " reach " << reach << " extra passes " << extra;
      }
    }
  }
}

TEST(JumpFlood, AnyNumberOfThreadsGivesTheSameSquares) {
  std::mt19937 random(5);
  const Silhouette silhouette = sparse_silhouette(random, 700, 500);
  ASSERT_GT(silhouette.crossings, 0);
  for (const int reach : {12, 102, 300}) {
    std::vector<Pixels<std::int32_t>> results;
    for (const int threads : {1, 2, 5}) {
      tbb::task_arena arena(threads);
      arena.execute([&] { results.push_back(jump_flood_squares(silhouette, reach, 2).pixels); });
    }
    EXPECT_EQ(results[0], results[1]);
    EXPECT_EQ(results[0], results[2]);
  }
}

}  // namespace
}  // namespace limn
