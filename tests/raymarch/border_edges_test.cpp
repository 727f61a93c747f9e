// Edge methods against buffers small enough to work out by hand, and against planes, where no line is true.

#include "raymarch/border/edge_sources.h"
#include "tests/raymarch/image_buffers.h"

namespace limn {
namespace {

using test::drawn;
using test::value;
using test::word;

constexpr int kSide = 4;
// Written by hand; the magnitudes below were worked out from these on paper.
constexpr double kBuffer[kSide][kSide] = {{0, 0, 0, 0}, {0, 1, 2, 0}, {0, 4, 0, 0}, {0, 0, 0, 3}};
// sqrt(h^2 + v^2): h = b(x,y) - b(x+1,y+1), v = b(x+1,y) - b(x,y+1); the last line and column repeat.
const double kRobertsSquared[kSide][kSide] = {
    {1, 4 + 1, 0 + 4, 0}, {16 + 1, 1 + 4, 4 + 0, 0}, {0 + 16, 16 + 0, 9 + 0, 9 + 9}, {0, 0, 9 + 9, 0}};
// gx^2 + gy^2 with [1 2 1] x [-1 0 1], borders repeated.
const double kSobelSquared[kSide][kSide] = {{1 + 1, 4 + 16, 1 + 25, 4 + 4},
                                            {36 + 16, 16 + 64, 36 + 16, 16 + 0},
                                            {81 + 1, 4 + 16, 36 + 4, 1 + 49},
                                            {16 + 16, 0 + 64, 25 + 1, 81 + 81}};

/// The edge strength at a pixel lies between two thresholds a part in 10^4 apart.
testing::AssertionResult has_strengths(const std::string& method, double scale, const double (&squared)[kSide][kSide]) {
  const Camera camera = test::straight_camera(kSide, kSide, Projection::orthographic, 10.0);
  GBuffer seen = test::plane_buffer(camera, {0.0, 0.0, 1.0}, 5.0);
  seen.custom = {kSide, kSide, glm::vec3(0.0f)};
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) seen.custom.at(x, y).y = static_cast<float>(kBuffer[y][x]);
  }
  const auto inked = [&](double threshold, int x, int y) {
    return drawn(method, seen, camera, {{"custom_weight", value(1)}, {"custom_threshold", value(threshold)}}).coverage.at(x, y);
  };
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const double strength = std::sqrt(squared[y][x]) / scale;
      const float below = strength > 0.0 ? inked(strength * 0.9999, x, y) : 1.0f, above = inked(strength * 1.0001, x, y);
      if (below != 1.0f || above != 0.0f)
        return testing::AssertionFailure() << method << " " << x << "," << y << ": ink " << below << " below the strength " << strength
                                           << ", should be 1; " << above << " above it, should be 0";
    }
  }
  return testing::AssertionSuccess();
}

TEST(BorderEdges, RobertsIsTheCrossOfDifferencesOnAHandMadeBuffer) {
  EXPECT_TRUE(has_strengths("roberts", std::sqrt(2.0), kRobertsSquared));
}

TEST(BorderEdges, SobelIsTheThreeByThreeGradientOnAHandMadeBuffer) { EXPECT_TRUE(has_strengths("sobel", 4.0, kSobelSquared)); }

TEST(BorderEdges, EverySourceHasItsOwnLineAndWeight) {
  const Camera camera = test::straight_camera(16, 8, Projection::orthographic, 10.0);
  const std::map<std::string, ParameterInput> none{{"depth_weight", value(0)},
                                                   {"normal_weight", value(0)},
                                                   {"color_weight", value(0)},
                                                   {"id_weight", value(0)},
                                                   {"custom_weight", value(0)}};
  const auto only = [&](const std::string& method, const std::string& source, const GBuffer& seen) {
    auto given = none;
    given[source + "_weight"] = value(0.5);
    return drawn(method, seen, camera, given).coverage;
  };
  for (const std::string method : {"roberts", "sobel"}) {
    const GBuffer flat = test::plane_buffer(camera, {0.0, 0.0, 1.0}, 5.0);
    std::map<std::string, GBuffer> changed;
    for (const std::string source : {"depth", "normal", "color", "id", "custom"}) changed[source] = flat;
    for (GBuffer* seen : {&changed["custom"]}) seen->custom = {16, 8, glm::vec3(0.0f)};
    GBuffer material = flat;
    for (int y = 0; y < 8; ++y) {
      for (int x = 8; x < 16; ++x) {
        changed["depth"].depth.at(x, y) = 9.0f;
        changed["normal"].normal.at(x, y) = glm::vec3(0.0f, 0.8f, 0.6f);
        changed["color"].n_dot_v.at(x, y) = 0.3f;
        changed["id"].id.at(x, y) = 2;
        changed["custom"].custom.at(x, y) = glm::vec3(0.0f, 0.0f, 0.7f);
        material.material.at(x, y) = 4;
      }
    }
    // Roberts spans the pixels x and x+1; Sobel answers on both sides of the jump.
    const int first = 7, last = method == "roberts" ? 7 : 8;
    const auto is_line = [&](const Image<float>& ink) {
      for (int y = 0; y < 8; ++y) {
        for (int x = 0; x < 16; ++x) {
          const float expected = x >= first && x <= last ? 0.5f : 0.0f;
          if (ink.at(x, y) != expected)
            return testing::AssertionFailure() << ink.at(x, y) << " at " << x << "," << y << ", not " << expected;
        }
      }
      return testing::AssertionSuccess();
    };
    for (const auto& [source, seen] : changed) {
      EXPECT_TRUE(is_line(only(method, source, seen))) << method << " " << source;
      for (const auto& [other, unused] : changed) {
        // The shaded colour of another object is another colour too.
        if (other == source || (source == "id" && other == "color")) continue;
        if (other != "custom") {
          EXPECT_EQ(test::area(only(method, other, seen)), 0.0) << method << ": " << source << " seen by " << other;
        }
      }
    }
    EXPECT_TRUE(is_line(only(method, "id", material))) << method << " material";
  }
}

