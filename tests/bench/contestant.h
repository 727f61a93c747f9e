#pragma once
// One contestant of the marching benchmark: traces the same picture, the same rays, into the same buffers.

#include <functional>
#include <string>
#include <vector>

#include "sdf/camera.h"
#include "sdf/level_set.h"

namespace limn::bench {

/// What every contestant has to fill: distance along the ray (infinite for a miss) and the unit normal, for each pixel, row by row.
struct Frame {
  std::vector<float> distance;
  std::vector<glm::vec3> normal;
};

struct Contestant {
  std::string name;
  bool is_peer = true;
  std::function<void(Frame&)> draw;  ///< Uses as many threads as the surrounding task arena has.
};

struct BenchCase {
  Camera camera;
  LevelSet level_set;
};

/// Calls `row(y)` for each line of the picture on the threads of the surrounding arena.
void for_each_row(int height, const std::function<void(int)>& row);

Contestant openvdb_level_set_ray_intersector(const BenchCase& bench_case);
Contestant nanovdb_zero_crossing(const BenchCase& bench_case);
Contestant embree_on_grid_mesh(const BenchCase& bench_case);

}  // namespace limn::bench
