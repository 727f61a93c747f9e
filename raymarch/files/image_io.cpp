#include "raymarch/image_output.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>

#include "raymarch/files/matte_layers.h"
#include "raymarch/files/picture_module.h"
#include "raymarch/files/png_file.h"
#include "raymarch/mattes.h"
#include "raymarch/picture/pixel_lanes.h"
#include "raymarch/picture/srgb_bytes.h"
#include "sdf/error.h"
#include "sdf/output_file.h"
#include "sdf/parallel.h"
#include "sdf/version.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

std::string extension_of(const fs::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

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

/// OpenImageIO would write the time of day; equal runs must give equal bytes.
constexpr const char* kNoTime = "1970:01:01 00:00:00";

PictureHeader srgb_header(const Image<glm::vec4>& picture, bool alpha) {
  PictureHeader header{.width = picture.width, .height = picture.height, .types = std::vector(alpha ? 4 : 3, PixelType::byte)};
  header.attributes = {{"oiio:ColorSpace", "sRGB"},
                       {"oiio:UnassociatedAlpha", 1},
                       {"Compression", alpha ? "zip" : "jpeg:95"},
                       {"jpeg:subsampling", "4:4:4"},
                       {"Software", std::string("limn ") + kVersion}};
  return header;
}

/// To `temporary`, which will be `file`.
void save(const fs::path& temporary, const fs::path& file, const PictureHeader& header, const PixelRows& rows) {
  const std::string problem = picture_module().write(temporary, header, rows);
  if (!problem.empty()) throw MachineError("cannot write " + file.string() + ": " + problem);
}

/// One channel of the EXR on its way: its name, its type in the file and how its values are read. They are never copied as a whole: of 82
/// channels that alone would be twice the file's pixels.
struct Channel {
  std::string name;
  PixelType type;
  std::function<void(size_t first, size_t last, float* values)> read;  ///< Pixels [first, last), as floats.
};

/// `image` must be there until the file is written.
template <class Image, class Get>
void add_channel(std::vector<Channel>& channels, const std::string& name, PixelType type, const Image& image, Get get) {
  const auto* const pixels = image.data();
  channels.push_back({name, type, [pixels, get](size_t first, size_t last, float* values) {
                        for (size_t i = first; i < last; ++i) *values++ = static_cast<float>(get(pixels[i]));
                      }});
}

/// Half holds whole numbers to 2048; beyond it ids are 32-bit.
PixelType type_of_ids(const Image<std::int32_t>& ids) {
  const auto [least, most] = std::minmax_element(ids.pixels.begin(), ids.pixels.end());
  if (ids.pixels.empty() || (*least >= -2048 && *most <= 2048)) return PixelType::half;
  return *least >= 0 ? PixelType::whole : PixelType::full;
}

const auto kItself = [](auto value) { return value; };
auto component(int axis) {
  return [axis](const auto& v) { return v[axis]; };
}

void add_layer(std::vector<Channel>& channels, const NamedLayer& layer) {
  const auto half = PixelType::half;
  const char* const rgba[] = {".R", ".G", ".B", ".A"};
  for (int i = 0; i < 4; ++i) add_channel(channels, layer.name + rgba[i], half, layer.picture->composite.pixels, component(i));
  add_channel(channels, layer.name + ".Y", half, layer.picture->border.pixels, kItself);
  if (!layer.picture->border_status.pixels.empty())
    add_channel(channels, layer.name + ".status", half, layer.picture->border_status.pixels, kItself);
}

std::vector<Channel> channels_of(const Picture& picture) {
  const auto half = PixelType::half, full = PixelType::full;
  const GBuffer& seen = picture.gbuffer;
  std::vector<Channel> channels;
  const char* const rgba[] = {"R", "G", "B", "A"};
  const char* const xyz[] = {"X", "Y", "Z"};
  for (int i = 0; i < 4; ++i) add_channel(channels, rgba[i], half, picture.composite.pixels, component(i));
  add_channel(channels, "Z", full, seen.depth.pixels, kItself);
  for (int i = 0; i < 3; ++i) add_channel(channels, std::string("P.") + xyz[i], full, seen.position.pixels, component(i));
  for (int i = 0; i < 3; ++i) add_channel(channels, std::string("N.") + xyz[i], full, seen.normal.pixels, component(i));
  add_channel(channels, "NdotV.Y", full, seen.n_dot_v.pixels, kItself);
  add_channel(channels, "border.Y", half, picture.border.pixels, kItself);
  add_channel(channels, "id.Y", type_of_ids(seen.id), seen.id.pixels, kItself);
  add_channel(channels, "material.Y", type_of_ids(seen.material), seen.material.pixels, kItself);
  add_channel(channels, "status.Y", half, seen.status.pixels, kItself);
  if (!picture.border_status.pixels.empty()) add_channel(channels, "border_status.Y", half, picture.border_status.pixels, kItself);
  if (picture.mattes != nullptr)
    for (int i = 0; i < 3; ++i) add_channel(channels, std::string("albedo.") + rgba[i], half, picture.mattes->albedo.pixels, component(i));
  return channels;
}

std::vector<MatteLayer> mattes_of(const Picture& picture) {
  return picture.mattes != nullptr ? matte_layers(*picture.mattes) : std::vector<MatteLayer>();
}

/// EXR matrices multiply row vectors from the right: row after row, they hold what ours hold column after column.
std::array<float, 16> row_after_row(const glm::dmat4& matrix) {
  std::array<float, 16> values;
  for (int i = 0; i < 16; ++i) values[static_cast<size_t>(i)] = static_cast<float>(matrix[i / 4][i % 4]);
  return values;
}

PictureHeader exr_header(const std::vector<Channel>& channels, const Picture& picture, std::span<const MatteLayer> mattes,
                         const Camera& camera, const std::string& call) {
  PictureHeader header{.width = picture.gbuffer.width, .height = picture.gbuffer.height, .alpha_channel = 3, .z_channel = 4};
  for (const Channel& channel : channels) {
    header.channels.push_back(channel.name);
    header.types.push_back(channel.type);
  }
  header.attributes = {{"compression", "zip"},
                       {"oiio:ColorSpace", "linear"},
                       {"limn:version", kVersion},
                       {"limn:call", call},
                       {"Software", std::string("limn ") + kVersion},
                       {"DateTime", kNoTime},
                       {"worldToCamera", row_after_row(camera_from_world_matrix(camera))},
                       {"worldToNDC", row_after_row(ndc_from_world_matrix(camera))}};
  for (const MatteLayer& layer : mattes)
    for (const auto& [name, value] : layer.header) header.attributes.push_back({name, value});
  return header;
}

size_t bytes_of(PixelType type) { return type == PixelType::byte ? 1 : type == PixelType::half ? 2 : 4; }

/// Pixels that are brought into the file's types together: few enough that all their channels stay in the cache.
constexpr size_t kTogether = 1024;

/// Pixels [first, last) of one channel, each `pixel_size` bytes after the one before it.
void write_channel(const Channel& channel, size_t first, size_t last, char* to, size_t pixel_size) {
  // Float to 32-bit unsigned would be scaled to its range by OpenImageIO, so that one is copied here.
  float values[kTogether];
  channel.read(first, last, values);
  if (channel.type == PixelType::whole) {
    for (size_t i = 0; i < last - first; ++i, to += pixel_size) {
      const auto value = static_cast<std::uint32_t>(values[i]);
      std::memcpy(to, &value, sizeof value);
    }
    return;
  }
  if (channel.type == PixelType::full) {
    for (size_t i = 0; i < last - first; ++i, to += pixel_size) std::memcpy(to, &values[i], sizeof(float));
    return;
  }
  LIMN_CHECK(channel.type == PixelType::half);
  std::uint16_t halves[kTogether];
  picture_module().to_half(values, halves, static_cast<int>(last - first));
  for (size_t i = 0; i < last - first; ++i, to += pixel_size) std::memcpy(to, &halves[i], sizeof halves[i]);
}

/// Pixels [begin, end) in the file's own types.
void write_pixels(const std::vector<Channel>& channels, size_t begin, size_t end, char* to) {
  size_t pixel_size = 0;
  for (const Channel& channel : channels) pixel_size += bytes_of(channel.type);
  parallel_for(size_t{0}, (end - begin + kTogether - 1) / kTogether, [&](size_t part) {
    const size_t first = begin + part * kTogether, last = std::min(end, first + kTogether);
    char* at = to + (first - begin) * pixel_size;
    for (const Channel& channel : channels) {
      write_channel(channel, first, last, at, pixel_size);
      at += bytes_of(channel.type);
    }
  });
}

/// Of pixels of bytes that are all there.
PixelRows rows_of(const std::uint8_t* pixels, int width, int channels) {
  const size_t stride = static_cast<size_t>(width) * static_cast<size_t>(channels);
  return [pixels, stride](int first, int last, char* to) {
    std::memcpy(to, pixels + static_cast<size_t>(first) * stride, static_cast<size_t>(last - first) * stride);
  };
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

OutputFile exr_output(const Picture& picture, const Camera& camera, const std::string& call, const std::filesystem::path& file,
                      std::span<const NamedLayer> layers) {
  if (extension_of(file) != ".exr") {
    throw InputError({file.string(), {}, extension_of(file), "unknown extension for all layers", ".exr"});
  }
  return {file, [&picture, &camera, &call, file, layers](const fs::path& temporary) {
            std::vector<Channel> channels = channels_of(picture);
            const std::vector<MatteLayer> mattes = mattes_of(picture);
            for (const MatteLayer& layer : mattes)
              for (const auto& [name, values] : layer.channels) add_channel(channels, name, PixelType::full, values, kItself);
            for (const NamedLayer& layer : layers) add_layer(channels, layer);
            const auto width = static_cast<size_t>(picture.gbuffer.width);
            save(temporary, file, exr_header(channels, picture, mattes, camera, call), [&channels, width](int first, int last, char* to) {
              write_pixels(channels, static_cast<size_t>(first) * width, static_cast<size_t>(last) * width, to);
            });
          }};
}

OutputFile image_output(const Image<glm::vec4>& linear_premultiplied, const std::filesystem::path& file) {
  const std::string extension = extension_of(file);
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
            const bool alpha = has_alpha(extension);
            PictureHeader header = srgb_header(linear_premultiplied, alpha);
            if (extension == ".tif" || extension == ".tiff") header.attributes.push_back({"DateTime", kNoTime});
            if (alpha) {
              const Image<glm::u8vec4> pixels = encoded(linear_premultiplied);
              save(temporary, file, header, rows_of(bytes_of(pixels).data(), pixels.width, 4));
            } else {
              const Pixels<std::uint8_t> pixels = rgb_pixels(linear_premultiplied);
              save(temporary, file, header, rows_of(pixels.data(), header.width, 3));
            }
          }};
}

OutputFile image_output(const Image<glm::u8vec4>& bytes, const std::filesystem::path& file) {
  LIMN_CHECK(extension_of(file) == ".png");
  return {file, [&bytes, file](const fs::path& temporary) {
            const std::vector<std::byte> png = png_bytes(bytes);
            write_bytes(temporary, file, {reinterpret_cast<const char*>(png.data()), png.size()});
          }};
}

void write_exr(const Picture& picture, const Camera& camera, const std::string& call, const std::filesystem::path& file,
               std::span<const NamedLayer> layers) {
  const OutputFile output = exr_output(picture, camera, call, file, layers);
  write_together({&output, 1});
}

void write_image(const Image<glm::vec4>& linear_premultiplied, const std::filesystem::path& file) {
  const OutputFile output = image_output(linear_premultiplied, file);
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
