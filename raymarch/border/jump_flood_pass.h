#pragma once
// What one pass of jump flooding does to one block of pixels, in the ways that processors can do it.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace limn {

/// From a pixel's centre to a crossing, in 1/32 px: one multiply-add makes the squared distance, and a register holds many.
struct Offset {
  std::int16_t x, y;
};
/// Farther than any reach, even after all steps have been added to it.
inline constexpr Offset kUnknownOffset{32767, 32767};
inline bool known(Offset offset) { return offset.x != kUnknownOffset.x || offset.y != kUnknownOffset.y; }
inline std::int32_t square(Offset offset) { return std::int32_t{offset.x} * offset.x + std::int32_t{offset.y} * offset.y; }

/// The picture is worked on in blocks of this many pixels: a whole number of the widest registers across.
inline constexpr int kBlockWidth_px = 64, kBlockHeight_px = 8;

/// Neighbours of the pixels of a block at one distance, in order: where those of its first pixel lie, and what is added to their offsets.
struct BlockSources {
  std::array<const Offset*, 8> from{};
  std::array<Offset, 8> move{};
  int count = 0;
};

/// Every pixel of a block takes the shortest of its own offset and those of its neighbours, moved by their distance with saturation; ties
/// go to the own, then to the first. Lines of all pictures are `stride` offsets apart; No moved number may fall
/// below -32767. `out` overlaps none that is read.
using FloodBlock = void (*)(const Offset* own, const BlockSources& sources, std::ptrdiff_t stride, Offset* out);

struct FloodKernel {
  std::string name;
  FloodBlock flood;
};
/// Those that this build has and this processor can run, slowest first ("scalar" is always there). All write the same bytes.
std::vector<FloodKernel> flood_kernels();

}  // namespace limn
