// The blur against direct convolution, and what every image method owes every picture.

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "raymarch/border/blur_passes.h"
#include "raymarch/scene/threads.h"
#include "tests/raymarch/image_buffers.h"

namespace limn {
namespace {

using test::drawn;
using test::value;
using test::word;

Image<float> random_plane(unsigned seed, int width, int height) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  Image<float> plane(width, height);
  for (float& pixel : plane.pixels) pixel = uniform(random);
  return plane;
}

/// The definition: a sum over the window, the picture's border pixels repeated beyond it.
double direct_blur(const Image<float>& source, const std::vector<float>& taps, int radius, int x, int y) {
  double sum = 0.0;
  for (int v = -radius; v <= radius; ++v) {
    for (int u = -radius; u <= radius; ++u) {
      const float pixel = source.at(std::clamp(x + u, 0, source.width - 1), std::clamp(y + v, 0, source.height - 1));
      sum += double{taps[size_t(u + radius)]} * double{taps[size_t(v + radius)]} * double{pixel};
    }
  }
  return sum;
}

RC_GTEST_PROP(BorderImage, BlurInTwoPassesEqualsTheDirectConvolutionEverywhere, ()) {
  const auto seed = *rc::gen::arbitrary<unsigned>();
  const int width = *rc::gen::inRange(1, 40), height = *rc::gen::inRange(1, 40), radius = *rc::gen::inRange(1, 9);
  RC_LOG() << "seed " << seed << "\n";
  const Image<float> source = random_plane(seed, width, height);
  for (const BlurKernel kernel : {BlurKernel::box, BlurKernel::gaussian}) {
    const std::vector<float> taps = blur_taps(kernel, radius);
    const Image<float> blurred = blur_separable(source, kernel, radius);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) RC_ASSERT(std::abs(double{blurred.at(x, y)} - direct_blur(source, taps, radius, x, y)) < 2e-6);
    }
  }
}

TEST(BorderImage, BoxBlurEqualsTheDefinitionAtTheBorderOfTheImage) {
  Image<float> source(5, 4, 0.0f);
  source.at(0, 0) = 1.0f;
  const Image<float> blurred = blur_separable(source, BlurKernel::box, 1);
  // The corner pixel is repeated outwards, so its own window holds it four times.
  EXPECT_NEAR(blurred.at(0, 0), 4.0 / 9.0, 1e-7);
  EXPECT_NEAR(blurred.at(1, 0), 2.0 / 9.0, 1e-7);
  EXPECT_NEAR(blurred.at(1, 1), 1.0 / 9.0, 1e-7);
  EXPECT_EQ(blurred.at(2, 0), 0.0f);
}

TEST(BorderImage, GaussianTapsSumToOneAndFallOff) {
  for (const int radius : {1, 8, 100}) {
    const std::vector<float> taps = blur_taps(BlurKernel::gaussian, radius);
    double sum = 0.0;
    for (const float tap : taps) sum += double{tap};
    EXPECT_NEAR(sum, 1.0, 1e-6);
    EXPECT_NEAR(double{taps.front()} / double{taps[size_t(radius)]}, std::exp(-4.5), 1e-6);
  }
}

TEST(BorderImage, ReducingAveragesBlocksAndEnlargingKeepsARamp) {
  Image<float> ramp(13, 7);
  for (int y = 0; y < 7; ++y) {
    for (int x = 0; x < 13; ++x) ramp.at(x, y) = static_cast<float>(x + 10 * y);
  }
  const Image<float> small = reduced(ramp, 4);
  ASSERT_EQ(small.width, 4);
  ASSERT_EQ(small.height, 2);
  EXPECT_EQ(small.at(0, 0), 1.5f + 15.0f);
  EXPECT_EQ(small.at(3, 1), 12.0f + 50.0f);  // what there is of the last block
  const Image<float> large = enlarged(small, 4, 13, 7);
  EXPECT_NEAR(large.at(5, 3), small.at(1, 0) - 0.125f * 4.0f + (3.5f / 4.0f - 0.5f) * 35.0f, 1e-4);
}

