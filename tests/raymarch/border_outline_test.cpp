// Outlines by distance: the exact transform against brute force, jump flooding counted against it, widths against closed forms.

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <numbers>

#include "tests/raymarch/image_buffers.h"

namespace limn {
namespace {

using test::drawn;
using test::value;
using test::word;

Camera flat_camera(int width, int height) { return test::straight_camera(width, height, Projection::orthographic, 10.0); }

/// All crossings of a silhouette as points, in 1/32 px.
std::vector<glm::i64vec2> crossing_points(const Silhouette& silhouette) {
  std::vector<glm::i64vec2> points;
  for (int y = 0; y < silhouette.inside.height; ++y) {
    for (int x = 0; x < silhouette.inside.width; ++x) {
      const glm::i64vec2 centre(kSubPixels * x, kSubPixels * y);
      if (silhouette.to_right.at(x, y) >= 0) points.push_back(centre + glm::i64vec2(silhouette.to_right.at(x, y), 0));
      if (silhouette.downwards.at(x, y) >= 0) points.push_back(centre + glm::i64vec2(0, silhouette.downwards.at(x, y)));
    }
  }
  return points;
}

std::int32_t brute_force(const std::vector<glm::i64vec2>& points, int x, int y, int reach_px) {
  std::int64_t nearest = std::int64_t{reach_px} * reach_px * kSubPixels * kSubPixels + 1;
  for (const glm::i64vec2& point : points) {
    const glm::i64vec2 offset = point - glm::i64vec2(kSubPixels * x, kSubPixels * y);
    nearest = std::min(nearest, offset.x * offset.x + offset.y * offset.y);
  }
  return nearest > std::int64_t{reach_px} * reach_px * kSubPixels * kSubPixels ? kFarSquared : static_cast<std::int32_t>(nearest);
}

/// A random silhouette: sparse or dense pixels, or a few discs, with crossings anywhere between the centres.
Silhouette random_silhouette(std::mt19937& random, int width, int height) {
  const Camera camera = flat_camera(width, height);
  const int kind = std::uniform_int_distribution<int>(0, 3)(random);
  GBuffer seen = test::nothing_hit(width, height);
  if (kind == 3) {
    const double cx = width * 0.4, cy = height * 0.6, r = 0.3 * std::min(width, height);
    seen = test::mask_buffer(camera, [&](int x, int y) { return std::hypot(x + 0.5 - cx, y + 0.5 - cy) < r; });
  } else {
    std::bernoulli_distribution hit(kind == 0 ? 0.005 : kind == 1 ? 0.5 : 0.97);
    seen = test::mask_buffer(camera, [&](int, int) { return hit(random); });
  }
  Silhouette silhouette = find_silhouette(seen, false);
  std::uniform_int_distribution<int> place(0, kSubPixels);
  for (auto* crossings : {&silhouette.to_right, &silhouette.downwards}) {
    for (std::int8_t& crossing : crossings->pixels) {
      if (crossing >= 0) crossing = static_cast<std::int8_t>(place(random));
    }
  }
  return silhouette;
}

RC_GTEST_PROP(BorderOutline, ExactDistanceEqualsBruteForceOnRandomMasks, ()) {
  const auto seed = *rc::gen::arbitrary<unsigned>();
  RC_LOG() << "seed " << seed << "\n";
  std::mt19937 random(seed);
  const int width = *rc::gen::inRange(1, 70), height = *rc::gen::inRange(1, 70), reach = *rc::gen::inRange(0, 120);
  const Silhouette silhouette = random_silhouette(random, width, height);
  const std::vector<glm::i64vec2> points = crossing_points(silhouette);
  const Image<std::int32_t> squares = exact_squares(silhouette, reach);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) RC_ASSERT(squares.at(x, y) == brute_force(points, x, y, reach));
  }
}

/// Jump flooding may be wrong; it may not claim a distance that no crossing has, nor a smaller one than the exact.
RC_GTEST_PROP(BorderOutline, JumpFloodingIsNeverBelowTheExactDistance, ()) {
  const auto seed = *rc::gen::arbitrary<unsigned>();
  RC_LOG() << "seed " << seed << "\n";
  std::mt19937 random(seed);
  const int width = *rc::gen::inRange(1, 90), height = *rc::gen::inRange(1, 90), reach = *rc::gen::inRange(0, 120);
  const Silhouette silhouette = random_silhouette(random, width, height);
  for (int extra = 0; extra <= 2; ++extra) {
    const Image<std::int32_t> exact = exact_squares(silhouette, reach), flooded = jump_flood_squares(silhouette, reach, extra);
    for (size_t i = 0; i < exact.size(); ++i) RC_ASSERT(flooded.pixels[i] >= exact.pixels[i]);
  }
}

