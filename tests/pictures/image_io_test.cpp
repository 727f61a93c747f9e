// Pictures in files: the layers that the EXR promises, equal bytes for equal runs, sRGB as the standard has it.

#include <OpenImageIO/imageio.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "raymarch/image_io.h"
#include "sdf/version.h"
#include "tests/raymarch/scenes.h"
#include "tests/temporary_folder.h"

namespace limn::test {
namespace {

namespace fs = std::filesystem;

class ImageFiles : public testing::Test {
 protected:
  fs::path file(const std::string& name) const { return folder_.path() / name; }
  TemporaryFolder folder_;
};

std::string bytes_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

struct Drawn {
  Picture picture;
  Camera camera;
};

Drawn draw() {
  SceneObject ellipsoid = object_of(make_shape("ellipsoid"));
  ellipsoid.material = 5;
  const Scene scene = scene_of({ellipsoid});
  const Camera camera = framing(scene, view(40, 24));
  return {draw_picture(scene, model_of(scene), camera, {{call_of("rim")}, 1, {}}, {}), camera};
}

TEST_F(ImageFiles, TheExrHoldsEveryLayerUnderItsName) {
  const Drawn drawn = draw();
  const GBuffer& seen = drawn.picture.gbuffer;
  write_exr(drawn.picture, drawn.camera, "limn render egg", file("a.exr"));
  std::vector<std::string> names = channel_names(file("a.exr"));
  std::sort(names.begin(), names.end());
  std::vector<std::string> expected = {"R",   "G",   "B",   "A",       "Z",        "P.X",  "P.Y",        "P.Z",
                                       "N.X", "N.Y", "N.Z", "NdotV.Y", "border.Y", "id.Y", "material.Y", "status.Y"};
  std::sort(expected.begin(), expected.end());
  EXPECT_EQ(names, expected);
  EXPECT_EQ(read_channel(file("a.exr"), "Z").pixels, seen.depth.pixels);
  EXPECT_EQ(read_channel(file("a.exr"), "NdotV.Y").pixels, seen.n_dot_v.pixels);
  EXPECT_EQ(read_channel(file("a.exr"), "border.Y").pixels, drawn.picture.border.pixels);
  const Image<float> x = read_channel(file("a.exr"), "P.X"), y = read_channel(file("a.exr"), "N.Y"),
                     id = read_channel(file("a.exr"), "id.Y");
  const Image<float> material = read_channel(file("a.exr"), "material.Y"), status = read_channel(file("a.exr"), "status.Y");
  const Image<float> red = read_channel(file("a.exr"), "R"), alpha = read_channel(file("a.exr"), "A");
  for (size_t i = 0; i < id.size(); ++i) {
    EXPECT_EQ(x.pixels[i], seen.position.pixels[i].x);
    EXPECT_EQ(y.pixels[i], seen.normal.pixels[i].y);
    EXPECT_EQ(id.pixels[i], static_cast<float>(seen.id.pixels[i]));
    EXPECT_EQ(material.pixels[i], seen.id.pixels[i] ? 5.0f : 0.0f);
    EXPECT_EQ(status.pixels[i], static_cast<float>(seen.status.pixels[i]));
    EXPECT_NEAR(red.pixels[i], drawn.picture.composite.pixels[i].r, 1e-3f);
    EXPECT_EQ(alpha.pixels[i], drawn.picture.composite.pixels[i].a);
  }
}

TEST_F(ImageFiles, TheExrsHeaderSaysWhatMadeIt) {
  const Drawn drawn = draw();
  write_exr(drawn.picture, drawn.camera, "limn render egg --size 40x24", file("a.exr"));
  const auto input = OIIO::ImageInput::open(file("a.exr").string());
  ASSERT_TRUE(input);
  const OIIO::ImageSpec& spec = input->spec();
  EXPECT_EQ(spec.get_string_attribute("limn:version"), kVersion);
  EXPECT_EQ(spec.get_string_attribute("limn:call"), "limn render egg --size 40x24");
  EXPECT_EQ(spec.get_string_attribute("Software"), std::string("limn ") + kVersion);
  EXPECT_EQ(spec.get_string_attribute("DateTime"), "1970:01:01 00:00:00");
  // Names in the file itself, which other readers look for.
  const std::string bytes = bytes_of(file("a.exr"));
  EXPECT_NE(bytes.find(std::string("worldToCamera\0m44f", 18)), std::string::npos);
  EXPECT_NE(bytes.find(std::string("worldToNDC\0m44f", 15)), std::string::npos);
  // Row vectors: a world point times the matrix is the camera point.
  const OIIO::ParamValue* matrix = spec.find_attribute("worldToCamera", OIIO::TypeMatrix);
  if (!matrix) matrix = spec.find_attribute("worldtocamera", OIIO::TypeMatrix);
  ASSERT_NE(matrix, nullptr);
  float m[16];
  std::memcpy(m, matrix->data(), sizeof m);
  const glm::dvec3 world(0.3, -0.2, 0.1);
  for (int column = 0; column < 3; ++column) {
    const double value = world.x * m[column] + world.y * m[4 + column] + world.z * m[8 + column] + m[12 + column];
    const double expected = glm::dot(world - drawn.camera.eye, drawn.camera.world_from_camera[column]);
    EXPECT_NEAR(value, expected, 1e-5);
  }
  for (int i = 0; i < spec.nchannels; ++i) {
    const std::string& name = spec.channelnames[static_cast<size_t>(i)];
    const bool full = name == "Z" || name.starts_with("P.") || name.starts_with("N.") || name.starts_with("NdotV");
    EXPECT_EQ(spec.channelformat(i), full ? OIIO::TypeFloat : OIIO::TypeHalf) << name;
  }
}

TEST_F(ImageFiles, EqualRunsGiveEqualBytes) {
  for (const std::string extension : {".exr", ".png", ".tif", ".jpg"}) {
    const Drawn first = draw(), second = draw();
    for (const auto& [name, drawn] : {std::pair{"a", &first}, std::pair{"b", &second}}) {
      if (extension == ".exr") {
        write_exr(drawn->picture, drawn->camera, "call", file(name + extension));
      } else {
        write_image(drawn->picture.composite, file(name + extension));
      }
    }
    EXPECT_FALSE(bytes_of(file("a" + extension)).empty());
    EXPECT_EQ(bytes_of(file("a" + extension)), bytes_of(file("b" + extension))) << extension;
  }
}

TEST_F(ImageFiles, IdsBeyondHalfAreWhole) {
  Drawn drawn = draw();
  drawn.picture.gbuffer.id.at(20, 12) = 70001;
  drawn.picture.gbuffer.material.at(20, 12) = 4097;
  write_exr(drawn.picture, drawn.camera, "", file("a.exr"));
  EXPECT_EQ(read_channel(file("a.exr"), "id.Y").at(20, 12), 70001.0f);
  EXPECT_EQ(read_channel(file("a.exr"), "material.Y").at(20, 12), 4097.0f);
  EXPECT_EQ(read_channel(file("a.exr"), "id.Y").at(0, 0), 0.0f);
}

TEST(Srgb, HasTheStandardsKnownValues) {
  // IEC 61966-2-1: 0.5 linear is 188 of 255, 0.2140 is 127.5, the straight part ends at 0.0031308.
  EXPECT_NEAR(srgb_from_linear(0.5f) * 255.0f, 187.516f, 0.01f);
  EXPECT_NEAR(srgb_from_linear(0.21404114f), 0.5f, 1e-6f);
  EXPECT_NEAR(srgb_from_linear(0.001f), 0.01292f, 1e-7f);
  EXPECT_EQ(srgb_from_linear(0.0f), 0.0f);
  EXPECT_NEAR(srgb_from_linear(1.0f), 1.0f, 1e-6f);
  for (int i = 0; i <= 255; ++i) {
    const float code = static_cast<float>(i) / 255.0f;
    EXPECT_NEAR(srgb_from_linear(linear_from_srgb(code)), code, 1e-6f);
  }
}

TEST_F(ImageFiles, PngAndTiffKeepEveryCodeAndAreNotPremultiplied) {
  Image<glm::vec4> picture(256, 2);
  for (int i = 0; i < 256; ++i) {
    const float linear = linear_from_srgb(static_cast<float>(i) / 255.0f);
    picture.at(i, 0) = glm::vec4(linear, 1.0f - linear, 0.25f, 1.0f);
    picture.at(i, 1) = glm::vec4(glm::vec3(linear, 0.0f, 1.0f) * 0.4f, 0.4f);
  }
  for (const std::string name : {"a.png", "a.tif"}) {
    write_image(picture, file(name));
    const auto input = OIIO::ImageInput::open(file(name).string(), nullptr);
    ASSERT_TRUE(input) << name;
    EXPECT_EQ(input->spec().format, OIIO::TypeUInt8);
    OIIO::ImageSpec keep;
    keep.attribute("oiio:UnassociatedAlpha", 1);  // the codes as they are in the file
    const auto raw = OIIO::ImageInput::open(file(name).string(), &keep);
    std::vector<std::uint8_t> codes(256 * 2 * 4);
    ASSERT_TRUE(raw->read_image(0, 0, 0, 4, OIIO::TypeUInt8, codes.data()));
    for (size_t i = 0; i < 256; ++i) {
      EXPECT_EQ(codes[4 * i], i) << name;
      EXPECT_EQ(codes[4 * i + 3], 255) << name;
      EXPECT_EQ(codes[4 * (256 + i)], i) << name << ": colour of a translucent pixel";
      EXPECT_EQ(codes[4 * (256 + i) + 2], 255) << name;
      EXPECT_EQ(codes[4 * (256 + i) + 3], 102) << name;
    }
  }
}

TEST_F(ImageFiles, AJpegLiesOnWhite) {
  write_image(Image<glm::vec4>(16, 16, glm::vec4(0.0f)), file("a.jpg"));
  EXPECT_GT(read_channel(file("a.jpg"), "G").at(8, 8), 0.99f);
  EXPECT_EQ(channel_names(file("a.jpg")).size(), 3u);
}

TEST_F(ImageFiles, ThePngInMemoryIsThePngInTheFile) {
  const Drawn drawn = draw();
  write_image(drawn.picture.composite, file("a.png"));
  const std::vector<std::byte> memory = encode_png(drawn.picture.composite);
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(memory.data()), memory.size()), bytes_of(file("a.png")));
}

