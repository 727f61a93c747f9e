// limn-read-picture FILE: reads a picture that nobody vouches for with OpenImageIO, every pixel of it, and answers with what is in it
// (sdf/guard.h).
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "raymarch/files/picture_file.h"
#include "sdf/guard.h"
#include "sdf/guard_helper.h"

namespace {

using limn::PictureChannel;
using limn::PictureFile;
using limn::PicturePart;

/// Values that are looked at together: rows, as many as fit.
constexpr std::int64_t kValuesTogether = std::int64_t{1} << 22;

[[noreturn]] void refuse(const std::string& reason) { throw std::runtime_error(reason); }

/// OpenImageIO's messages name the file, which whoever reads the refusal knows, and may have several lines.
std::string first_line(const std::string& message, const std::string& file) {
  std::string line = message.substr(0, message.find('\n'));
  for (size_t at = line.find(file); at != std::string::npos; at = line.find(file, at)) line.replace(at, file.size(), "the file");
  return line.empty() ? "its pixels cannot be read" : line;
}

[[noreturn]] void refuse_damaged(const std::string& message, const std::string& file) {
  refuse("damaged: " + first_line(message, file) + "; an undamaged picture");
}

/// Only the reader of the format that the extension names is asked.
std::string format_of(const std::string& file) {
  std::string extension = std::filesystem::path(file).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".exr") return "openexr";
  if (extension == ".png") return "png";
  if (extension == ".tif" || extension == ".tiff") return "tiff";
  if (extension == ".jpg" || extension == ".jpeg") return "jpeg";
  refuse("not the extension of a picture; .exr, .png, .tif or .jpg");
}

void look_at(const std::vector<float>& values, size_t channel, size_t stride, double scale, PictureChannel& facts) {
  for (size_t i = channel; i < values.size(); i += stride) {
    const double value = scale * static_cast<double>(values[i]);
    if (std::isnan(value)) {
      ++facts.nan;
    } else if (std::isinf(value)) {
      ++facts.infinite;
    } else {
      facts.least = std::isnan(facts.least) ? value : std::min(facts.least, value);
      facts.most = std::isnan(facts.most) ? value : std::max(facts.most, value);
    }
  }
}

bool read_rows(OIIO::ImageInput& input, const OIIO::ImageSpec& spec, int part, int first, int last, std::vector<float>& values) {
  if (spec.tile_width > 0)
    return input.read_tiles(part, 0, spec.x, spec.x + spec.width, first, last, spec.z, spec.z + std::max(1, spec.depth), 0, spec.nchannels,
                            OIIO::TypeDesc::FLOAT, values.data());
  return input.read_scanlines(part, 0, first, last, spec.z, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, values.data());
}

void look_at_pixels(OIIO::ImageInput& input, const OIIO::ImageSpec& spec, int index, const std::string& file, PicturePart& part) {
  const std::int64_t row = static_cast<std::int64_t>(spec.width) * spec.nchannels * std::max(1, spec.depth);
  const int unit = spec.tile_width > 0 ? std::max(1, spec.tile_height) : 1;
  const int rows = static_cast<int>(std::clamp<std::int64_t>(kValuesTogether / row / unit, 1, 64)) * unit;
  const auto channels = static_cast<size_t>(spec.nchannels);
  std::vector<float> values;
  for (int first = spec.y; first < spec.y + spec.height; first += rows) {
    const int last = std::min(first + rows, spec.y + spec.height);
    values.resize(static_cast<size_t>(row * (last - first)));
    if (!read_rows(input, spec, index, first, last, values)) refuse_damaged(input.geterror(), file);
    for (size_t c = 0; c < channels; ++c) {
      // Whole numbers of 32 bits come scaled to [0, 1]; ids are meant as they are.
      const double scale =
          spec.channelformat(static_cast<int>(c)) == OIIO::TypeDesc::UINT32 ? std::numeric_limits<std::uint32_t>::max() : 1.0;
      look_at(values, c, channels, scale, part.channels[c]);
    }
  }
}

PicturePart read_part(OIIO::ImageInput& input, int index, const std::string& file) {
  const OIIO::ImageSpec spec = input.spec();
  if (spec.width < 1 || spec.height < 1 || spec.nchannels < 1) refuse("it holds no pixels; a picture with some");
  // OpenImageIO keeps coordinates in 32 bits.
  for (const std::int64_t end : {std::int64_t{spec.x} + spec.width, std::int64_t{spec.y} + spec.height, std::int64_t{spec.z} + spec.depth})
    if (std::abs(end) > std::numeric_limits<int>::max() / 2) refuse("its size or place is beyond all reason; an undamaged picture");
  PicturePart part;
  part.name = spec.get_string_attribute("oiio:subimagename");
  part.compression = spec.get_string_attribute("compression");
  part.width_px = spec.width;
  part.height_px = spec.height;
  const double none = std::numeric_limits<double>::quiet_NaN();
  for (int c = 0; c < spec.nchannels; ++c) {
    const bool named = static_cast<size_t>(c) < spec.channelnames.size();
    part.channels.push_back(
        {named ? spec.channelnames[static_cast<size_t>(c)] : std::to_string(c), spec.channelformat(c).c_str(), none, none});
  }
  // Deep pixels hold lists of samples: their channels are named, their values not looked at.
  if (!spec.deep) look_at_pixels(input, spec, index, file, part);
  return part;
}

/// EXR matrices multiply row vectors from the right: row after row, they hold what ours hold column after column.
std::optional<glm::dmat4> matrix_of(const OIIO::ImageSpec& spec, const char* name) {
  float values[16];
  if (!spec.getattribute(name, OIIO::TypeMatrix, values)) return std::nullopt;
  glm::dmat4 matrix;
  for (int i = 0; i < 16; ++i) matrix[i / 4][i % 4] = static_cast<double>(values[i]);
  return matrix;
}

void read(const std::string& file, limn::ByteWriter& answer) {
  // Other threads would take address space that the limit counts.
  OIIO::attribute("threads", 1);
  OIIO::attribute("exr_threads", -1);
  const std::string format = format_of(file);
  const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::create(format);
  if (!input) refuse("OpenImageIO has no reader for " + format);
  OIIO::ImageSpec first;
  if (!input->open(file, first)) refuse("not a readable picture: " + first_line(input->geterror(), file) + "; an undamaged picture");
  PictureFile picture;
  picture.format = format;
  picture.software = first.get_string_attribute("Software");
  picture.version = first.get_string_attribute("limn:version");
  picture.call = first.get_string_attribute("limn:call");
  picture.camera_from_world = matrix_of(first, "worldToCamera");
  picture.ndc_from_world = matrix_of(first, "worldToNDC");
  for (int part = 0; part == 0 || input->seek_subimage(part, 0); ++part) picture.parts.push_back(read_part(*input, part, file));
  limn::put_picture(answer, picture);
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) {
    std::fputs("usage: limn-read-picture FILE (started by limn, answers on file descriptor 3)\n", stderr);
    return 2;
  }
  return limn::run_helper([&](limn::ByteWriter& answer) { read(arguments[1], answer); });
}
