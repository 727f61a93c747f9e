#pragma once
// What is in a picture file that nobody vouches for (.exr .png .tif .jpg), limn's own or another's: read whole by limn-read-picture, in a
// process of its own (sdf/guard.h), which sends what it found.

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace limn {

class ByteWriter;

/// A channel, and the values in it. 8- and 16-bit whole numbers count from 0 to 1.
struct PictureChannel {
  std::string name{};  ///< As in the file: "N.X".
  std::string type{};  ///< "half", "float", "uint8", …
  double least = 0.0;  ///< Of the finite values; both NaN where there are none.
  double most = 0.0;
  std::int64_t nan = 0;
  std::int64_t infinite = 0;
};

/// One part of an EXR, one page of a TIFF.
struct PicturePart {
  std::string name{};
  std::string compression{};
  int width_px = 0, height_px = 0;
  std::vector<PictureChannel> channels{};
};

struct PictureFile {
  std::string format{};  ///< "openexr", "png", "tiff", "jpeg".
  std::vector<PicturePart> parts{};
  std::string software{};  ///< Who says to have written it; may be empty.
  std::string version{};   ///< limn:version and limn:call, where limn wrote it and the format has room for them.
  std::string call{};
  std::optional<glm::dmat4> camera_from_world{};
  std::optional<glm::dmat4> ndc_from_world{};
};

/// ".exr" of "A.EXR".
std::string lower_extension(const std::filesystem::path& file);

bool is_picture_file(const std::filesystem::path& file);

/// Throws InputError naming `file`: not there, not what its extension says, damaged, more than the limits allow (1 GB and 32 times the
/// file, 20 s and a second for each 4 MB).
PictureFile read_picture_file(const std::filesystem::path& file);

/// What the helper sends. The reader trusts nothing: InputError for bytes that are no such answer; control characters in texts become
/// question marks, because terminals act on them.
void put_picture(ByteWriter& answer, const PictureFile& picture);
PictureFile picture_from_answer(std::span<const std::byte> bytes, const std::filesystem::path& file);

}  // namespace limn
