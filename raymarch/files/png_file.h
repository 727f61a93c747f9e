#pragma once
// PNG by libpng's headers and ISA-L's compression, in parallel blocks of rows.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace limn {

/// 8 bits a channel, rows from the top.
struct PngPicture {
  int width = 0, height = 0;               ///< Above 0.
  int channels = 4;                        ///< 3: RGB; 4: RGBA, not premultiplied.
  std::span<const std::uint8_t> pixels{};  ///< width x height x channels.
  std::string software{};                  ///< Who wrote it.
};

/// The whole file, marked as sRGB. The same bytes whatever the number of threads. Throws MachineError where libpng or ISA-L fails.
std::vector<std::byte> png_file(const PngPicture& picture);

}  // namespace limn
