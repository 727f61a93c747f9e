// Colours in words against sRGB's own formula, and what is none.
#include "sdf/color_text.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sdf/descriptor.h"
#include "sdf/error.h"

namespace limn {
namespace {

/// IEC 61966-2-1, written from the standard.
double linear(int code) {
  const double c = code / 255.0;
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

void expect_color(const char* text, int r, int g, int b) {
  const auto color = color_from_text(text);
  ASSERT_TRUE(color.has_value()) << text;
  EXPECT_NEAR(color->r, linear(r), 1e-6) << text;
  EXPECT_NEAR(color->g, linear(g), 1e-6) << text;
  EXPECT_NEAR(color->b, linear(b), 1e-6) << text;
}

TEST(ColorText, ReadsHexadecimalDigitsAndNames) {
  expect_color("#000000", 0, 0, 0);
  expect_color("#FFffFF", 255, 255, 255);
  expect_color("#12ab7f", 0x12, 0xab, 0x7f);
  expect_color("#1bf", 0x11, 0xbb, 0xff);
  expect_color("white", 255, 255, 255);
  expect_color("Teal", 0, 128, 128);
  expect_color("GREY", 128, 128, 128);
  expect_color("orange", 255, 165, 0);
}

TEST(ColorText, EveryCodeIsItsOwn) {
  for (int code = 0; code < 256; ++code) {
    char text[8];
    std::snprintf(text, sizeof text, "#%02x%02x%02x", code, 255 - code, code);
    expect_color(text, code, 255 - code, code);
  }
}

TEST(ColorText, RefusesEverythingElse) {
  for (const char* text : {"", "#", "#12", "#1234", "#12345", "#1234567", "#ggg", "#12 456", "whit", "white ", "0.5,0.5,0.5", "#-12345"})
    EXPECT_FALSE(color_from_text(text).has_value()) << text;
}

TEST(ColorText, ParametersThatAreColorsTakeThem) {
  const Parameter color{"color", ParameterKind::color, "", {0.0, 0.0, 0.0}, 0.0, 1.0, "ink", {}};
  const auto resolved = [&](const char* word) { return resolve({&color, 1}, {{"color", {{}, word, {}}}}).vector3("color"); };
  EXPECT_NEAR(resolved("#ff8000").y, linear(0x80), 1e-6);
  EXPECT_EQ(resolved("red").x, 1.0);
  try {
    resolved("rad");
    ADD_FAILURE() << "was taken";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("#rrggbb"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace limn
