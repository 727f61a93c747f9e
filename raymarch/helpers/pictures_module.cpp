// limn-pictures.so: OpenImageIO behind the functions of raymarch/files/picture_module.h, loaded when they are needed.

#include <OpenImageIO/imageio.h>

#include "raymarch/files/picture_module.h"
#include "sdf/version.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

std::string write(const fs::path& file, const BytePicture& picture) {
  OIIO::ImageSpec spec(picture.width_px, picture.height_px, picture.channels, OIIO::TypeDesc::UINT8);
  for (const BytePicture::Attribute& attribute : picture.attributes)
    std::visit([&](const auto& value) { spec.attribute(attribute.name, value); }, attribute.value);
  const auto output = OIIO::ImageOutput::create(file.string());
  if (!output) return OIIO::geterror();
  if (!output->open(file.string(), spec)) return output->geterror();
  if (!output->write_image(OIIO::TypeDesc::UINT8, picture.pixels.data())) return output->geterror();
  return output->close() ? "" : output->geterror();
}

std::string read_header(const fs::path& file, PictureHeader& header) {
  const auto input = OIIO::ImageInput::open(file.string());
  if (!input) return OIIO::geterror();
  const OIIO::ImageSpec& spec = input->spec();
  header = {spec.width, spec.height, spec.channelnames};
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

}  // namespace
}  // namespace limn

extern "C" __attribute__((visibility("default"))) void limn_picture_module(limn::PictureModule& module) {
  using namespace limn;
  module = {kVersion, write, read_header, read_channel};
}
