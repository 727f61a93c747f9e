#include "raymarch/files/png_file.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <bit>
#include <fstream>
#include <limits>
#include <random>

#include "raymarch/picture/pixel_lanes.h"
#include "raymarch/picture/srgb_bytes.h"
#include "sdf/color.h"
#include "tests/random_seed.h"
#include "tests/simd_targets.h"
#include "tests/temporary_folder.h"

namespace limn::test {
namespace {

/// Rows that are flat, shaded, alike, noise, by turns: every filter is the best somewhere.
std::vector<std::uint8_t> some_pixels(int width, int height, int channels, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<std::uint8_t> pixels;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < channels; ++c) {
        const int kinds[] = {90, x * 2 + c, (y / 7 * 31 + x * x) & 255, static_cast<int>(random() & 255)};
        pixels.push_back(static_cast<std::uint8_t>(kinds[y / 5 % 4]));
      }
  return pixels;
}

TEST(PngFile, OpenImageIoReadsThePixelsThatWereWritten) {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "a.png").string();
  const unsigned seed = random_seed();
  const int sizes[][2] = {{1, 1}, {1, 400}, {70000, 3}, {641, 479}};  // one row more than a block, many blocks
  for (const auto [width, height] : sizes)
    for (const int channels : {3, 4}) {
      const std::vector<std::uint8_t> pixels = some_pixels(width, height, channels, seed);
      const std::vector<std::byte> bytes = png_file({width, height, channels, pixels, "limn 1"});
      std::ofstream(file, std::ios::binary).write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
      OIIO::ImageSpec as_it_is;
      as_it_is.attribute("oiio:UnassociatedAlpha", 1);
      const auto input = OIIO::ImageInput::open(file, &as_it_is);
      ASSERT_TRUE(input) << OIIO::geterror();
      EXPECT_EQ(input->spec().width, width);
      EXPECT_EQ(input->spec().height, height);
      ASSERT_EQ(input->spec().nchannels, channels);
      EXPECT_EQ(input->spec().get_string_attribute("Software"), "limn 1");
      EXPECT_EQ(input->spec().get_string_attribute("oiio:ColorSpace"), "sRGB");
      std::vector<std::uint8_t> read(pixels.size());
      ASSERT_TRUE(input->read_image(0, 0, 0, channels, OIIO::TypeDesc::UINT8, read.data())) << input->geterror();
      EXPECT_EQ(read, pixels) << width << " x " << height << " x " << channels;
    }
}

TEST(PngFile, AnyNumberOfThreadsGivesTheSameBytes) {
  const std::vector<std::uint8_t> pixels = some_pixels(900, 700, 4, 3);
  std::vector<std::vector<std::byte>> files;
  for (const int threads : {1, 2, 5}) {
    tbb::task_arena arena(threads);
    arena.execute([&] { files.push_back(png_file({900, 700, 4, pixels, "limn"})); });
  }
  EXPECT_EQ(files[0], files[1]);
  EXPECT_EQ(files[0], files[2]);
}

TEST(PngFile, FlatPicturesTakeLittleRoom) {
  const std::vector<std::uint8_t> pixels(size_t{1920} * 1080 * 4, 200);
  EXPECT_LT(png_file({1920, 1080, 4, pixels, "limn"}).size(), pixels.size() / 200);
}

TEST(SrgbBytes, AreThoseOfTheFormula) {
  const SrgbBytes srgb_byte;
  const auto expect_same = [&](float linear) {
    const float clamped = linear > 0.0f ? std::min(linear, 1.0f) : 0.0f;
    ASSERT_EQ(srgb_byte(linear), to_byte(srgb_from_linear(clamped))) << linear;
  };
  // Where codes change: a hundred floats to both sides of each place.
  for (int code = 1; code < 256; ++code) {
    const auto middle = std::bit_cast<std::int32_t>(linear_from_srgb((static_cast<float>(code) - 0.5f) / 255.0f));
    for (std::int32_t k = -100; k <= 100; ++k) expect_same(std::bit_cast<float>(middle + k));
  }
  const unsigned seed = random_seed();
  std::mt19937 random(seed);
  for (int i = 0; i < 300000; ++i) expect_same(std::bit_cast<float>(static_cast<std::uint32_t>(random() % 0x3f900000u)));
  for (const float odd : {0.0f, -0.0f, -1.0f, 1.0f, 2.0f, std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
                          std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::denorm_min()})
    expect_same(odd);
}

TEST(SrgbBytes, OfManyPixelsAreThoseOfEachByItself) {
  std::mt19937 random(random_seed());
  const auto number = [&] { return std::uniform_real_distribution<float>(-0.1f, 1.2f)(random); };
  const std::vector<float> odd = {0.0f,
                                  -0.0f,
                                  1.0f,
                                  0x1p-13f,
                                  std::numeric_limits<float>::quiet_NaN(),
                                  std::numeric_limits<float>::infinity(),
                                  -std::numeric_limits<float>::infinity(),
                                  std::numeric_limits<float>::denorm_min(),
                                  0.5f / 255.0f};
  const auto any = [&] { return random() % 4 == 0 ? odd[random() % odd.size()] : number(); };
  for_each_simd_target([&](const char* target) {
    std::vector<glm::vec4> colors(20003);
    for (glm::vec4& color : colors)
      color = random() % 3 == 0 ? glm::vec4(number(), number(), number(), 1.0f) : glm::vec4(any(), any(), any(), any());
    // Alphas halfway between two codes.
    for (int code = 0; code < 255; ++code) colors[static_cast<size_t>(code)].a = (static_cast<float>(code) + 0.5f) / 255.0f;
    // Stretches of one colour, as a background has, of any length and anywhere; one that differs in a channel alone ends it.
    for (int k = 0; k < 200; ++k) {
      const size_t first = 255 + random() % (colors.size() - 400), length = random() % 100;
      std::fill_n(colors.begin() + static_cast<std::ptrdiff_t>(first), length, colors[first]);
      colors[first + length] = colors[first];
      colors[first + length][static_cast<int>(random() % 4)] = number();
    }
    std::vector<glm::u8vec4> bytes(colors.size());
    encode_pixels(colors, bytes);
    for (size_t i = 0; i < colors.size(); ++i) {
      const glm::vec4& color = colors[i];
      const glm::vec3 apart = color.a > 0.0f ? glm::vec3(color) / color.a : glm::vec3(color);
      for (int channel = 0; channel < 3; ++channel)
        ASSERT_EQ(bytes[i][channel], srgb_bytes()(apart[channel])) << apart[channel] << ", " << target;
      ASSERT_EQ(bytes[i].a, to_byte(color.a)) << color.a << ", " << target;
    }
  });
}

}  // namespace
}  // namespace limn::test
