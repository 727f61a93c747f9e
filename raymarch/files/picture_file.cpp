#include "raymarch/files/picture_file.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <string_view>

#include "sdf/error.h"
#include "sdf/guard.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

constexpr const char* kExpected = "a picture (.exr .png .tif .jpg)";
constexpr int kLargestSize_px = 1 << 24;
constexpr std::uint64_t kMostParts = 1 << 12, kMostChannels = 1 << 14;

/// In proportion to the file: what takes longer or more than this is no honest picture of that size.
GuardLimits limits_for(const fs::path& file) {
  const auto bytes = static_cast<std::int64_t>(fs::file_size(file));
  GuardLimits limits;
  limits.memory_bytes = std::clamp<std::int64_t>((std::int64_t{1} << 30) + 32 * bytes, 0, std::int64_t{64} << 30);
  limits.answer_bytes = std::int64_t{1} << 28;
  limits.time = std::chrono::seconds(20 + bytes / 4'000'000);
  return limits;
}

void put_matrix(ByteWriter& answer, const std::optional<glm::dmat4>& matrix) {
  answer.put(static_cast<std::uint8_t>(matrix.has_value()));
  if (!matrix) return;
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) answer.put((*matrix)[column][row]);
}

std::optional<glm::dmat4> get_matrix(ByteReader& answer) {
  if (answer.get<std::uint8_t>() == 0) return std::nullopt;
  glm::dmat4 matrix;
  bool finite = true;
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) {
      matrix[column][row] = answer.get<double>();
      finite = finite && std::isfinite(matrix[column][row]);
    }
  return finite ? std::optional(matrix) : std::nullopt;
}

std::string get_plain_text(ByteReader& answer) {
  std::string text = answer.get_text();
  std::replace_if(
      text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; }, '?');
  return text;
}

[[noreturn]] void refuse_answer(const fs::path& file) {
  throw InputError({file.string(), {}, {}, "the reader's answer makes no sense; the file is damaged", "an undamaged picture"});
}

std::uint64_t get_count(ByteReader& answer, std::uint64_t most, const fs::path& file) {
  const auto count = answer.get<std::uint64_t>();
  if (count > most) refuse_answer(file);
  return count;
}

PictureChannel get_channel(ByteReader& answer, std::int64_t pixels, const fs::path& file) {
  PictureChannel channel;
  channel.name = get_plain_text(answer);
  channel.type = get_plain_text(answer);
  channel.least = answer.get<double>();
  channel.most = answer.get<double>();
  channel.nan = answer.get<std::int64_t>();
  channel.infinite = answer.get<std::int64_t>();
  if (std::min(channel.nan, channel.infinite) < 0 || std::max(channel.nan, channel.infinite) > pixels) refuse_answer(file);
  return channel;
}

PicturePart get_part(ByteReader& answer, const fs::path& file) {
  PicturePart part;
  part.name = get_plain_text(answer);
  part.compression = get_plain_text(answer);
  part.width_px = answer.get<std::int32_t>();
  part.height_px = answer.get<std::int32_t>();
  const auto [least, most] = std::minmax(part.width_px, part.height_px);
  if (least < 1 || most > kLargestSize_px) refuse_answer(file);
  const std::uint64_t channels = get_count(answer, kMostChannels, file);
  for (std::uint64_t i = 0; i < channels; ++i)
    part.channels.push_back(get_channel(answer, static_cast<std::int64_t>(part.width_px) * part.height_px, file));
  return part;
}

}  // namespace

std::string lower_extension(const fs::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

bool is_picture_file(const fs::path& file) {
  const std::string extension = lower_extension(file);
  constexpr std::array<std::string_view, 6> kExtensions = {".exr", ".png", ".tif", ".tiff", ".jpg", ".jpeg"};
  return std::find(kExtensions.begin(), kExtensions.end(), extension) != kExtensions.end();
}

PictureFile read_picture_file(const fs::path& file) {
  check_readable(file, kExpected);
  const std::string arguments[] = {fs::absolute(file).string()};
  return picture_from_answer(run_guarded("limn-read-picture", arguments, file, limits_for(file)), file);
}

void put_picture(ByteWriter& answer, const PictureFile& picture) {
  answer.put_text(picture.format);
  for (const std::string* text : {&picture.software, &picture.version, &picture.call}) answer.put_text(*text);
  put_matrix(answer, picture.camera_from_world);
  put_matrix(answer, picture.ndc_from_world);
  answer.put(static_cast<std::uint64_t>(picture.parts.size()));
  for (const PicturePart& part : picture.parts) {
    answer.put_text(part.name);
    answer.put_text(part.compression);
    answer.put(static_cast<std::int32_t>(part.width_px));
    answer.put(static_cast<std::int32_t>(part.height_px));
    answer.put(static_cast<std::uint64_t>(part.channels.size()));
    for (const PictureChannel& channel : part.channels) {
      answer.put_text(channel.name);
      answer.put_text(channel.type);
      answer.put(channel.least);
      answer.put(channel.most);
      answer.put(channel.nan);
      answer.put(channel.infinite);
    }
  }
}

PictureFile picture_from_answer(std::span<const std::byte> bytes, const fs::path& file) {
  ByteReader answer(bytes, file.string());
  PictureFile picture;
  picture.format = get_plain_text(answer);
  for (std::string* text : {&picture.software, &picture.version, &picture.call}) *text = get_plain_text(answer);
  picture.camera_from_world = get_matrix(answer);
  picture.ndc_from_world = get_matrix(answer);
  const std::uint64_t parts = get_count(answer, kMostParts, file);
  for (std::uint64_t i = 0; i < parts; ++i) picture.parts.push_back(get_part(answer, file));
  if (!answer.done() || picture.parts.empty()) refuse_answer(file);
  return picture;
}

}  // namespace limn
