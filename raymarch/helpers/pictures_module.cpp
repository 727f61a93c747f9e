// limn-pictures.so: OpenImageIO behind the functions of raymarch/files/picture_module.h, loaded when they are needed.

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>

#include "raymarch/files/picture_module.h"
#include "sdf/version.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

OIIO::TypeDesc type_of(PixelType type) {
  switch (type) {
    case PixelType::byte:
      return OIIO::TypeDesc::UINT8;
    case PixelType::half:
      return OIIO::TypeDesc::HALF;
    case PixelType::full:
      return OIIO::TypeDesc::FLOAT;
    case PixelType::whole:
      return OIIO::TypeDesc::UINT32;
  }
  return OIIO::TypeDesc::FLOAT;
}

PixelType pixel_type(const OIIO::TypeDesc& type) {
  if (type == OIIO::TypeDesc::UINT32) return PixelType::whole;
  if (type == OIIO::TypeDesc::UINT8) return PixelType::byte;
  return type == OIIO::TypeDesc::HALF ? PixelType::half : PixelType::full;
}

bool is_of_one_type(const PictureHeader& header) {
  return std::all_of(header.types.begin(), header.types.end(), [&](PixelType type) { return type == header.types.front(); });
}

OIIO::ImageSpec spec_of(const PictureHeader& header) {
  const bool one_type = is_of_one_type(header);
  OIIO::ImageSpec spec(header.width, header.height, static_cast<int>(header.types.size()),
                       one_type ? type_of(header.types.front()) : OIIO::TypeDesc(OIIO::TypeDesc::FLOAT));
  if (!header.channels.empty()) spec.channelnames = header.channels;
  if (!one_type) {
    for (const PixelType type : header.types) spec.channelformats.push_back(type_of(type));
  }
  if (header.alpha_channel >= 0) spec.alpha_channel = header.alpha_channel;
  if (header.z_channel >= 0) spec.z_channel = header.z_channel;
  for (const PictureHeader::Attribute& attribute : header.attributes) {
    if (const int* number = std::get_if<int>(&attribute.value)) spec.attribute(attribute.name, *number);
    if (const std::string* text = std::get_if<std::string>(&attribute.value)) spec.attribute(attribute.name, *text);
    if (const auto* matrix = std::get_if<std::array<float, 16>>(&attribute.value))
      spec.attribute(attribute.name, OIIO::TypeMatrix, matrix->data());
  }
  return spec;
}

/// Rows that are compressed together: blocks of 16 for each of several threads, as EXR has them.
constexpr int kStrip = 64;

/// Through an output that is open.
std::string finish(OIIO::ImageOutput& output, const PictureHeader& header, const PixelRows& rows) {
  const OIIO::TypeDesc type = is_of_one_type(header) ? type_of(header.types.front()) : OIIO::TypeDesc(OIIO::TypeDesc::UNKNOWN);
  std::vector<char> pixels(output.spec().scanline_bytes(true) * static_cast<size_t>(std::min(kStrip, header.height)));
  for (int first = 0; first < header.height; first += kStrip) {
    const int last = std::min(first + kStrip, header.height);
    rows(first, last, pixels.data());
    if (!output.write_scanlines(first, last, 0, type, pixels.data())) return output.geterror();
  }
  return output.close() ? "" : output.geterror();
}

std::string write(const fs::path& file, const PictureHeader& header, const PixelRows& rows) {
  const auto output = OIIO::ImageOutput::create(file.string());
  if (!output) return OIIO::geterror();
  if (!output->open(file.string(), spec_of(header))) return output->geterror();
  return finish(*output, header, rows);
}

std::string read_header(const fs::path& file, PictureHeader& header) {
  const auto input = OIIO::ImageInput::open(file.string());
  if (!input) return OIIO::geterror();
  const OIIO::ImageSpec& spec = input->spec();
  header = {spec.width, spec.height, spec.channelnames, {}, spec.alpha_channel, spec.z_channel, {}};
  for (int channel = 0; channel < spec.nchannels; ++channel) header.types.push_back(pixel_type(spec.channelformat(channel)));
  return "";
}

std::string read_channel(const fs::path& file, int channel, std::span<float> values) {
  const auto input = OIIO::ImageInput::open(file.string());
  if (!input) return OIIO::geterror();
  // Whole numbers of 32 bits would come scaled to [0, 1] as floats.
  const bool whole = input->spec().channelformat(channel) == OIIO::TypeDesc::UINT32;
  std::vector<std::uint32_t> numbers(whole ? values.size() : 0);
  void* const target = whole ? static_cast<void*>(numbers.data()) : static_cast<void*>(values.data());
  if (!input->read_image(0, 0, channel, channel + 1, whole ? OIIO::TypeDesc::UINT32 : OIIO::TypeDesc::FLOAT, target))
    return "damaged: " + input->geterror();
  std::transform(numbers.begin(), numbers.end(), values.begin(), [](std::uint32_t value) { return static_cast<float>(value); });
  return "";
}

void to_half(const float* values, std::uint16_t* halves, int count) {
  OIIO::convert_pixel_values(OIIO::TypeDesc::FLOAT, values, OIIO::TypeDesc::HALF, halves, count);
}

int text_width_px(const std::string& text, int size_px, const std::string& font) {
  const OIIO::ROI roi = OIIO::ImageBufAlgo::text_size(text, size_px, font);
  return roi.defined() ? roi.width() : -1;
}

bool draw_text(const std::string& text, int x, int y, int size_px, const std::string& font, TextMask& mask) {
  OIIO::ImageBuf buffer(OIIO::ImageSpec(mask.width, mask.height, 1, OIIO::TypeDesc::FLOAT));
  OIIO::ImageBufAlgo::zero(buffer);
  const float white = 1.0f;
  if (!OIIO::ImageBufAlgo::render_text(buffer, x, y, text, size_px, font, OIIO::cspan<float>(&white, 1))) return false;
  mask.width = buffer.spec().width;
  mask.height = buffer.spec().height;
  mask.coverage.resize(static_cast<size_t>(mask.width) * static_cast<size_t>(mask.height));
  return buffer.get_pixels(buffer.roi(), OIIO::TypeDesc::FLOAT, mask.coverage.data());
}

}  // namespace
}  // namespace limn

extern "C" __attribute__((visibility("default"))) void limn_picture_module(limn::PictureModule& module) {
  using namespace limn;
  module = {kVersion, write, read_header, read_channel, to_half, text_width_px, draw_text};
}
