// EXR files, read by OpenImageIO.

#include "raymarch/files/exr_file.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <bit>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>

#include "sdf/error.h"
#include "tests/random_seed.h"
#include "tests/temporary_folder.h"

namespace limn::test {
namespace {

namespace fs = std::filesystem;

std::function<void(size_t, size_t, float*)> reading(const std::vector<float>& values) {
  return [&values](size_t first, size_t last, float* to) {
    std::copy(values.begin() + static_cast<std::ptrdiff_t>(first), values.begin() + static_cast<std::ptrdiff_t>(last), to);
  };
}

std::unique_ptr<OIIO::ImageInput> opened(const fs::path& file) {
  auto input = OIIO::ImageInput::open(file.string());
  EXPECT_TRUE(input) << OIIO::geterror();
  return input;
}

/// In the channel's own type.
template <class T>
std::vector<T> channel_of(OIIO::ImageInput& input, const std::string& name, OIIO::TypeDesc type) {
  const OIIO::ImageSpec& spec = input.spec();
  const int channel = spec.channelindex(name);
  EXPECT_GE(channel, 0) << name;
  EXPECT_EQ(spec.channelformat(channel), type) << name;
  std::vector<T> values(static_cast<size_t>(spec.width) * static_cast<size_t>(spec.height));
  EXPECT_TRUE(input.read_image(0, 0, channel, channel + 1, type, values.data())) << input.geterror();
  return values;
}

double value_of_half(std::uint16_t half) {
  const int exponent = half >> 10 & 31, mantissa = half & 1023;
  const double size = exponent == 0 ? std::ldexp(mantissa, -24) : std::ldexp(1024 + mantissa, exponent - 25);
  return half >> 15 != 0 ? -size : size;
}

TEST(ExrFile, HoldsEveryValueOfEveryType) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "a.exr";
  std::mt19937 random(random_seed());
  const int sizes[][2] = {{1, 1}, {3, 16}, {5, 17}, {301, 40}, {33, 1040}};  // rows of one chunk, of two, of more than are kept together
  for (const auto [width, height] : sizes) {
    std::vector<float> bits, wholes, flat;  // noise that is stored as it is, among what can be compressed
    for (int i = 0; i < width * height; ++i) {
      const auto number = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
      bits.push_back(std::isnan(number) ? 1.0f : number);
      wholes.push_back(static_cast<float>(random() % (1u << 24)));
      flat.push_back(static_cast<float>(i / 100));
    }
    write_exr_file(file, "a.exr",
                   {width,
                    height,
                    {},
                    {{"flat", ExrType::half, reading(flat)}, {"b", ExrType::full, reading(bits)}, {"W", ExrType::whole, reading(wholes)}}});
    const auto input = opened(file);
    ASSERT_TRUE(input);
    EXPECT_EQ(input->spec().width, width);
    EXPECT_EQ(input->spec().height, height);
    EXPECT_EQ(channel_of<float>(*input, "b", OIIO::TypeFloat), bits) << width << " x " << height;
    const auto numbers = channel_of<std::uint32_t>(*input, "W", OIIO::TypeUInt32);
    EXPECT_TRUE(std::equal(numbers.begin(), numbers.end(), wholes.begin())) << width << " x " << height;
    const auto halves = channel_of<std::uint16_t>(*input, "flat", OIIO::TypeHalf);
    for (size_t i = 0; i < halves.size(); ++i) ASSERT_EQ(value_of_half(halves[i]), flat[i]);
  }
}

TEST(ExrFile, HalvesAreTheNearest) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "a.exr";
  std::mt19937 random(random_seed());
  std::vector<float> values;
  for (int i = 0; i < 60000; ++i)  // all that halves hold, and far less
    values.push_back(static_cast<float>(std::ldexp(1.0 + static_cast<double>(random()) * 0x1p-32, static_cast<int>(random() % 44) - 28)));
  for (float& value : values) value = random() % 2 == 0 ? value : -value;
  write_exr_file(file, "a.exr", {200, 300, {}, {{"h", ExrType::half, reading(values)}}});
  const auto input = opened(file);
  ASSERT_TRUE(input);
  const auto halves = channel_of<std::uint16_t>(*input, "h", OIIO::TypeHalf);
  constexpr double kMost = 65504.0;
  for (size_t i = 0; i < values.size(); ++i) {
    const double wanted = values[i];
    if (std::abs(wanted) > kMost) continue;  // becomes infinite
    const double error = std::abs(value_of_half(halves[i]) - wanted);
    const auto size = static_cast<std::uint16_t>(halves[i] & 0x7fff), sign = static_cast<std::uint16_t>(halves[i] & 0x8000);
    ASSERT_LE(error, std::abs(value_of_half(static_cast<std::uint16_t>(sign | (size + 1))) - wanted)) << wanted;
    if (size > 0) {
      ASSERT_LE(error, std::abs(value_of_half(static_cast<std::uint16_t>(sign | (size - 1))) - wanted)) << wanted;
    }
  }
}

