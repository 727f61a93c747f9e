#pragma once
// What limn asks of OpenImageIO, as a table of functions. They are in a module of their own (helpers/pictures_module.cpp), loaded when the
// first .tif or .jpg is written, or any is read: OpenImageIO brings 260 shared libraries, which take a fifth of a second to
// load, and most calls need none of them.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <future>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace limn {

/// What a picture file's header says.
struct PictureHeader {
  int width = 0, height = 0;
  std::vector<std::string> channels{};  ///< Names.
};

/// A picture of bytes, with its facts by OpenImageIO's names.
struct BytePicture {
  int width_px = 0, height_px = 0, channels = 0;
  std::span<const std::uint8_t> pixels{};  ///< Row after row from the top, channel after channel within each pixel.
  struct Attribute {
    std::string name{};
    std::variant<int, std::string> value{};
  };
  std::vector<Attribute> attributes{};
};

/// Errors are OpenImageIO's words; empty: it is done.
struct PictureModule {
  const char* version = nullptr;  ///< Of limn: another one's module may have other functions.

  std::string (*write)(const std::filesystem::path& file, const BytePicture& picture) = nullptr;
  std::string (*read_header)(const std::filesystem::path& file, PictureHeader& header) = nullptr;
  /// One channel as floats, top row first; `values` has width x height of them.
  std::string (*read_channel)(const std::filesystem::path& file, int channel, std::span<float> values) = nullptr;
};

/// What a module exports: void limn_picture_module(PictureModule&), which fills in its functions.
inline constexpr const char* kPictureModuleFile = "limn-pictures.so";
inline constexpr const char* kPictureModuleFunction = "limn_picture_module";

/// Loaded once. Throws MachineError where it is not there or is another version's.
const PictureModule& picture_module();

/// Loads it in the background; who keeps the future waits for it at its end, and errors wait for picture_module().
std::future<void> load_picture_module_early();

}  // namespace limn