/// The sentence's numbers against a count made here, by brute force.
TEST(BorderOutline, JumpFloodingCountsItsWrongPixelsRight) {
  const Camera camera = flat_camera(160, 120);
  int pictures_with_wrong_pixels = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    std::mt19937 random(seed);
    std::bernoulli_distribution hit(0.004);
    const GBuffer seen = test::mask_buffer(camera, [&](int, int) { return hit(random); });
    const Silhouette silhouette = find_silhouette(seen, false);
    const std::vector<glm::i64vec2> points = crossing_points(silhouette);
    const Border border = drawn("jump_flood", seen, camera, {{"width", value(40)}, {"seeds", word("half")}, {"extra_passes", value(0)}});
    const int reach = OutlineBand{.width_px = 40.0}.reach_px();
    const Image<std::int32_t> flooded = jump_flood_squares(silhouette, reach, 0);
    int wrong = 0;
    double largest = 0.0;
    for (int y = 0; y < 120; ++y) {
      for (int x = 0; x < 160; ++x) {
        const std::int32_t truth = brute_force(points, x, y, reach);
        if (flooded.at(x, y) == truth) continue;
        ++wrong;
        const double ours = flooded.at(x, y) == kFarSquared ? reach : std::sqrt(double(flooded.at(x, y))) / kSubPixels;
        largest = std::max(largest, ours - std::sqrt(double(truth)) / kSubPixels);
      }
    }
    std::string said;
    for (const std::string& note : border.notes) {
      if (note.find("exact transform") != std::string::npos) said = note;
    }
    if (wrong == 0) {
      EXPECT_EQ(said, "") << "seed " << seed;
      continue;
    }
    ++pictures_with_wrong_pixels;
    int said_wrong = -1;
    double said_largest = -1.0;
    ASSERT_EQ(
        std::sscanf(said.c_str(), "jump_flood: %d pixels differ from the exact transform, at most %lf px", &said_wrong, &said_largest), 2)
        << said;
    EXPECT_EQ(said_wrong, wrong) << "seed " << seed;
    EXPECT_NEAR(said_largest, largest, 0.06 * largest) << "seed " << seed;
  }
  EXPECT_GT(pictures_with_wrong_pixels, 0) << "the masks are too easy to prove that anything is counted";
}

/// The picture of a sphere without perspective: a disc whose N.V is known.
GBuffer sphere_buffer(const Camera& camera, const glm::dvec2& centre_px, double radius_px) {
  GBuffer seen = test::nothing_hit(camera.width_px, camera.height_px);
  for (int y = 0; y < seen.height; ++y) {
    for (int x = 0; x < seen.width; ++x) {
      const glm::dvec2 offset = (glm::dvec2(x + 0.5, y + 0.5) - centre_px) / radius_px;
      const double square = glm::dot(offset, offset);
      if (square < 1.0) test::hit(seen, camera, x, y, 5.0, {offset.x, -offset.y, std::sqrt(1.0 - square)});
    }
  }
  return seen;
}

/// Mean over the disc's place within a pixel.
double mean_outline_area(double radius, const std::map<std::string, ParameterInput>& given) {
  const Camera camera = flat_camera(120, 120);
  double sum = 0.0;
  constexpr int kShifts = 4;
  for (int i = 0; i < kShifts; ++i) {
    for (int j = 0; j < kShifts; ++j) {
      const GBuffer seen = sphere_buffer(camera, {60.0 + double(i) / kShifts, 60.0 + double(j) / kShifts}, radius);
      sum += test::area(drawn("distance", seen, camera, given).coverage);
    }
  }
  return sum / (kShifts * kShifts);
}

