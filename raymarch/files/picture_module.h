#pragma once
// What limn asks of OpenImageIO, as a table of functions. They are in a module of their own (helpers/pictures_module.cpp), loaded when the
// first picture other than a PNG is written, or any is read: OpenImageIO brings 260 shared libraries, which take a fifth of a second to
// load, and most calls need none of them.

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <future>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace limn {

enum class PixelType : std::uint8_t { byte, half, full, whole };  ///< 8-bit unsigned, 16- and 32-bit float, 32-bit unsigned.

/// A picture file's header.
struct PictureHeader {
  int width = 0, height = 0;
  std::vector<std::string> channels{};  ///< Names; empty: those that files have for so many types.
  std::vector<PixelType> types{};       ///< Of each channel.
  int alpha_channel = -1, z_channel = -1;
  struct Attribute {
    std::string name{};
    std::variant<int, std::string, std::array<float, 16>> value{};  ///< Sixteen numbers are a matrix.
  };
  std::vector<Attribute> attributes{};  ///< By OpenImageIO's names.
};

/// Pixels of rows [first, last) in the header's types, channel after channel within each pixel.
using PixelRows = std::function<void(int first, int last, char* to)>;

/// Coverage of a line of text, row after row.
struct TextMask {
  int width = 0, height = 0;
  std::vector<float> coverage{};
};

/// Errors are OpenImageIO's words; empty: it is done.
struct PictureModule {
  const char* version = nullptr;  ///< Of limn: another one's module may have other functions.

  /// Asks for a few rows at a time, which stay in the cache until they are compressed.
  std::string (*write)(const std::filesystem::path& file, const PictureHeader& header, const PixelRows& rows) = nullptr;
  /// Size, channels and their types; byte and half stand for all that floats hold.
  std::string (*read_header)(const std::filesystem::path& file, PictureHeader& header) = nullptr;
  /// One channel as floats, top row first; `values` has width x height of them.
  std::string (*read_channel)(const std::filesystem::path& file, int channel, std::span<float> values) = nullptr;
  void (*to_half)(const float* values, std::uint16_t* halves, int count) = nullptr;

  /// -1 where the font cannot be read.
  int (*text_width_px)(const std::string& text, int size_px, const std::string& font) = nullptr;
  /// Its baseline starts at (x, y). False where the font cannot be read.
  bool (*draw_text)(const std::string& text, int x, int y, int size_px, const std::string& font, TextMask& mask) = nullptr;
};

/// What a module exports: void limn_picture_module(PictureModule&), which fills in its functions.
inline constexpr const char* kPictureModuleFile = "limn-pictures.so";
inline constexpr const char* kPictureModuleFunction = "limn_picture_module";

/// Loaded once. Throws MachineError where it is not there or is another version's.
const PictureModule& picture_module();

/// Loads it in the background; who keeps the future waits for it at its end, and errors wait for picture_module().
std::future<void> load_picture_module_early();

}  // namespace limn
