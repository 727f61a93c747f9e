// Shadings, looks and the strokes that they draw.

#include "raymarch/look.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "raymarch/border/stroke_forms.h"
#include "raymarch/picture/occlusion.h"
#include "raymarch/picture/shade.h"
#include "tests/random_seed.h"
#include "tests/raymarch/scenes.h"

namespace limn::test {
namespace {

Scene ball() { return scene_of({object_of(make_shape("sphere", {}))}); }

/// From the front, so that the middle of a ball is that of the picture.
Camera front_of(const Scene& scene) {
  CameraSettings settings = view(160, 120);
  settings.direction = glm::dvec3(0.0, 0.0, 1.0);
  return framing(scene, settings);
}

Picture drawn(const Scene& scene, const ShadingSettings& shading, std::vector<MethodCall> methods = {}, int samples = 1) {
  const Camera camera = front_of(scene);
  PictureSettings settings;
  settings.shading = shading;
  settings.methods = std::move(methods);
  settings.samples = samples;
  return draw_picture(scene, model_of(scene), camera, settings, {});
}

std::set<std::array<float, 3>> tones(const Picture& picture) {
  std::set<std::array<float, 3>> found;
  for (const glm::vec4& c : picture.composite.pixels)
    if (c.a > 0.0f) found.insert({c.r, c.g, c.b});
  return found;
}

TEST(Shading, CelHasAsManyTonesAsSteps) {
  for (const int steps : {2, 3, 5})
    EXPECT_EQ(tones(drawn(ball(), {.shading = Shading::cel, .steps = steps})).size(), static_cast<size_t>(steps));
  // The rim is one more.
  EXPECT_EQ(tones(drawn(ball(), {.shading = Shading::cel, .steps = 3, .rim_light = 0.5})).size(), 4u);
}

TEST(Shading, FlatIsTheColourAndNoneIsNothing) {
  const Scene scene = ball();
  const auto flat = tones(drawn(scene, {.shading = Shading::flat}));
  const glm::vec3 color = scene.objects[0].color;
  EXPECT_EQ(flat, (std::set<std::array<float, 3>>{{color.r, color.g, color.b}}));
  for (const glm::vec4& c : drawn(scene, {.shading = Shading::none}).composite.pixels) EXPECT_EQ(c, glm::vec4(0.0f));
}

TEST(Shading, HeadlightIsThatOfShadeHeadlight) {
  const Scene scene = ball();
  const Camera camera = front_of(scene);
  const SceneModel model = model_of(scene);
  const Picture picture = drawn(scene, {});
  const BorderInput input{picture.gbuffer, camera, model, scene};
  EXPECT_EQ(shade(input, {}).pixels, shade_headlight(input).pixels);
  EXPECT_EQ(picture.composite.pixels, shade_headlight(input).pixels);
}

TEST(Shading, NormalsPointAtTheEyeInTheMiddle) {
  const Picture picture = drawn(ball(), {.shading = Shading::normal});
  const glm::vec4 middle = picture.composite.at(80, 60);
  EXPECT_NEAR(middle.b, 1.0f, 0.02f);
  EXPECT_NEAR(middle.r, 0.214f, 0.02f);  // 0.5 in sRGB
  EXPECT_NEAR(middle.g, 0.214f, 0.02f);
}

TEST(Occlusion, OfABallIsNextToNothingAndOfANotchIsMuch) {
  const auto occlusion = [](const Scene& scene, const CameraSettings& settings) {
    const Camera camera = framing(scene, settings);
    GBuffer gbuffer = render_gbuffer(model_of(scene), camera, {});
    return screen_occlusion(gbuffer, camera);
  };
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    const Image<float> open = occlusion(ball(), view(160, 120, projection));
    EXPECT_LT(*std::max_element(open.pixels.begin(), open.pixels.end()), 0.05f);
    // Two balls that pass through each other, seen from the side: a notch in the middle.
    CameraSettings settings = view(160, 120, projection);
    settings.direction = glm::dvec3(0.0, 0.0, 1.0);
    const Field sphere = make_shape("sphere", {});
    const Image<float> notch =
        occlusion(scene_of({object_of(translate(sphere, {-0.9, 0.0, 0.0})), object_of(translate(sphere, {0.9, 0.0, 0.0}))}), settings);
    EXPECT_GT(std::max(notch.at(79, 60), notch.at(80, 60)), 0.2f);
    EXPECT_LT(notch.at(45, 60), 0.05f);
  }
}

TEST(Looks, NameMethodsAndParametersThatThereAre) {
  EXPECT_GE(looks().size(), 5u);
  for (const Look& look : looks()) {
    EXPECT_FALSE(look.about.help.empty());
    for (const LookInk& ink : look.inks) EXPECT_NO_THROW(parameters_of(ink.method, ink.parameters)) << look.about.name;
  }
}

double length_of(const std::vector<StrokePoint>& stroke) {
  double length = 0.0;
  for (size_t i = 1; i < stroke.size(); ++i) length += glm::distance(stroke[i - 1].px, stroke[i].px);
  return length;
}

TEST(StrokeForms, DashesFillTheStrokeAndBeginAndEndIt) {
  std::mt19937_64 random(random_seed());
  std::uniform_real_distribution<double> length(1.0, 400.0), dash(1.0, 20.0);
  for (int i = 0; i < 200; ++i) {
    const double whole = length(random), dash_px = dash(random);
    const std::vector<StrokePoint> stroke = {{{10.0, 5.0}, 1.0}, {{10.0 + 0.3 * whole, 5.0}, 1.0}, {{10.0 + whole, 5.0}, 3.0}};
    const auto dashes = dashes_of(stroke, false, dash_px);
    ASSERT_FALSE(dashes.empty());
    EXPECT_NEAR(dashes.front().front().px.x, 10.0, 1e-9);
    EXPECT_NEAR(dashes.back().back().px.x, 10.0 + whole, 1e-9);
    double sum = 0.0;
    for (const auto& one : dashes) {
      sum += length_of(one);
      EXPECT_NEAR(length_of(one), length_of(dashes.front()), 1e-9);
    }
    const auto n = static_cast<double>(dashes.size());
    EXPECT_NEAR(sum / whole, n / (n + 0.8 * (n - 1.0)), 1e-9);
    // As near to the length asked for as a whole number of dashes allows.
    if (whole > 3.0 * dash_px) {
      EXPECT_NEAR(length_of(dashes.front()) / dash_px, 1.0, 0.35);
    }
  }
}

TEST(StrokeForms, WobblingStaysWithinItsBoundClosesAndFollowsItsSeed) {
  std::vector<StrokePoint> ring;
  for (int i = 0; i < 90; ++i)
    ring.push_back({50.0 + 40.0 * glm::dvec2(std::cos(i * 0.0698131700798), std::sin(i * 0.0698131700798)), 2.0});
  const Wobble wobble{1.5, 20.0, 7};
  const auto swayed = wobbling(ring, true, wobble, 3), again = wobbling(ring, true, wobble, 3),
             other = wobbling(ring, true, {1.5, 20.0, 8}, 3);
  double most = 0.0, sum = 0.0, differ = 0.0;
  ASSERT_EQ(swayed.size(), other.size());
  for (size_t i = 0; i < swayed.size(); ++i) {
    const double off = std::abs(glm::length(swayed[i].px - glm::dvec2(50.0)) - 40.0);
    most = std::max(most, off);
    sum += off;
    EXPECT_EQ(swayed[i].px, again[i].px);
    differ = std::max(differ, glm::distance(swayed[i].px, other[i].px));
  }
  EXPECT_LE(most, 1.5 + 0.06);  // the polygon's own distance from its circle
  EXPECT_GT(sum / static_cast<double>(swayed.size()), 0.15);
  EXPECT_GT(differ, 0.5);
  // No step where the ring closes.
  EXPECT_LT(glm::distance(swayed.front().px, swayed.back().px), 4.0);
  EXPECT_EQ(wobbling({}, false, wobble, 1).size(), 0u);
}

}  // namespace
}  // namespace limn::test
