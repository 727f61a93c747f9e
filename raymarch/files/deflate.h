#pragma once
// Deflate (RFC 1951) by igzip of ISA-L, for PNG and EXR files: four to ten times as fast as zlib on pictures of surfaces, and up to a
// half larger. At its level 0, with tables of codes made for the bytes: the same bytes wherever they are in memory and for every SIMD
// target of its own, which levels 1 to 3 would not give (2.30: of 2,000 places of the stream's state in memory one changes a few bytes).

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace limn {

enum class DeflatePart : std::uint8_t {
  inner,        ///< Of a raw stream: ends at a byte, another part follows. Parts refer to nothing in each other.
  last,         ///< The end of a raw stream.
  whole_stream  ///< A stream of its own, in zlib's wrapping (RFC 1950).
};

/// What one thread needs to compress part after part.
class Deflater {
 public:
  Deflater();
  ~Deflater();
  Deflater(const Deflater&) = delete;
  Deflater& operator=(const Deflater&) = delete;

  /// What it returns is there until the next call. Throws MachineError where the library fails.
  std::span<const std::uint8_t> compress(std::span<const std::uint8_t> bytes, DeflatePart part);

 private:
  struct State;
  std::unique_ptr<State> state_;
  std::vector<std::uint8_t> compressed_{};
};

/// An inner part of nearly nothing but runs of one byte, by zlib's run-length coding: it takes longer than igzip, which would make five
/// times as much of them. Throws MachineError where zlib fails.
std::vector<std::uint8_t> compress_runs(std::span<const std::uint8_t> bytes);

/// Of a part of a zlib stream, for its checksum.
std::uint32_t adler32_of(std::span<const std::uint8_t> bytes);

}  // namespace limn