TEST(BorderOutline, AnOutlineAroundADiscHasTheAnnulusArea) {
  constexpr double radius = 25.0, pi = std::numbers::pi;
  double worst_estimated_px = 0.0, worst_half_px = 0.0;
  for (const double width : {2.0, 3.0, 8.0, 20.0}) {
    for (const double softness : {0.0, 1.0, 2.0}) {
      for (const auto& [side, inner, outer] : {std::tuple{"outside", radius, radius + width},
                                               {"inside", radius - width, radius},
                                               {"centered", radius - 0.5 * width, radius + 0.5 * width}}) {
        const double annulus = pi * (outer * outer - inner * inner), length = pi * (outer + inner);
        for (const std::string seeds : {"estimated", "half"}) {
          const double drawn_area = mean_outline_area(
              radius, {{"width", value(width)}, {"softness", value(softness)}, {"side", word(side)}, {"seeds", word(seeds)}});
          const double width_error_px = (drawn_area - annulus) / length;
          double& worst = seeds == "half" ? worst_half_px : worst_estimated_px;
          worst = std::max(worst, std::abs(width_error_px));
          // Between two crossings a pixel apart the distance to the nearer one exceeds that to the curve by up to 1/8 px at 1 px, on each
          // edge of the ink; half-way crossings add what they lie off the disc, a quarter of a pixel RMS.
          EXPECT_LT(std::abs(width_error_px), seeds == "half" ? 0.75 : 0.15) << seeds << " " << side << " " << width << " " << softness;
        }
      }
    }
  }
  RecordProperty("worst_estimated_px", std::to_string(worst_estimated_px));
  RecordProperty("worst_half_px", std::to_string(worst_half_px));
  EXPECT_LT(worst_estimated_px, 0.5 * worst_half_px);
}

/// Distances of the crossings from the contour's circle: those that N.V estimates, and half-way ones.
TEST(BorderOutline, CrossingsEstimatedFromTheNormalLieNearerToTheContourOfASphere) {
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    const Scene scene = test::scene_of({test::object_of(make_shape("sphere"))});
    CameraSettings settings = test::view(200, 160, projection);
    settings.eye = glm::dvec3(0.3, 0.2, 6.0);
    settings.target = glm::dvec3(0.0);
    if (projection == Projection::orthographic) settings.ortho_height = 2.6;
    const Camera camera = test::framing(scene, settings);
    const GBuffer seen = render_gbuffer(test::model_of(scene), camera, {});
    // The sphere lies on the axis, so its contour is a circle about the picture's centre.
    const double distance = glm::length(camera.eye), radius_px = projection == Projection::orthographic
                                                                     ? camera.pixels_per_unit
                                                                     : camera.focal_px / std::sqrt(distance * distance - 1.0);
    const auto rms = [&](bool estimate) {
      double sum = 0.0;
      const std::vector<glm::i64vec2> points = crossing_points(find_silhouette(seen, estimate));
      for (const glm::i64vec2& point : points) {
        const glm::dvec2 at = glm::dvec2(point) / double(kSubPixels) + 0.5 - glm::dvec2(100.0, 80.0);
        sum += std::pow(glm::length(at) - radius_px, 2.0);
      }
      return std::sqrt(sum / double(points.size()));
    };
    RecordProperty("estimated_px", std::to_string(rms(true)));
    RecordProperty("half_px", std::to_string(rms(false)));
    EXPECT_LT(rms(true), 0.05);
    EXPECT_GT(rms(false), 0.15);
  }
}

TEST(BorderOutline, HalfWayCrossingsStayWhereTheEdgeIsHard) {
  const Camera camera = flat_camera(20, 20);
  const GBuffer seen = test::mask_buffer(camera, [](int x, int y) { return x >= 5 && x < 12 && y >= 3 && y < 17; });
  const Silhouette estimated = find_silhouette(seen, true), half = find_silhouette(seen, false);
  EXPECT_EQ(estimated.to_right.pixels, half.to_right.pixels);
  EXPECT_EQ(estimated.downwards.pixels, half.downwards.pixels);
  EXPECT_EQ(estimated.to_right.at(4, 8), kSubPixels / 2);
  EXPECT_EQ(estimated.crossings, 2 * (7 + 14));
}

TEST(BorderOutline, AStraightEdgeHasExactlyTheWidthAskedFor) {
  const Camera camera = flat_camera(40, 6);
  const GBuffer seen = test::mask_buffer(camera, [](int x, int) { return x < 15; });
  for (const std::string method : {"distance", "jump_flood"}) {
    for (const double width : {0.25, 1.0, 3.0, 3.5, 12.25}) {
      for (const std::string side : {"outside", "inside", "centered"}) {
        const Border border = drawn(method, seen, camera, {{"width", value(width)}, {"side", word(side)}});
        EXPECT_NEAR(test::area(border.coverage), 6.0 * width, 1e-3) << method << " " << side << " " << width;
      }
    }
  }
}

TEST(BorderOutline, ThinSilhouettesAreSaid) {
  const Camera camera = flat_camera(20, 20);
  const GBuffer seen = test::mask_buffer(camera, [](int x, int y) { return x == 10 && y > 3 && y < 9; });
  const Border border = drawn("distance", seen, camera);
  ASSERT_EQ(border.notes.size(), 1u);
  EXPECT_NE(border.notes[0].find("5 pixels"), std::string::npos);
}

}  // namespace
}  // namespace limn
