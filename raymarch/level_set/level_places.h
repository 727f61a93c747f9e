#pragma once
// Internal: where rays meet another level of a grid than its own.

#include <vector>

#include "raymarch/level_set/walk.h"

namespace limn {

/// Boxes (render space) that hold all cells in which rays meet the level, as Surface::where_met has them. `leaves`: those of the level.
std::vector<Box> level_meeting_places(const LevelSetData& data, const WalkedGrid& grid, const CrossedLeaves& leaves,
                                      const MeetingRequest& request);

}  // namespace limn
