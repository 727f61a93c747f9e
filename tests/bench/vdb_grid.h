#pragma once
// A level set as an OpenVDB grid, for peers and for the truth of grids.

#include <openvdb/openvdb.h>

#include <cstring>

#include "tests/bench/contestant.h"

namespace limn::bench {

/// Written to a file and read back: the library keeps no OpenVDB grid.
openvdb::FloatGrid::Ptr openvdb_grid(const LevelSet& level_set);

inline void copy(const Frame& from, Frame& to) {
  std::memcpy(to.distance.get(), from.distance.get(), from.pixels() * sizeof(float));
  std::memcpy(to.normal.get(), from.normal.get(), 3 * from.pixels() * sizeof(float));
}

}  // namespace limn::bench
