#pragma once
// Internal: distances for the nodes outside the band that stencils read, from the surface that the grid holds and the distances about them.

#include <cstdint>
#include <vector>

#include "sdf/level_set_data.h"

namespace limn {

/// New values for nodes of one block of 8^3 (bits and values as in LevelSetBlock). Those in `kept_out` stay outside the band: the grid
/// holds no surface that they could have a distance from, only a sign.
struct FilledBlock {
  glm::ivec3 origin{0};
  std::array<std::uint64_t, 8> filled{};
  std::array<std::uint64_t, 8> kept_out{};
  std::array<float, 512> values{};
};

/// The nodes outside the band that `stencil` reads for the crossed cells, by block in the order of x, y, z.
struct MissingBlock {
  glm::ivec3 origin{0};
  std::array<std::uint64_t, 8> nodes{};
};
std::vector<MissingBlock> missing_nodes(const LevelSetData& data, const Stencil& stencil);

/// Values for them.
std::vector<FilledBlock> fill_nodes(const LevelSetData& data, const std::vector<MissingBlock>& missing);

/// The grid with these values; nothing else in it changes, nor in what is said of it.
std::shared_ptr<LevelSetData> with_filled_nodes(const LevelSet& level_set, const std::vector<FilledBlock>& blocks);

}  // namespace limn
