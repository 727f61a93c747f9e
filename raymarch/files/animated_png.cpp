#include "raymarch/files/animated_png.h"

#include <zlib.h>

#include <algorithm>

#include <cmath>
#include <cstdint>
#include <string_view>

#include "sdf/error.h"

namespace limn {
namespace {

using Bytes = std::vector<std::byte>;

constexpr size_t kSignature = 8, kAround = 12;  // bytes: of a file's beginning; of a chunk beside its data

void put(Bytes& bytes, std::uint32_t value, int count) {
  for (int i = count - 1; i >= 0; --i) bytes.push_back(static_cast<std::byte>(value >> (8 * i) & 255u));
}

std::uint32_t number_at(std::span<const std::byte> bytes, size_t at) {
  std::uint32_t value = 0;
  for (size_t i = 0; i < 4; ++i) value = value << 8 | std::to_integer<std::uint32_t>(bytes[at + i]);
  return value;
}

void put_chunk(Bytes& file, std::string_view name, std::span<const std::byte> data) {
  put(file, static_cast<std::uint32_t>(data.size()), 4);
  const size_t begin = file.size();
  for (const char c : name) file.push_back(static_cast<std::byte>(c));
  file.insert(file.end(), data.begin(), data.end());
  put(file, static_cast<std::uint32_t>(crc32(0, reinterpret_cast<const Bytef*>(&file[begin]), static_cast<uInt>(file.size() - begin))), 4);
}

/// Calls `visit(name, data)` for each chunk of a PNG file.
template <class Visit>
void for_each_chunk(std::span<const std::byte> png, const Visit& visit) {
  for (size_t at = kSignature; at + kAround <= png.size();) {
    const size_t size = number_at(png, at);
    LIMN_CHECK(at + kAround + size <= png.size());
    visit(std::string_view(reinterpret_cast<const char*>(&png[at + 4]), 4), png.subspan(at + 8, size));
    at += kAround + size;
  }
}

/// How a frame is shown: all of the picture, in place of the one before.
Bytes frame_control(std::uint32_t number, std::uint32_t width, std::uint32_t height, double frames_per_second) {
  constexpr double kParts = 100.0;  // hundredths of a frame, so that 23.98 frames a second are 2398 in 100
  Bytes data;
  for (const std::uint32_t value : {number, width, height, 0u, 0u}) put(data, value, 4);
  put(data, static_cast<std::uint32_t>(kParts), 2);
  put(data, static_cast<std::uint32_t>(std::max(1L, std::lround(kParts * frames_per_second))), 2);
  put(data, 0, 2);  // nothing is cleared after it, and nothing blended
  return data;
}

}  // namespace

std::vector<std::byte> animated_png(std::span<const std::vector<std::byte>> frames, double frames_per_second) {
  LIMN_CHECK(!frames.empty() && frames_per_second > 0.0 && frames_per_second <= 100.0);
  Bytes file(frames.front().begin(), frames.front().begin() + kSignature);
  std::uint32_t number = 0, width = 0, height = 0;
  for (size_t frame = 0; frame < frames.size(); ++frame) {
    bool begun = false;
    for_each_chunk(frames[frame], [&](std::string_view name, std::span<const std::byte> data) {
      if (name == "IHDR") {
        LIMN_CHECK(frame == 0 || (number_at(data, 0) == width && number_at(data, 4) == height));
        width = number_at(data, 0);
        height = number_at(data, 4);
      }
      if (name == "IEND") return;
      if (name != "IDAT") {
        if (frame == 0) put_chunk(file, name, data);
        return;
      }
      if (!begun && frame == 0) {
        Bytes control;
        put(control, static_cast<std::uint32_t>(frames.size()), 4);
        put(control, 0, 4);  // without end
        put_chunk(file, "acTL", control);
      }
      if (!begun) put_chunk(file, "fcTL", frame_control(number++, width, height, frames_per_second));
      begun = true;
      if (frame == 0) {
        put_chunk(file, name, data);
        return;
      }
      Bytes numbered;
      put(numbered, number++, 4);
      numbered.insert(numbered.end(), data.begin(), data.end());
      put_chunk(file, "fdAT", numbered);
    });
    LIMN_CHECK(begun);
  }
  put_chunk(file, "IEND", {});
  return file;
}

}  // namespace limn
