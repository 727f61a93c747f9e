#include "raymarch/image_output.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>

#include "raymarch/files/picture_file.h"
#include "raymarch/files/picture_module.h"
#include "raymarch/files/png_file.h"
#include "raymarch/picture/pixel_lanes.h"
#include "raymarch/picture/srgb_bytes.h"
#include "sdf/error.h"
#include "sdf/output_file.h"
#include "sdf/parallel.h"
#include "sdf/version.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

bool has_alpha(const std::string& extension) { return extension != ".jpg" && extension != ".jpeg"; }

/// Interleaved 8-bit sRGB over white.
Pixels<std::uint8_t> rgb_pixels(const Image<glm::vec4>& picture) {
  constexpr size_t kChannels = 3;
  const SrgbBytes& srgb_byte = srgb_bytes();
  Pixels<std::uint8_t> bytes;
  bytes.resize(picture.size() * kChannels);
  parallel_parts(picture.size(), size_t{1} << 14, [&](const IndexRange<size_t>& part) {
    for (size_t i = part.first; i < part.last; ++i) {
      const glm::vec4& color = picture.pixels[i];
      const glm::vec3 rgb = glm::vec3(color) + (1.0f - color.a);
      for (int channel = 0; channel < 3; ++channel) bytes[i * kChannels + static_cast<size_t>(channel)] = srgb_byte(rgb[channel]);
    }
  });
  return bytes;
}

std::span<const std::uint8_t> bytes_of(const Image<glm::u8vec4>& picture) {
  return {reinterpret_cast<const std::uint8_t*>(picture.pixels.data()), 4 * picture.size()};
}

std::vector<std::byte> png_bytes(const Image<glm::u8vec4>& picture) {
  return png_file({picture.width, picture.height, 4, bytes_of(picture), std::string("limn ") + kVersion});
}

/// To `temporary`, which will be `file`; three or four channels.
void save(const fs::path& temporary, const fs::path& file, const std::string& extension, int width_px, int height_px,
          std::span<const std::uint8_t> pixels) {
  const bool alpha = has_alpha(extension);
  BytePicture picture{.width_px = width_px, .height_px = height_px, .channels = alpha ? 4 : 3, .pixels = pixels};
  picture.attributes = {{"oiio:ColorSpace", "sRGB"},
                        {"oiio:UnassociatedAlpha", 1},
                        {"Compression", alpha ? "zip" : "jpeg:95"},
                        {"jpeg:subsampling", "4:4:4"},
                        {"Software", std::string("limn ") + kVersion}};
  // OpenImageIO would write the time of day; equal runs must give equal bytes.
  if (extension == ".tif" || extension == ".tiff") picture.attributes.push_back({"DateTime", "1970:01:01 00:00:00"});
  const std::string problem = picture_module().write(temporary, picture);
  if (!problem.empty()) throw MachineError("cannot write " + file.string() + ": " + problem);
}

PictureHeader header_of(const fs::path& file) {
  std::error_code error;
  if (!fs::exists(file, error)) throw InputError({file.string(), {}, {}, "no such file", "an image"});
  PictureHeader header;
  const std::string problem = picture_module().read_header(file, header);
  if (!problem.empty()) throw InputError({file.string(), {}, {}, "not a readable image: " + problem, "an .exr, .png, .tif or .jpg"});
  return header;
}

}  // namespace

OutputFile image_output(const Image<glm::vec4>& linear_premultiplied, const std::filesystem::path& file) {
  const std::string extension = lower_extension(file);
  const std::vector<std::string> known = {".png", ".tif", ".tiff", ".jpg", ".jpeg"};
  if (std::find(known.begin(), known.end(), extension) == known.end()) {
    throw InputError({file.string(), {}, extension, "unknown extension for a picture", known_names(extension, known)});
  }
  if (extension == ".png") {
    return {file, [&linear_premultiplied, file](const fs::path& temporary) {
              const std::vector<std::byte> bytes = png_bytes(encoded(linear_premultiplied));
              write_bytes(temporary, file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
            }};
  }
  return {file, [&linear_premultiplied, file, extension](const fs::path& temporary) {
            if (has_alpha(extension)) {
              const Image<glm::u8vec4> pixels = encoded(linear_premultiplied);
              save(temporary, file, extension, pixels.width, pixels.height, bytes_of(pixels));
            } else {
              const Pixels<std::uint8_t> pixels = rgb_pixels(linear_premultiplied);
              save(temporary, file, extension, linear_premultiplied.width, linear_premultiplied.height, pixels);
            }
          }};
}

OutputFile image_output(const Image<glm::u8vec4>& bytes, const std::filesystem::path& file) {
  LIMN_CHECK(lower_extension(file) == ".png");
  return {file, [&bytes, file](const fs::path& temporary) {
            const std::vector<std::byte> png = png_bytes(bytes);
            write_bytes(temporary, file, {reinterpret_cast<const char*>(png.data()), png.size()});
          }};
}

void write_image(const Image<glm::vec4>& linear_premultiplied, const std::filesystem::path& file) {
  const OutputFile output = image_output(linear_premultiplied, file);
  write_together({&output, 1});
}

void write_image(const Image<glm::u8vec4>& bytes, const std::filesystem::path& file) {
  const OutputFile output = image_output(bytes, file);
  write_together({&output, 1});
}

std::vector<std::byte> encode_png(const Image<glm::vec4>& linear_premultiplied) { return png_bytes(encoded(linear_premultiplied)); }
std::vector<std::byte> encode_png(const Image<glm::u8vec4>& bytes) { return png_bytes(bytes); }

Image<float> read_channel(const std::filesystem::path& file, const std::string& channel) {
  const PictureHeader header = header_of(file);
  const auto found = std::find(header.channels.begin(), header.channels.end(), channel);
  if (found == header.channels.end())
    throw InputError({file.string(), "channel", channel, "no such channel", known_names(channel, header.channels)});
  Image<float> image(header.width, header.height);
  const std::string problem = picture_module().read_channel(file, static_cast<int>(found - header.channels.begin()), image.pixels);
  if (!problem.empty()) throw InputError({file.string(), "channel", channel, problem, "a complete image"});
  return image;
}

std::vector<std::string> channel_names(const std::filesystem::path& file) { return header_of(file).channels; }

}  // namespace limn