TEST(ExrFile, HasTheHeaderThatItIsGiven) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "a.exr";
  const std::vector<float> values(12, 1.0f);
  const std::string long_name(200, 'n'), text(100000, 't');
  std::array<float, 16> matrix{};
  for (size_t i = 0; i < matrix.size(); ++i) matrix[i] = static_cast<float>(i);
  write_exr_file(
      file, "a.exr",
      {4, 3, {{"limn:call", text}, {"worldToCamera", matrix}, {"Software", "limn 1"}}, {{long_name, ExrType::half, reading(values)}}});
  const auto input = opened(file);
  ASSERT_TRUE(input);
  const OIIO::ImageSpec& spec = input->spec();
  EXPECT_EQ(spec.get_string_attribute("limn:call"), text);
  EXPECT_EQ(spec.get_string_attribute("Software"), "limn 1");
  EXPECT_EQ(spec.get_string_attribute("compression"), "zip");
  EXPECT_EQ(spec.channelnames, std::vector<std::string>{long_name});
  const OIIO::ParamValue* const read = spec.find_attribute("worldToCamera", OIIO::TypeMatrix);
  ASSERT_NE(read, nullptr);
  EXPECT_TRUE(std::equal(matrix.begin(), matrix.end(), static_cast<const float*>(read->data())));
}

TEST(ExrFile, AnyNumberOfThreadsGivesTheSameBytes) {
  const TemporaryFolder folder;
  std::mt19937 random(random_seed());
  std::vector<float> values(300 * 900);
  for (float& value : values) value = static_cast<float>(random() % 1000) * 0.01f;
  std::vector<std::string> files;
  for (const int threads : {1, 2, 5}) {
    const fs::path file = folder.path() / (std::to_string(threads) + ".exr");
    tbb::task_arena arena(threads);
    arena.execute([&] { write_exr_file(file, "a.exr", {300, 900, {}, {{"v", ExrType::full, reading(values)}}}); });
    std::ifstream in(file, std::ios::binary);
    files.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  }
  EXPECT_GT(files[0].size(), 1000u);
  EXPECT_EQ(files[0], files[1]);
  EXPECT_EQ(files[0], files[2]);
}

TEST(ExrFile, SaysWhyAFileCannotBeWritten) {
  const TemporaryFolder folder;
  const std::vector<float> values(12, 1.0f);
  const ExrPicture picture{4, 3, {}, {{"v", ExrType::full, reading(values)}}};
  try {
    write_exr_file(folder.path() / "missing" / "a.exr", "picture.exr", picture);
    FAIL();
  } catch (const MachineError& error) {
    EXPECT_NE(std::string(error.what()).find("cannot write picture.exr: "), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("No such file"), std::string::npos) << error.what();
  }
  // A disk without room.
  if (fs::exists("/dev/full")) {
    EXPECT_THROW(write_exr_file("/dev/full", "picture.exr", picture), MachineError);
  }
}

}  // namespace
}  // namespace limn::test
