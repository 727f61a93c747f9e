// Pictures that nobody vouches for: what the reader says of limn's own is what was drawn; what is damaged is refused; no answer is trusted.
#include "raymarch/files/picture_file.h"

#include <filesystem>
#include <fstream>
#include <iterator>

#include "raymarch/image_io.h"
#include "sdf/error.h"
#include "sdf/guard.h"
#include "sdf/version.h"
#include "tests/raymarch/scenes.h"
#include "tests/temporary_folder.h"

namespace limn::test {
namespace {

namespace fs = std::filesystem;

class PictureFiles : public testing::Test {
 protected:
  void SetUp() override {
    const Scene scene = scene_of({object_of(make_shape("ellipsoid"))});
    camera_ = framing(scene, view(40, 24));
    picture_ = draw_picture(scene, model_of(scene), camera_, {{call_of("rim")}, 1, {}}, {});
  }
  fs::path file(const std::string& name) const { return folder_.path() / name; }
  TemporaryFolder folder_;
  Camera camera_;
  Picture picture_;
};

const PictureChannel* channel_of(const PicturePart& part, const std::string& name) {
  for (const PictureChannel& channel : part.channels) {
    if (channel.name == name) return &channel;
  }
  return nullptr;
}

TEST_F(PictureFiles, SayWhatWasDrawnByWhichCallFromWhere) {
  write_exr(picture_, camera_, "limn render egg", file("a.exr"));
  const PictureFile found = read_picture_file(file("a.exr"));
  EXPECT_EQ(found.format, "openexr");
  EXPECT_EQ(found.version, kVersion);
  EXPECT_EQ(found.call, "limn render egg");
  ASSERT_TRUE(found.camera_from_world.has_value());
  const glm::dmat4 expected = camera_from_world_matrix(camera_);
  for (int i = 0; i < 16; ++i) EXPECT_NEAR((*found.camera_from_world)[i / 4][i % 4], expected[i / 4][i % 4], 1e-6);
  ASSERT_EQ(found.parts.size(), 1u);
  EXPECT_EQ(found.parts[0].width_px, 40);
  EXPECT_EQ(found.parts[0].height_px, 24);
  EXPECT_EQ(found.parts[0].channels.size(), channel_names(file("a.exr")).size());

  const Pixels<float>& depth = picture_.gbuffer.depth.pixels;
  double least = std::numeric_limits<double>::infinity(), most = 0.0;
  std::int64_t missed = 0;
  for (const float z : depth) {
    missed += std::isinf(z) ? 1 : 0;
    if (std::isfinite(z)) least = std::fmin(least, static_cast<double>(z)), most = std::fmax(most, static_cast<double>(z));
  }
  const PictureChannel* z = channel_of(found.parts[0], "Z");
  ASSERT_NE(z, nullptr);
  EXPECT_EQ(z->type, "float");
  EXPECT_EQ(z->least, least);
  EXPECT_EQ(z->most, most);
  EXPECT_EQ(z->infinite, missed);
  EXPECT_GT(missed, 0) << "every ray hit, so infinite depths are not tried";
  EXPECT_EQ(z->nan, 0);
}

TEST_F(PictureFiles, EveryFormatThatIsWrittenIsRead) {
  for (const char* name : {"a.png", "a.tif", "a.jpg"}) {
    write_image(picture_.composite, file(name));
    const PictureFile found = read_picture_file(file(name));
    EXPECT_EQ(found.parts.at(0).width_px, 40) << name;
    EXPECT_EQ(found.parts.at(0).channels.size(), std::string(name) == "a.jpg" ? 3u : 4u) << name;
    EXPECT_EQ(found.software, std::string("limn ") + kVersion) << name;
  }
}

TEST_F(PictureFiles, OneThatBreaksOffIsRefusedByName) {
  write_exr(picture_, camera_, "limn render egg", file("a.exr"));
  std::ifstream in(file("a.exr"), std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  for (const size_t kept : {size_t{0}, size_t{3}, size_t{100}, bytes.size() / 2, bytes.size() - 10}) {
    std::ofstream(file("b.exr"), std::ios::binary) << bytes.substr(0, kept);
    try {
      read_picture_file(file("b.exr"));
      ADD_FAILURE() << kept << " of " << bytes.size() << " bytes were taken";
    } catch (const InputError& error) {
      EXPECT_EQ(error.fault().file, file("b.exr").string());
    }
  }
}

TEST_F(PictureFiles, AreWhatTheirExtensionSaysOrRefused) {
  write_exr(picture_, camera_, "", file("a.exr"));
  fs::copy(file("a.exr"), file("a.png"));
  EXPECT_THROW(read_picture_file(file("a.png")), InputError);
  EXPECT_THROW(read_picture_file(file("none.png")), InputError);
}

PictureFile some_answer() {
  return {"png", {{"one", "zip", 3, 2, {{"R", "half", 0.0, 1.0, 1, 2}, {"Z", "float", 0.0, 1.0, 0, 6}}}}, "s", "v", "c", glm::dmat4(2.0),
          {}};
}

TEST(PictureAnswer, BrokenOffAnywhereIsRefused) {
  ByteWriter writer;
  put_picture(writer, some_answer());
  const std::span<const std::byte> bytes(writer.bytes());
  EXPECT_EQ(picture_from_answer(bytes, "a.png").parts.at(0).channels.at(1).infinite, 6);
  for (size_t kept = 0; kept < bytes.size(); ++kept) EXPECT_THROW(picture_from_answer(bytes.first(kept), "a.png"), InputError) << kept;
}

TEST(PictureAnswer, SizesAndCountsThatCannotBeAreRefusedAndControlCharactersReplaced) {
  const auto taken = [](const std::function<void(PictureFile&)>& change) {
    PictureFile picture = some_answer();
    change(picture);
    ByteWriter writer;
    put_picture(writer, picture);
    return picture_from_answer(writer.bytes(), "a.png");
  };
  EXPECT_THROW(taken([](PictureFile& p) { p.parts[0].width_px = 0; }), InputError);
  EXPECT_THROW(taken([](PictureFile& p) { p.parts[0].height_px = 1 << 30; }), InputError);
  EXPECT_THROW(taken([](PictureFile& p) { p.parts[0].channels[0].nan = 7; }), InputError);
  EXPECT_THROW(taken([](PictureFile& p) { p.parts[0].channels[0].nan = -1; }), InputError);
  EXPECT_THROW(taken([](PictureFile& p) { p.parts.clear(); }), InputError);
  EXPECT_EQ(taken([](PictureFile& p) { p.call = "a\x1b[2Jb\nc"; }).call, "a?[2Jb?c");
  EXPECT_FALSE(taken([](PictureFile& p) { p.camera_from_world = glm::dmat4(std::nan("")); }).camera_from_world.has_value());
}

}  // namespace
}  // namespace limn::test