TEST_F(ImageFiles, ThePngOfCodesIsThatOfTheLightTheyStandFor) {
  Image<glm::u8vec4> codes(256, 2);
  Image<glm::vec4> light(256, 2);
  for (int i = 0; i < 512; ++i) {
    const auto alpha = static_cast<std::uint8_t>(i < 256 ? 255 : 1 + (i - 256) / 2);
    const glm::u8vec4 code(i % 256, 255 - i % 256, 7 * i % 256, alpha);
    const glm::vec4 share = glm::vec4(code) / 255.0f;
    codes.pixels[static_cast<size_t>(i)] = code;
    light.pixels[static_cast<size_t>(i)] =
        glm::vec4(share.a * glm::vec3(linear_from_srgb(share.r), linear_from_srgb(share.g), linear_from_srgb(share.b)), share.a);
  }
  EXPECT_EQ(encode_png(codes), encode_png(light));
}

TEST_F(ImageFiles, FaultsSayWhatWouldBeRight) {
  const Drawn drawn = draw();
  try {
    write_image(drawn.picture.composite, file("a.pgn"));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("did you mean '.png'"), std::string::npos) << error.what();
  }
  EXPECT_THROW(write_image(drawn.picture.composite, file("a.exr")), InputError);
  EXPECT_THROW(write_exr(drawn.picture, drawn.camera, "", file("a.png")), InputError);
  EXPECT_THROW(read_channel(file("missing.exr"), "Z"), InputError);
  std::ofstream(file("text.exr")) << "not an image";
  EXPECT_THROW(read_channel(file("text.exr"), "Z"), InputError);
  write_exr(drawn.picture, drawn.camera, "", file("b.exr"));
  EXPECT_THROW(read_channel(file("b.exr"), "Q"), InputError);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()), 2) << "something was left behind";
}

}  // namespace
}  // namespace limn::test
