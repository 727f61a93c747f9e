#pragma once
// What a level set is made of, as bytes to hash.

#include <cstddef>
#include <span>
#include <vector>

#include "sdf/level_set.h"

namespace limn {

/// Equal for equal level sets, in whatever process they were made. `values` look at the level set's memory: valid as long as a copy of it
/// is.
struct LevelSetBytes {
  std::vector<double> numbers{};                     ///< Its place in the world, background and band.
  std::vector<std::int32_t> origins{};               ///< Three for each leaf, index coordinates.
  std::vector<std::span<const std::byte>> values{};  ///< Two for each leaf: which nodes are active, and the values of all.
};
LevelSetBytes bytes_of(const LevelSet& level_set);

}  // namespace limn
