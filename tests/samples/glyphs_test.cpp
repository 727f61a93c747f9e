// Lines of text on sheets.

#include "samples/page/glyphs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <thread>

#include "samples/page/text.h"

namespace limn::test {
namespace {

constexpr const char* kFont = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";

TEST(Glyphs, StandOnTheBaselineAndAreKept) {
  if (!has_font()) GTEST_SKIP() << "no font is installed";
  const std::vector<const Glyph*> glyphs = glyphs_of("aga x", kFont, 20);
  ASSERT_EQ(glyphs.size(), 5u);
  EXPECT_EQ(glyphs[0], glyphs[2]) << "drawn twice";
  EXPECT_EQ(glyphs[0], glyphs_of("a", kFont, 20)[0]);
  EXPECT_NE(glyphs[0], glyphs_of("a", kFont, 21)[0]);
  const auto below = [](const Glyph& glyph) { return glyph.height_px - glyph.top_px; };
  EXPECT_LE(below(*glyphs[0]), 1);
  EXPECT_GE(below(*glyphs[1]), 4) << "g hangs below";
  EXPECT_TRUE(glyphs[3]->coverage.empty());
  EXPECT_GT(glyphs[3]->advance_px, 3);
  for (const Glyph* glyph : glyphs) EXPECT_EQ(glyph->coverage.size(), static_cast<size_t>(glyph->width_px * glyph->height_px));
  EXPECT_EQ(*std::max_element(glyphs[0]->coverage.begin(), glyphs[0]->coverage.end()), 255);
}

TEST(Glyphs, OfAnyBytesAndOfNoFont) {
  if (!has_font()) GTEST_SKIP() << "no font is installed";
  EXPECT_EQ(glyphs_of("\xc3\xa9\xe2\x82\xac\xf0\x9f\x98\x80", kFont, 16).size(), 3u);  // two, three and four bytes
  EXPECT_EQ(glyphs_of("a\xff\xc3", kFont, 16).size(), 3u);
  EXPECT_NE(glyphs_of("\xc3\xa9", kFont, 16)[0]->coverage, glyphs_of("e", kFont, 16)[0]->coverage);
  EXPECT_TRUE(glyphs_of("a", "/nowhere.ttf", 16).empty());
  EXPECT_TRUE(glyphs_of("", kFont, 16).empty());
}

/// Where a column or row of the picture is darker than its paper, from the first to the last.
struct Ink {
  int left = 1000, right = -1, top = 1000, bottom = -1;
};

Ink ink_of(const Image<glm::vec4>& picture) {
  Ink ink;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      if (picture.at(x, y).r < 1.0f) {
        ink.left = std::min(ink.left, x);
        ink.right = std::max(ink.right, x);
        ink.top = std::min(ink.top, y);
        ink.bottom = std::max(ink.bottom, y);
      }
  return ink;
}

TEST(Text, IsDrawnWhereItIsSaidToBe) {
  if (!has_font()) GTEST_SKIP() << "no font is installed";
  for (const TextAlign align : {TextAlign::left, TextAlign::center, TextAlign::right}) {
    const TextStyle style{20, false, glm::vec3(0.0f), align};
    Image<glm::vec4> picture(400, 100, glm::vec4(1.0f));
    draw_text(picture, 200, 60, "Height", style);
    const Ink ink = ink_of(picture);
    const int width = text_width_px("Height", style);
    EXPECT_NEAR(ink.right - ink.left + 1, width, 1);
    const int wanted = align == TextAlign::left ? 200 : align == TextAlign::center ? 200 - width / 2 : 200 - width;
    EXPECT_NEAR(ink.left, wanted, 3);
    EXPECT_NEAR(ink.top, 60 - 15, 2);
    EXPECT_NEAR(ink.bottom, 60 + 4, 2);
  }
  // What lies outside is cut.
  Image<glm::vec4> small(10, 10, glm::vec4(1.0f));
  draw_text(small, -5, 8, "Height", {20, false, glm::vec3(0.0f), TextAlign::left});
  EXPECT_GT(ink_of(small).right, 0);
}

TEST(Text, LinesAreNoWiderThanAsked) {
  if (!has_font()) GTEST_SKIP() << "no font is installed";
  const TextStyle style{15, false, glm::vec3(0.0f), TextAlign::left};
  const std::string text = "The quick brown fox jumps over the lazy dog and a remarkablylongwordindeed follows it";
  const std::vector<std::string> lines = wrapped(text, style, 120);
  std::string joined;
  for (const std::string& line : lines) {
    EXPECT_TRUE(text_width_px(line, style) <= 120 || line.find(' ') == std::string::npos) << line;
    joined += (joined.empty() ? "" : " ") + line;
  }
  EXPECT_EQ(joined, text);
  EXPECT_GT(lines.size(), 4u);
}

TEST(Glyphs, ManyThreadsMayAsk) {
  if (!has_font()) GTEST_SKIP() << "no font is installed";
  std::vector<std::vector<const Glyph*>> found(8);
  std::vector<std::thread> threads;
  for (size_t i = 0; i < found.size(); ++i)
    threads.emplace_back([&, i] {
      for (int size = 30; size < 60; ++size)
        for (const Glyph* glyph : glyphs_of("many threads ask at once", kFont, size)) found[i].push_back(glyph);
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(found[0].size(), 30u * 24u);
  for (const auto& one : found) EXPECT_EQ(one, found[0]);
}

}  // namespace
}  // namespace limn::test
