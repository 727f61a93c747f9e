// Pieces of line that are too short to be lines: counted and taken away in pictures drawn by hand, and said where a grid breaks a crease.

#include "raymarch/border/broken_lines.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "raymarch/border/specks.h"
#include "tests/random_seed.h"
#include "tests/raymarch/image_buffers.h"

namespace limn::test {
namespace {

Image<float> ink_of(const std::vector<std::string>& rows) {
  Image<float> ink(static_cast<int>(rows[0].size()), static_cast<int>(rows.size()), 0.0f);
  for (int y = 0; y < ink.height; ++y)
    for (int x = 0; x < ink.width; ++x) ink.at(x, y) = rows[static_cast<size_t>(y)][static_cast<size_t>(x)] == '#';
  return ink;
}

constexpr auto kAll = [](size_t) { return true; };

TEST(Specks, AreCountedAndTakenAwayByHand) {
  const Image<float> ink = ink_of({"##....#...#", "..#...#....", "......#...#", "#.....#..#.", "......#.#..", "#.....#...."});
  // Top left 3, the column of 6, a single pixel at the top right, the diagonal of 3, two single pixels at the left.
  EXPECT_EQ(count_specks(ink, 6, kAll), 5);
  EXPECT_EQ(count_specks(ink, 7, kAll), 6);
  EXPECT_EQ(count_specks(ink, 3, kAll), 3);
  EXPECT_EQ(count_specks(ink, 1, kAll), 0);
  // A piece counts where all of it does.
  const auto not_first = [](size_t i) { return i != 0; };
  EXPECT_EQ(count_specks(ink, 6, not_first), 4);
  Image<float> left = ink;
  drop_specks(6, not_first, left);
  EXPECT_EQ(left.pixels, ink_of({"##....#....", "..#...#....", "......#....", "......#....", "......#....", "......#...."}).pixels);
}

/// The pieces of a picture, each with all of its pixels.
std::vector<std::vector<size_t>> flooded(const Image<float>& ink) {
  std::vector<std::vector<size_t>> pieces;
  Image<std::uint8_t> taken(ink.width, ink.height, 0);
  for (size_t i = 0; i < ink.size(); ++i) {
    if (ink.pixels[i] == 0.0f || taken.pixels[i]) continue;
    std::vector<size_t>& piece = pieces.emplace_back(1, i);
    taken.pixels[i] = 1;
    for (size_t k = 0; k < piece.size(); ++k) {
      const int x = static_cast<int>(piece[k]) % ink.width, y = static_cast<int>(piece[k]) / ink.width;
      for (int v = y - 1; v <= y + 1; ++v)
        for (int u = x - 1; u <= x + 1; ++u) {
          if (!ink.inside(u, v) || ink.at(u, v) == 0.0f || taken.at(u, v)) continue;
          taken.at(u, v) = 1;
          piece.push_back(ink.index(u, v));
        }
    }
  }
  return pieces;
}

TEST(Specks, AreWhatFloodFillFindsInPicturesOfManyBands) {
  const std::uint64_t seed = random_seed();
  std::mt19937_64 random(seed);
  Image<float> ink(90, 150, 0.0f);
  for (float& p : ink.pixels) p = random() % 5 == 0;
  // What lies on nothing keeps its piece.
  Image<std::uint8_t> counts(ink.width, ink.height, 0);
  for (std::uint8_t& p : counts.pixels) p = random() % 10 != 0;
  const auto counted = [&](size_t i) { return counts.pixels[i] != 0; };
  std::int64_t small = 0, small_and_counted = 0;
  Image<float> expected = ink;
  for (const std::vector<size_t>& piece : flooded(ink)) {
    if (static_cast<int>(piece.size()) >= kSpeckPx) continue;
    ++small;
    if (!std::all_of(piece.begin(), piece.end(), counted)) continue;
    ++small_and_counted;
    for (const size_t i : piece) expected.pixels[i] = 0.0f;
  }
  EXPECT_EQ(count_specks(ink, kSpeckPx, kAll), small) << "seed " << seed;
  EXPECT_EQ(count_specks(ink, kSpeckPx, counted), small_and_counted) << "seed " << seed;
  Image<float> left = ink;
  drop_specks(kSpeckPx, counted, left);
  EXPECT_EQ(left.pixels, expected.pixels) << "seed " << seed;
  EXPECT_GT(small_and_counted, 100);
  EXPECT_GT(small, small_and_counted + 50);
}

std::string said(double voxel_size) {
  const Camera camera = straight_camera(12, 3, Projection::orthographic, 10.0);
  const GBuffer seen = plane_buffer(camera, {0.0, 0.0, 1.0}, 5.0);
  SceneModel model;
  model.surfaces.resize(1);
  model.surfaces[0].info.voxel_size = voxel_size;
  const Image<float> ink = ink_of({"############", "............", "..##...#...."});
  return broken_lines_note("roberts", {seen, camera, model, Scene{}}, ink);
}

TEST(BrokenLines, AreSaidWhereVoxelsCoverPixels) {
  // 10 pixels a unit.
  EXPECT_TRUE(said(0.3).starts_with("roberts: 2 pieces of line on level sets are shorter than 6 px")) << said(0.3);
  EXPECT_EQ(said(0.05), "");
  EXPECT_EQ(said(0.0), "");
}

}  // namespace
}  // namespace limn::test
