#pragma once
// Internal: what is done with the distances at a block's nodes, several at a time.

#include <span>

#include "sdf/lane_points.h"
#include "sdf/level_set.h"

namespace limn {

/// Points near enough to the surface to be worth a closer look.
struct NearPoints {
  LanePoints points;
  LaneNumbers value;                     ///< There.
  LaneNumbers no_less;                   ///< than the distance there.
  std::uint16_t index[kMostLanePoints];  ///< Among all points.
};

/// Near are those whose |value| / lipschitz is at most `half_width`. At the others that becomes the value, with its sign.
void select_near(const LanePoints& points, double lipschitz, double half_width, LaneNumbers& values, NearPoints& near);

/// What was found for the near ones: no less than they must be, with the sign of their values. In place.
void sign_sizes(const NearPoints& near, LaneNumbers& sizes);

/// Which of the first `count` numbers are at most `limit`, either way.
void find_within(const LaneNumbers& numbers, size_t count, double limit, LaneFlags& within);

/// Puts distances into a block and says which nodes are in the band; the others there hold +- `half_width`. Nodes come by sixteen, four
/// along y by four along z, from the nodes `first` on, by their numbers in the block.
void put_distances(const LaneNumbers& distances, std::span<const std::uint16_t> first, double half_width, LevelSetBlock& block);

}  // namespace limn
