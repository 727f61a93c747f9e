// The Laplacian of depth against its kernel by hand, and where the answer is known: jumps, creases, spheres, the frame. That planes have no
// ink at any tilt, that ink is in range and that any number of threads gives equal bytes is asked of it with all other image methods
// (image_methods()).

#include <numbers>

#include "tests/raymarch/image_buffers.h"

namespace limn {
namespace {

using test::drawn;
using test::value;
using test::word;

constexpr Projection kProjections[] = {Projection::perspective, Projection::orthographic};

/// Depth 5 with `relief_px(x, y)` taken off, in pixels at that depth.
template <class Relief>
GBuffer relief_buffer(const Camera& camera, const Relief& relief_px) {
  GBuffer seen = test::nothing_hit(camera.width_px, camera.height_px);
  for (int y = 0; y < seen.height; ++y) {
    for (int x = 0; x < seen.width; ++x)
      test::hit(seen, camera, x, y, 5.0 - relief_px(x, y) / pixels_per_unit_at(camera, 5.0), {0.0, 0.0, 1.0});
  }
  return seen;
}

/// Row `y` as text: '#' ink, '.' none.
std::string row_of(const Border& border, int y) {
  std::string row;
  for (int x = 0; x < border.coverage.width; ++x) row += border.coverage.at(x, y) > 0.5f ? '#' : '.';
  return row;
}

TEST(DepthLaplacian, IsEightTimesThePixelLessItsNeighboursByThree) {
  constexpr double relief[4][4] = {{0, 0, 0, 0}, {0, 1, 2, 0}, {0, 4, 0, 0}, {0, 0, 0, 3}};
  // (8X - A - B - C - D - E - F - G - H) / 3 inside; at the frame the second difference along it.
  constexpr double expected[4][4] = {{0, 0, 0, 0}, {0, 2.0 / 3.0, 11.0 / 3.0, 0}, {0, 29.0 / 3.0, -10.0 / 3.0, -3}, {0, 0, -3, 0}};
  const Camera camera = test::straight_camera(4, 4, Projection::orthographic, 10.0);
  const GBuffer seen = relief_buffer(camera, [&](int x, int y) { return relief[y][x]; });
  const auto inked = [&](double threshold, const char* side, int x, int y) {
    const Border border = drawn("depth_laplacian", seen, camera,
                                {{"threshold", value(threshold)}, {"slope_correction", word("false")}, {"side", word(side)}});
    return border.coverage.at(x, y) > 0.5f;
  };
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 4; ++x) {
      const double size = std::abs(expected[y][x]);
      EXPECT_FALSE(inked(size + 1e-3, "both", x, y)) << x << "," << y;
      if (size == 0.0) continue;
      const char *const side = expected[y][x] > 0.0 ? "near" : "far", *const other = expected[y][x] > 0.0 ? "far" : "near";
      EXPECT_TRUE(inked(size - 1e-3, "both", x, y)) << x << "," << y;
      EXPECT_TRUE(inked(size - 1e-3, side, x, y)) << x << "," << y;
      EXPECT_FALSE(inked(size - 1e-3, other, x, y)) << x << "," << y;
    }
  }
}

TEST(DepthLaplacian, InksBothPixelsOfAJumpOrTheSideAskedFor) {
  for (const Projection projection : kProjections) {
    const Camera camera = test::straight_camera(16, 8, projection, 400.0);
    for (const double jump_px : {0.3, 2.0, 100.0}) {
      for (const double slope : {0.0, 0.5}) {
        const GBuffer seen = relief_buffer(camera, [&](int x, int y) { return (x < 8 ? jump_px : 0.0) + slope * y; });
        const auto rows = [&](const char* side) { return row_of(drawn("depth_laplacian", seen, camera, {{"side", word(side)}}), 4); };
        const bool is_found = jump_px > 0.25 * (1.0 + slope * slope);
        const std::string what = std::to_string(jump_px) + " px, slope " + std::to_string(slope);
        EXPECT_EQ(rows("both"), is_found ? ".......##......." : "................") << what;
        EXPECT_EQ(rows("near"), is_found ? ".......#........" : "................") << what;
        EXPECT_EQ(rows("far"), is_found ? "........#......." : "................") << what;
      }
    }
  }
}

