#include "samples/judge/ink_picture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "raymarch/files/picture_file.h"
#include "raymarch/image_io.h"
#include "samples/output/output.h"
#include "sdf/color.h"
#include "sdf/error.h"
#include "sdf/quantile.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

bool has(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Values that are no numbers count as no ink.
Image<float> coverage_of(Image<float> channel) {
  for (float& value : channel.pixels) value = value > 0.0f ? std::min(value, 1.0f) : 0.0f;
  return channel;
}

/// The picture in linear light, over white where it is transparent.
Image<glm::vec3> linear_colors(const fs::path& file, const std::vector<std::string>& names) {
  std::array<std::string, 3> channels = {"R", "G", "B"};
  if (!has(names, "R")) channels.fill(has(names, "Y") ? "Y" : names.front());
  const bool transparent = has(names, "A"), encoded = ending_of(file) != ".exr";
  const Image<float> alpha = transparent ? read_channel(file, "A") : Image<float>();
  Image<glm::vec3> colors;
  for (int i = 0; i < 3; ++i) {
    const Image<float> channel = read_channel(file, channels[static_cast<size_t>(i)]);
    if (i == 0) colors = Image<glm::vec3>(channel.width, channel.height);
    for (size_t k = 0; k < channel.size(); ++k) {
      const float a = transparent ? std::clamp(alpha.pixels[k], 0.0f, 1.0f) : 1.0f;
      float value = std::isfinite(channel.pixels[k]) ? std::max(channel.pixels[k], 0.0f) : 0.0f;
      // The file's values come multiplied by alpha as they are encoded.
      if (encoded && a > 0.0f) value = linear_from_srgb(std::min(value / a, 1.0f)) * a;
      colors.pixels[k][i] = std::min(value, 1.0f) + 1.0f - a;
    }
  }
  return colors;
}

float luminance(const glm::vec3& c) { return glm::dot(c, glm::vec3(0.2126f, 0.7152f, 0.0722f)); }

/// Most of what lies at the picture's border is background.
double background_luminance(const Image<glm::vec3>& colors) {
  std::vector<double> border;
  for (int y = 0; y < colors.height; ++y) {
    const bool whole_row = y == 0 || y + 1 == colors.height;
    for (int x = 0; x < colors.width; x += whole_row ? 1 : std::max(1, colors.width - 1))
      border.push_back(static_cast<double>(luminance(colors.at(x, y))));
  }
  return upper_median(border);
}

Image<float> darker_than_background(const Image<glm::vec3>& colors) {
  const double background = background_luminance(colors);
  double darkest = background;
  for (const glm::vec3& c : colors.pixels) darkest = std::min(darkest, static_cast<double>(luminance(c)));
  Image<float> coverage(colors.width, colors.height);
  // Less is noise, not ink.
  constexpr double kLeastContrast = 0.05;
  if (background - darkest < kLeastContrast) return coverage;
  for (size_t i = 0; i < colors.size(); ++i) {
    const double dark = (background - static_cast<double>(luminance(colors.pixels[i]))) / (background - darkest);
    coverage.pixels[i] = static_cast<float>(std::clamp(dark, 0.0, 1.0));
  }
  return coverage;
}

/// The largest value within three pixels.
Image<float> largest_around(const Image<float>& values) {
  constexpr int kAround = 3;
  Image<float> rows(values.width, values.height), result = rows;
  for (int y = 0; y < rows.height; ++y)
    for (int x = 0; x < rows.width; ++x)
      for (int k = std::max(0, x - kAround); k <= std::min(rows.width - 1, x + kAround); ++k)
        rows.at(x, y) = std::max(rows.at(x, y), values.at(k, y));
  for (int y = 0; y < rows.height; ++y)
    for (int x = 0; x < rows.width; ++x)
      for (int k = std::max(0, y - kAround); k <= std::min(rows.height - 1, y + kAround); ++k)
        result.at(x, y) = std::max(result.at(x, y), rows.at(x, k));
  return result;
}

/// How near each colour is to the ink's, as a share of how far the surroundings go from it.
Image<float> like_color(const Image<glm::vec3>& colors, const glm::vec3& ink) {
  Image<float> distance(colors.width, colors.height);
  for (size_t i = 0; i < colors.size(); ++i) distance.pixels[i] = glm::distance(colors.pixels[i], ink);
  const Image<float> farthest = largest_around(distance);
  Image<float> coverage(colors.width, colors.height);
  // Where all around is of this colour, so is the pixel.
  constexpr float kSame = 0.1f;
  for (size_t i = 0; i < colors.size(); ++i)
    coverage.pixels[i] = farthest.pixels[i] < kSame ? 1.0f : std::clamp(1.0f - distance.pixels[i] / farthest.pixels[i], 0.0f, 1.0f);
  return coverage;
}

}  // namespace

Image<float> read_ink(const fs::path& file, const InkChoice& ink) {
  read_picture_file(file);  // In a process of its own: afterwards the file is known to be whole.
  if (!ink.mask.empty()) {
    read_picture_file(ink.mask);
    return coverage_of(read_channel(ink.mask, channel_names(ink.mask).front()));
  }
  const std::vector<std::string> names = channel_names(file);
  if (ink.alpha) {
    if (!has(names, "A"))
      throw InputError({file.string(), "alpha", "", "the picture has no alpha", "a picture with alpha, or a colour of ink"});
    return coverage_of(read_channel(file, "A"));
  }
  // limn's own EXR files say what is ink.
  if (!ink.color && has(names, "border.Y")) return coverage_of(read_channel(file, "border.Y"));
  const Image<glm::vec3> colors = linear_colors(file, names);
  return ink.color ? like_color(colors, glm::vec3(*ink.color)) : darker_than_background(colors);
}

}  // namespace limn
