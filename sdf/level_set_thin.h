#pragma once
// Internal: walls and gaps that a grid is too coarse for.

#include <cstdint>
#include <span>

#include "sdf/level_set_distance.h"

namespace limn {

/// Shares of the surface up to this may be thin without a warning: sharp edges are thin without end. As in the audit.
inline constexpr double kThinPlacesShare = 0.005;

struct ThinPlaces {
  std::int64_t looked_at = 0;
  std::int64_t walls = 0;  ///< Within two voxels the inward normal comes out again.
  std::int64_t gaps = 0;   ///< Within one voxel the outward normal meets the surface again.
};

/// Looks from every fourth of the nodes nearest to the surface, along its normal. Nodes of one block come by sixteen, four along y by four
/// along z, from the nodes `first` on, by their numbers in LevelSetBlock; `points` and signed `distances` are theirs.
ThinPlaces find_thin_places(DistanceEvaluator& distance, std::span<const std::uint16_t> first, const LanePoints& points,
                            const LaneNumbers& distances, double voxel_size);

}  // namespace limn
