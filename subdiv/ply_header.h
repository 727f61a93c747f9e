#pragma once
// The header of a PLY file (Turk 1994): what is in the file, in which order, in which types.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace limn {

enum class PlyType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
size_t bytes_of(PlyType type);
inline bool is_real(PlyType type) { return type >= PlyType::float32; }

struct PlyProperty {
  std::string name{};
  PlyType type = PlyType::float32;  ///< Of the value, or of each in the list.
  bool is_list = false;
  PlyType count_type = PlyType::uint8;
};

struct PlyElement {
  std::string name{};
  std::int64_t count = 0;
  std::vector<PlyProperty> properties{};
  /// Of one in a binary file; lists count as empty.
  size_t least_bytes() const;
};

enum class PlyEncoding { ascii, little_endian, big_endian };

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::ascii;
  std::vector<PlyElement> elements{};
  size_t data = 0;  ///< Where the data begin.
  std::vector<std::string> warnings{};
};

/// Throws InputError with the line.
PlyHeader read_ply_header(std::string_view bytes, const std::string& file);

}  // namespace limn
