#pragma once
// Internal: rays through the shell between a surface and its offset, several at a time.

#include <array>
#include <cstddef>

#include "raymarch/surface.h"
#include "sdf/lane_points.h"

namespace limn {

/// Rays that are still followed. Whole vectors are read and written: what lies beyond `count` says nothing.
struct ShellLanes {
  alignas(64) double origin[3][kRayBatchSize], direction[3][kRayBatchSize];
  alignas(64) double t[kRayBatchSize], t_end[kRayBatchSize];
  alignas(64) double side[kRayBatchSize];   ///< 1 where the ray started beyond the offset surface, -1 within; 0 unknown.
  alignas(64) double index[kRayBatchSize];  ///< In its batch.
  size_t count = 0;
};

/// Rays that came to the offset surface.
struct FoundLanes {
  struct Lane {
    int index = 0;
    double t = 0.0, side = 0.0;
  };
  std::array<Lane, kRayBatchSize> lanes;
  size_t count = 0;
};

/// Steps of sphere tracing (Hart 1996). Shares are of the width.
struct ShellSteps {
  OffsetWidth width{};
  double touch = 0.0;  ///< A ray enters the shell where it comes this near to the offset, and leaves it where it is twice as far beyond.
  double least = 0.0;  ///< No step within is shorter.
  double trust = 1.0;  ///< Share of a distance that is taken.
  bool are_the_last = false;  ///< Rays that come no farther have crept along the surface all the way: they are found.
};

/// Where the rays are.
void place_lanes(const ShellLanes& lanes, LanePoints& points);

/// One step of each ray, whose distances at its point are these. Those that are found, and those that come to their ends, leave `lanes`.
void advance_lanes(const ShellSteps& how, const LanePoints& points, const LaneNumbers& distances, ShellLanes& lanes, FoundLanes& found);

}  // namespace limn
