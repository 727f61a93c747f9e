// Cryptomatte: hashes against published values, coverage against the picture's alpha, layers as the specification names them.

#include "raymarch/mattes.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "raymarch/files/matte_layers.h"
#include "tests/raymarch/scenes.h"

namespace limn::test {
namespace {

TEST(Mattes, HashIsMurmurHash3AndItsFloatIsFinite) {
  EXPECT_EQ(matte_hash("test"), 0xba6bd213u);
  EXPECT_EQ(matte_hash("Hello, world!"), 0xc0363e43u);
  EXPECT_EQ(matte_hash("The quick brown fox jumps over the lazy dog"), 0x2e4ff723u);
  EXPECT_EQ(matte_hash(""), 1u << 23);  // 0, moved off its exponent
  for (int i = 0; i < 20'000; ++i) EXPECT_TRUE(std::isnormal(matte_id(matte_hash("object " + std::to_string(i)))));
}

Picture two_balls(int samples) {
  const Field sphere = make_shape("sphere", {});
  Scene scene =
      scene_of({object_of(translate(sphere, {-0.6, 0.0, 0.0}), "left"), object_of(translate(sphere, {0.6, 0.0, -0.5}), "right \"one\"")});
  scene.objects[1].material = 4;
  PictureSettings settings;
  settings.samples = samples;
  settings.mattes = true;
  return draw_picture(scene, model_of(scene), framing(scene, view(120, 90)), settings, {});
}

TEST(Mattes, CoverageIsThatOfThePicture) {
  constexpr int kSamples = 16;
  const Picture picture = two_balls(kSamples);
  ASSERT_NE(picture.mattes, nullptr);
  const std::uint32_t left = matte_hash("left"), right = matte_hash("right \"one\"");
  bool shared = false;
  for (size_t i = 0; i < picture.composite.size(); ++i) {
    float sum = 0.0f, before = 1.0f;
    for (size_t rank = i * kMatteRanks; rank < (i + 1) * kMatteRanks; ++rank) {
      const float coverage = static_cast<float>(picture.mattes->objects.counts[rank]) / kSamples;
      const std::uint16_t index = picture.mattes->objects.indices[rank];
      const std::uint32_t id = index == 0 ? 0u : picture.mattes->objects.names[index - 1u].hash;
      EXPECT_LE(coverage, before);
      EXPECT_EQ(coverage > 0.0f, id != 0u);
      if (coverage > 0.0f) {
        EXPECT_TRUE(id == left || id == right);
      }
      before = coverage;
      sum += coverage;
    }
    EXPECT_NEAR(sum, picture.composite.pixels[i].a, 1e-5f);
    // Both balls have one colour.
    EXPECT_LT(glm::length(picture.mattes->albedo.pixels[i] - sum * glm::vec3(0.8f, 0.5f, 0.3f)), 1e-5f);
    shared |= picture.mattes->objects.counts[i * kMatteRanks + 1] > 0;
  }
  EXPECT_TRUE(shared);
}

TEST(Mattes, LayersAreThoseOfTheSpecification) {
  const Picture picture = two_balls(8);
  const std::vector<MatteLayer> layers = matte_layers(*picture.mattes);
  ASSERT_EQ(layers.size(), 2u);
  const MatteLayer& objects = layers[0];
  ASSERT_EQ(objects.channels.size(), 4u);
  const char* const names[] = {"CryptoObject00.R", "CryptoObject00.G", "CryptoObject00.B", "CryptoObject00.A"};
  for (size_t i = 0; i < 4; ++i) EXPECT_EQ(objects.channels[i].first, names[i]);
  std::string key = "cryptomatte/0000000/";
  std::snprintf(key.data(), key.size() + 1, "cryptomatte/%07x/", matte_hash("CryptoObject") >> 4);
  ASSERT_EQ(objects.header.size(), 4u);
  EXPECT_EQ(objects.header[0], (std::pair<std::string, std::string>(key + "name", "CryptoObject")));
  EXPECT_EQ(objects.header[1].second, "MurmurHash3_32");
  EXPECT_EQ(objects.header[2].second, "uint32_to_float32");
  char manifest[200];
  std::snprintf(manifest, sizeof manifest, "{\"left\":\"%08x\",\"right \\\"one\\\"\":\"%08x\"}", matte_hash("left"),
                matte_hash("right \"one\""));
  EXPECT_EQ(objects.header[3], (std::pair<std::string, std::string>(key + "manifest", manifest)));
  EXPECT_NE(layers[1].header[3].second.find("\"material 4\""), std::string::npos);
}

}  // namespace
}  // namespace limn::test
