#pragma once
// Internal: places on the surface of a level set, one for each cell that it crosses.

#include <glm/glm.hpp>
#include <vector>

#include "sdf/level_set_data.h"

namespace limn {

/// Where the surface crosses the cells of a block (sdf/level_set_band.h: blocks_with_cells), index coordinates: of each the mean of where
/// it meets the cell's edges.
std::vector<glm::dvec3> crossings_in_block(const LevelSetData& data, const nanovdb::Coord& origin);

/// As many of all these places as `most`, or all of them: evenly over the list of them, in the order of the blocks. World.
std::vector<glm::dvec3> sample_crossings(const LevelSet& level_set, size_t most);

}  // namespace limn