TEST(BorderImage, BlurKeepsToTheStencilAndTakesTheObjectsColours) {
  const Camera camera = test::straight_camera(60, 20, Projection::orthographic, 10.0);
  GBuffer seen = test::mask_buffer(camera, [](int x, int y) { return y >= 6 && y < 14 && ((x >= 10 && x < 20) || (x >= 40 && x < 50)); });
  for (int y = 0; y < 20; ++y) {
    for (int x = 40; x < 50; ++x) seen.id.at(x, y) = seen.id.at(x, y) ? 2 : 0;
  }
  const Border outside = drawn("blur", seen, camera, {{"colors", word("objects")}});
  const Border over = drawn("blur", seen, camera, {{"place", word("over")}});
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 60; ++x) {
      if (seen.id.at(x, y) != 0) {
        EXPECT_EQ(outside.coverage.at(x, y), 0.0f);
      }
    }
  }
  EXPECT_GT(over.coverage.at(10, 10), 0.5f);
  EXPECT_GT(outside.coverage.at(9, 10), 0.5f);
  EXPECT_NEAR(glm::length(outside.colors.at(8, 10) - glm::vec3(0.8f, 0.5f, 0.3f)), 0.0f, 1e-4);
  EXPECT_NEAR(glm::length(outside.colors.at(51, 10) - glm::vec3(0.2f, 0.4f, 0.9f)), 0.0f, 1e-4);
  EXPECT_EQ(outside.coverage.at(30, 10), 0.0f);
}

/// Every choice of a method once, everything else at its default; and its numbers at both ends of their ranges.
std::vector<std::map<std::string, ParameterInput>> settings_of(const BorderMethod& method) {
  std::vector<std::map<std::string, ParameterInput>> all{{}};
  for (const Parameter& parameter : method.parameters) {
    for (const std::string& choice : parameter.choices) all.push_back({{parameter.name, word(choice)}});
    if (parameter.kind != ParameterKind::number && parameter.kind != ParameterKind::integer) continue;
    for (const double end : {parameter.min, std::min(parameter.max, 200.0)}) all.push_back({{parameter.name, value(end)}});
  }
  return all;
}

void expect_ink(const Border& border, int width, int height, const std::string& what) {
  ASSERT_EQ(border.coverage.width, width) << what;
  ASSERT_EQ(border.coverage.height, height) << what;
  for (const float ink : border.coverage.pixels) ASSERT_TRUE(ink >= 0.0f && ink <= 1.0f) << what << ": " << ink;
  for (const glm::vec3& color : border.colors.pixels) {
    for (int k = 0; k < 3; ++k) ASSERT_TRUE(color[k] >= 0.0f && color[k] <= 1.0f) << what;
  }
}

TEST(BorderImage, InkIsFiniteAndBetweenZeroAndOneForEverySettingOnEverySize) {
  for (const glm::ivec2 size : {glm::ivec2(1, 1), {1, 33}, {33, 1}, {2, 2}, {40, 27}}) {
    for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
      const Camera camera = test::straight_camera(size.x, size.y, projection, 30.0);
      std::mt19937 random(7);
      std::bernoulli_distribution hits(0.6);
      std::map<std::string, GBuffer> pictures{{"nothing", test::nothing_hit(size.x, size.y)},
                                              {"everything", test::plane_buffer(camera, {0.0, 0.0, 1.0}, 5.0)},
                                              {"random", test::mask_buffer(camera, [&](int, int) { return hits(random); })}};
      for (const auto& [name, seen] : pictures) {
        for (const std::string& method : test::image_methods()) {
          for (const auto& given : settings_of(find_border_method(method))) {
            const std::string what = method + " " + name + " " + (given.empty() ? "" : given.begin()->first);
            const Border border = drawn(method, seen, camera, given);
            expect_ink(border, size.x, size.y, what);
            // A debug view or a level of 0 may ink what it likes where there is something; nothing at all has no border.
            if (name == "nothing") {
              EXPECT_EQ(test::area(border.coverage), 0.0) << what;
            }
          }
          if (name == "everything") {
            EXPECT_EQ(test::area(drawn(method, seen, camera).coverage), 0.0) << method;
          }
        }
      }
    }
  }
}