/// Two faces that meet along a column, or between two, with the slopes -s and s. Convex: the middle is nearest.
TEST(DepthLaplacian, InksCreasesThatTurnFarEnoughWhereverTheyLieBetweenThePixels) {
  constexpr double threshold = 0.25;
  const Camera camera = test::straight_camera(21, 9, Projection::orthographic, 100.0);
  for (const double way : {-1.0, 1.0}) {
    for (const double between : {0.0, 0.25, 0.5}) {
      for (const double slope : {0.1, 0.6, 1.0}) {
        const auto relief = [&](int x) { return way * slope * std::abs(x - 10.0 - between); };
        const GBuffer seen = relief_buffer(camera, [&](int x, int) { return relief(x); });
        std::string expected;
        for (int x = 0; x < 21; ++x) {
          const double left = relief(x) - relief(x - 1), right = relief(x + 1) - relief(x);
          const double squared = left * right > 0.0 ? left * right : std::min(left * left, right * right);
          expected += x > 0 && x < 20 && std::abs(right - left) >= threshold * (1.0 + squared) ? '#' : '.';
        }
        // On a column the answer is the sine of the angle between the faces, sin(2 atan(slope)); two columns share it, one has half.
        EXPECT_EQ(expected.find('#') != std::string::npos, std::sin(2.0 * std::atan(slope)) > threshold);
        const auto row = [&](const char* side) {
          return row_of(drawn("depth_laplacian", seen, camera, {{"side", word(side)}, {"threshold", value(threshold)}}), 4);
        };
        const std::string what = std::to_string(way) + " " + std::to_string(between) + " " + std::to_string(slope);
        EXPECT_EQ(row("both"), expected) << what;
        EXPECT_EQ(row(way < 0.0 ? "near" : "far"), expected) << what;
        EXPECT_EQ(row(way < 0.0 ? "far" : "near"), std::string(21, '.')) << what;
      }
    }
  }
}

TEST(DepthLaplacian, InksTheSilhouetteAPixelWideAndNothingAlongTheFrame) {
  for (const Projection projection : kProjections) {
    const Camera camera = test::straight_camera(14, 10, projection, 400.0);
    const GBuffer seen = test::mask_buffer(camera, [](int x, int y) { return x < 7 && y > 2; });
    const Border border = drawn("depth_laplacian", seen, camera);
    for (int y = 0; y < 10; ++y) EXPECT_EQ(row_of(border, y), y < 3 ? ".............." : y == 3 ? "#######......." : "......#.......") << y;
    EXPECT_EQ(test::area(drawn("depth_laplacian", seen, camera, {{"side", word("far")}}).coverage), 0.0) << "behind it there is nothing";
  }
}

/// Ink of a ball's disc as the width of a ring inside it, in pixels.
double ring_px(double radius_px, const char* slope_correction, std::vector<std::string>& notes) {
  const int side = static_cast<int>(2.0 * radius_px) + 11;
  const Camera camera = test::straight_camera(side, side, Projection::orthographic, 10.0);
  const double centre = 0.5 * side + 0.2;
  GBuffer seen = test::nothing_hit(side, side);
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const double square = radius_px * radius_px - std::pow(x + 0.5 - centre, 2.0) - std::pow(y + 0.5 - centre, 2.0);
      if (square > 0.0) test::hit(seen, camera, x, y, 100.0 - std::sqrt(square) / 10.0, {0.0, 0.0, 1.0});
    }
  }
  const Border border = drawn("depth_laplacian", seen, camera, {{"slope_correction", word(slope_correction)}, {"threshold", value(0.25)}});
  notes = border.notes;
  return radius_px - std::sqrt(radius_px * radius_px - test::area(border.coverage) / std::numbers::pi);
}

/// Where the Laplacian of a ball's depth, R^2 / (R^2 - r^2)^(3/2) + 1 / (R^2 - r^2)^(1/2), is the threshold, less than R by so many pixels.
double band_px(double radius_px, double threshold) {
  double low = 0.0, high = radius_px;
  for (int i = 0; i < 60; ++i) {
    const double r = 0.5 * (low + high), root = std::sqrt(radius_px * radius_px - r * r);
    (radius_px * radius_px / std::pow(root, 3.0) + 1.0 / root < threshold ? low : high) = r;
  }
  return radius_px - low;
}

TEST(DepthLaplacian, RimsOfBallsAreLinesWithTheSlopeCorrectionAndBandsWithoutIt) {
  for (const double radius_px : {20.0, 30.0, 100.0, 300.0}) {
    std::vector<std::string> notes;
    // The pixels that touch the background by a side or a corner: 4 / pi in the mean over all directions.
    EXPECT_NEAR(ring_px(radius_px, "true", notes), 4.0 / std::numbers::pi, 0.1) << radius_px;
    EXPECT_TRUE(notes.empty()) << notes[0];
    // The second difference reaches a pixel to both sides, which counts where the derivative changes within a pixel.
    EXPECT_NEAR(ring_px(radius_px, "false", notes), band_px(radius_px, 0.25), 0.5) << radius_px;
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_NE(notes[0].find("neither jumps nor has a crease"), std::string::npos) << notes[0];
  }
}

TEST(DepthLaplacian, SaysWhereObjectsMeetAtOneDepthWithoutALine) {
  const Camera camera = test::straight_camera(16, 8, Projection::perspective, 100.0);
  GBuffer seen = test::plane_buffer(camera, {0.0, 0.0, 1.0}, 5.0);
  for (int y = 0; y < 8; ++y) std::fill_n(&seen.id.at(8, y), 8, 2);
  SceneModel model;
  model.surfaces.resize(2);
  const Scene scene;
  const Border border = find_border_method("depth_laplacian").draw({seen, camera, model, scene}, test::parameters_of("depth_laplacian"));
  EXPECT_EQ(test::area(border.coverage), 0.0);
  ASSERT_EQ(border.notes.size(), 1u);
  EXPECT_NE(border.notes[0].find("8 of 8 places where one object meets another have no line"), std::string::npos) << border.notes[0];
}

}  // namespace
}  // namespace limn
