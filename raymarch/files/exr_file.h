#pragma once
// Pictures of many channels as OpenEXR files: header and chunks by OpenEXR's core library, compression in parallel by files/deflate.h.

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <variant>
#include <vector>

namespace limn {

enum class ExrType : std::uint8_t { half, full, whole };  ///< 16- and 32-bit float, 32-bit unsigned.

/// A channel: its name, its type in the file, and how its values are read. They are never copied as a whole: of 82 channels that alone
/// would be twice the file's pixels.
struct ExrChannel {
  std::string name{};
  ExrType type = ExrType::half;
  /// Values of pixels [first, last), counted row after row from the top left. Called by several threads at once.
  std::function<void(size_t first, size_t last, float* values)> read{};
};

struct ExrAttribute {
  std::string name{};
  std::variant<std::string, std::array<float, 16>> value{};  ///< Sixteen numbers are a matrix, row after row.
};

struct ExrPicture {
  int width_px = 0, height_px = 0;
  std::vector<ExrAttribute> attributes{};
  std::vector<ExrChannel> channels{};  ///< In any order; names are unique.
};

/// One part of scan lines, zipped by sixteen; the same bytes whatever the number of threads. `file` is not there yet or is replaced.
/// Throws MachineError with `name`, what people know the file by, where it cannot be written.
void write_exr_file(const std::filesystem::path& file, const std::string& name, const ExrPicture& picture);

}  // namespace limn