TEST(BorderImage, BytesAreTheSameForOneThreadAndForMany) {
  Scene scene = test::scene_of({test::object_of(make_shape("torus")), test::object_of(make_shape("box"))});
  scene.objects[1].color = glm::vec3(0.2f, 0.3f, 0.8f);
  const Camera camera = test::framing(scene, test::view(150, 101));
  const SceneModel model = test::model_of(scene);
  const GBuffer seen = render_gbuffer(model, camera, {});
  for (const std::string& method : test::image_methods()) {
    for (const auto& given : settings_of(find_border_method(method))) {
      const auto with_threads = [&](int threads) {
        ThreadArena arena(threads);
        return arena.execute([&] {
          return find_border_method(method).draw({seen, camera, model, scene}, test::parameters_of(method, given));
        });
      };
      const Border one = with_threads(1), many = with_threads(4);
      expect_ink(one, 150, 101, method);
      EXPECT_EQ(one.coverage.pixels, many.coverage.pixels) << method;
      EXPECT_EQ(one.colors.pixels, many.colors.pixels) << method;
      EXPECT_EQ(one.notes, many.notes) << method;
      if (given.empty()) {
        EXPECT_GT(test::area(one.coverage), 20.0) << method;
      }
    }
  }
}

/// The layers that `inputs` does not name, otherwise.
GBuffer without_others(const GBuffer& seen, const std::vector<std::string>& inputs) {
  GBuffer out = seen;
  const auto spoil = [&](const std::string& name, auto& layer, auto with) {
    if (std::find(inputs.begin(), inputs.end(), name) != inputs.end()) return;
    for (size_t i = 0; i < layer.size(); i += 3) layer.pixels[i] = with;
  };
  spoil("Z", out.depth, 7.0f);
  spoil("P", out.position, glm::vec3(9.0f));
  spoil("N", out.normal, glm::vec3(1.0f, 0.0f, 0.0f));
  spoil("NdotV", out.n_dot_v, 0.01f);
  spoil("material", out.material, 5);
  spoil("face", out.face, 8);
  return out;
}

TEST(BorderImage, EachMethodReadsNoLayerButThoseItNames) {
  Scene scene = test::scene_of({test::object_of(make_shape("torus")), test::object_of(make_shape("box"))});
  const Camera camera = test::framing(scene, test::view(60, 41));
  const SceneModel model = test::model_of(scene);
  const GBuffer seen = render_gbuffer(model, camera, {});
  for (const std::string& name : test::image_methods()) {
    const BorderMethod& method = find_border_method(name);
    const GBuffer spoiled = without_others(seen, method.inputs);
    for (const auto& given : settings_of(method)) {
      // Where groups meet their order goes by N. blur does not name it: the audit goes by these names, and would warn of bad normals
      // whoever draws a blur without groups.
      if (name == "blur" && given.contains("group")) continue;
      const Parameters parameters = test::parameters_of(name, given);
      EXPECT_TRUE(method.draw({seen, camera, model, scene}, parameters).coverage.pixels ==
                  method.draw({spoiled, camera, model, scene}, parameters).coverage.pixels)
          << name << " " << (given.empty() ? "" : given.begin()->first);
    }
  }
}

TEST(BorderImage, MethodsComposeInOrderEachInItsOwnColours) {
  Scene scene = test::scene_of({test::object_of(make_shape("sphere"))});
  const Camera camera = test::framing(scene, test::view(90, 70));
  const SceneModel model = test::model_of(scene);
  ParameterInput red;
  red.numbers = {1.0, 0.0, 0.0};
  PictureSettings settings;
  settings.methods = {test::call_of("blur", {{"radius", value(12)}, {"colors", word("objects")}, {"strength", value(16)}}),
                      test::call_of("distance", {{"width", value(3)}, {"color", red}})};
  const Picture picture = draw_picture(scene, model, camera, settings, {.threads = 1});
  const Picture parallel = draw_picture(scene, model, camera, settings, {.threads = 3});
  EXPECT_EQ(picture.composite.pixels, parallel.composite.pixels);
  int x = 0;
  while (picture.gbuffer.id.at(x, 35) == 0) ++x;
  const glm::vec4 line = picture.composite.at(x - 2, 35), glow = picture.composite.at(x - 6, 35);
  EXPECT_NEAR(glm::length(line - glm::vec4(1.0f, 0.0f, 0.0f, 1.0f)), 0.0f, 1e-4) << "the last method lies on top";
  ASSERT_GT(glow.a, 0.3f);
  EXPECT_NEAR(glm::length(glm::vec3(glow) / glow.a - glm::vec3(0.8f, 0.5f, 0.3f)), 0.0f, 1e-3) << "the glow has the object's colour";
}

}  // namespace
}  // namespace limn