TEST(BorderEdges, AnEmptyCustomBufferIsSaidAndDrawsNothing) {
  const Camera camera = test::straight_camera(8, 8, Projection::perspective, 10.0);
  for (const std::string method : {"roberts", "sobel"}) {
    const Border border = drawn(method, test::plane_buffer(camera, {0.0, 0.0, 1.0}, 5.0), camera, {{"custom_weight", value(1)}});
    ASSERT_EQ(border.notes.size(), 1u);
    EXPECT_NE(border.notes[0].find("custom"), std::string::npos);
    EXPECT_EQ(test::area(border.coverage), 0.0);
  }
}

TEST(BorderEdges, TheDebugViewShowsDepthNormalAndColourInRedGreenAndBlue) {
  const Camera camera = test::straight_camera(16, 4, Projection::orthographic, 10.0);
  GBuffer seen = test::plane_buffer(camera, {0.0, 0.0, 1.0}, 5.0);
  for (int y = 0; y < 4; ++y) {
    for (int x = 4; x < 16; ++x) seen.depth.at(x, y) = 9.0f;
    for (int x = 8; x < 16; ++x) seen.normal.at(x, y) = glm::vec3(0.0f, 0.8f, 0.6f);
    for (int x = 12; x < 16; ++x) seen.n_dot_v.at(x, y) = 0.3f;
  }
  const Border border = drawn("roberts", seen, camera, {{"view", word("debug")}});
  EXPECT_EQ(border.colors.at(3, 1), glm::vec3(1.0f, 0.0f, 0.0f));
  EXPECT_EQ(border.colors.at(7, 1), glm::vec3(0.0f, 1.0f, 0.0f));
  EXPECT_EQ(border.colors.at(11, 1), glm::vec3(0.0f, 0.0f, 1.0f));
  EXPECT_EQ(test::area(border.coverage), 12.0);
}

TEST(BorderEdges, GrazingFactorIsTheFormula) {
  const GrazingModulation modulation{0.7, 0.25, 3.0, 1.0};
  for (double n_dot_v = 0.0; n_dot_v <= 1.0; n_dot_v += 0.01) {
    const double fresnel = std::pow(1.0 - n_dot_v, 3.0);
    const double m = std::clamp((fresnel + 0.7 - 1.0) / 0.7, 0.0, 1.0), t = std::clamp(m / 0.75, 0.0, 1.0);
    EXPECT_NEAR(grazing_factor(modulation, n_dot_v), 1.0 + t * t * (3.0 - 2.0 * t), 2e-6);
  }
}

TEST(BorderEdges, TheDefaultModulationCoversThePlanesSlopeUpToEightyNineDegrees) {
  double least_margin = 1e9;
  for (double degrees = 0.0; degrees <= 89.0; degrees += 0.05) {
    const double cosine = std::cos(glm::radians(degrees));
    least_margin = std::min(least_margin, 5.0 * grazing_factor(GrazingModulation{}, cosine) * cosine);
  }
  EXPECT_GT(least_margin, 1.0);
  EXPECT_LT(5.0 * std::cos(glm::radians(89.0)), 1.0) << "without modulation the threshold is too low";
}

TEST(BorderEdges, NormalFourOnAHandMadeBufferIsTheSumOverTheNeighbours) {
  const Camera camera = test::straight_camera(5, 3, Projection::orthographic, 10.0);
  GBuffer seen = test::plane_buffer(camera, {0.0, 0.0, 1.0}, 5.0);
  seen.normal.at(2, 1) = glm::vec3(0.0f, 0.6f, 0.8f);
  const Image<float> raw = drawn("normal4", seen, camera, {{"ink", word("raw")}}).coverage;
  EXPECT_NEAR(raw.at(2, 1), 4.0f * 0.2f, 1e-6);
  for (const auto& [x, y] : {std::pair{1, 1}, {3, 1}, {2, 0}, {2, 2}}) EXPECT_NEAR(raw.at(x, y), 0.2f, 1e-6);
  EXPECT_EQ(raw.at(0, 0), 0.0f);
  EXPECT_EQ(raw.at(4, 2), 0.0f);
  const Image<float> hard = drawn("normal4", seen, camera, {{"threshold", value(0.5)}}).coverage;
  EXPECT_EQ(test::area(hard), 1.0);
}

TEST(BorderEdges, NormalFourShowsASilhouetteByItsClearValueAndCountsWhereItCannot) {
  const Camera camera = test::straight_camera(8, 8, Projection::orthographic, 10.0);
  const auto disc = [](int x, int y) { return x >= 2 && x < 6 && y >= 2 && y < 6; };
  GBuffer turned = test::mask_buffer(camera, disc), facing = turned;
  for (glm::vec3& normal : turned.normal.pixels) normal = normal == glm::vec3(0.0f) ? normal : glm::vec3(1.0f, 0.0f, 0.0f);
  EXPECT_EQ(drawn("normal4", turned, camera).coverage.at(2, 3), 1.0f);
  EXPECT_TRUE(drawn("normal4", turned, camera).notes.empty());
  const Border lost = drawn("normal4", facing, camera);
  EXPECT_EQ(test::area(lost.coverage), 0.0);
  ASSERT_EQ(lost.notes.size(), 1u);
  EXPECT_NE(lost.notes[0].find("12 of 12 silhouette pixels"), std::string::npos) << lost.notes[0];
}

}  // namespace
}  // namespace limn
