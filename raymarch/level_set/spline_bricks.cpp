#include "raymarch/level_set/spline_bricks.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include "sdf/crossed_cells.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

using Accessor = nanovdb::FloatGrid::AccessorType;
using Leaf = nanovdb::FloatGrid::TreeType::LeafNodeType;

// A little less than 16 bits hold: the product that it is part of is rounded.
constexpr float kLargestStep = 32766.0f;
// Coefficients at -1..9 need values at -2..10.
constexpr int kSide = kSplineNodes + 2;
using Values = std::array<float, kSide * kSide * kSide>;
using Coefficients = std::array<float, kSplineNodes * kSplineNodes * kSplineNodes>;

constexpr size_t index_in(int side, int x, int y, int z) {
  return (static_cast<size_t>(x) * static_cast<size_t>(side) + static_cast<size_t>(y)) * static_cast<size_t>(side) + static_cast<size_t>(z);
}

size_t at(int x, int y, int z) { return index_in(kSide, x, y, z); }

void load_values(const Accessor& accessor, const glm::ivec3& origin, Values& values) {
  for (int x = -2; x <= 10; ++x) {
    for (int y = -2; y <= 10; ++y) {
      float* const row = &values[at(x + 2, y + 2, 2)];
      // A row lies in three leaves.
      for (const auto& [first, last] : {std::pair(-2, -1), std::pair(0, 7), std::pair(8, 10)}) {
        const nanovdb::Coord place(origin.x + x, origin.y + y, origin.z + first);
        if (const Leaf* leaf = accessor.probeLeaf(place))
          std::copy_n(leaf->data()->mValues + Leaf::CoordToOffset(place), last - first + 1, row + first);
        else
          std::fill_n(row + first, last - first + 1, accessor.getValue(place));
      }
    }
  }
}

size_t coefficient_at(int x, int y, int z) { return index_in(kSplineNodes, x, y, z); }

/// f less a sixth of its second differences along the axes, as sdf/gradients/cubic.cpp has them.
void find_coefficients(const Values& values, Coefficients& out) {
  constexpr size_t kX = kSide * kSide, kY = kSide;
  size_t i = 0;
  for (int x = 1; x <= kSplineNodes; ++x) {
    for (int y = 1; y <= kSplineNodes; ++y) {
      const float* const row = &values[at(x, y, 1)];
      for (int z = 0; z < kSplineNodes; ++z, ++i) {
        const float* const f = row + z;
        const float beside = (f[kX] + *(f - kX)) + (f[kY] + *(f - kY)) + (f[1] + *(f - 1));
        out[i] = 2.0f * *f - beside / 6.0f;
      }
    }
  }
}

/// The mean slope over the crossed cells.
glm::vec3 mean_slope(const Coefficients& c, const CrossedCells& crossed) {
  glm::dvec3 sum(0.0);
  int cells = 0;
  for_each_cell(crossed, [&](int x, int y, int z) {
    const float* const corner = &c[coefficient_at(x + 1, y + 1, z + 1)];
    constexpr int step[3] = {kSplineNodes * kSplineNodes, kSplineNodes, 1};
    for (int axis = 0; axis < 3; ++axis) sum[axis] += static_cast<double>(corner[step[axis]] - *corner);
    ++cells;
  });
  return glm::vec3(sum / static_cast<double>(std::max(cells, 1)));
}

/// Bit z of [x][y]: a crossed cell's stencil reads that coefficient.
using ReadNodes = std::array<std::array<std::uint32_t, kSplineNodes>, kSplineNodes>;
ReadNodes read_nodes(const CrossedCells& crossed) {
  ReadNodes read{};
  for (size_t x = 0; x < 8; ++x) {
    for (size_t y = 0; y < 8; ++y) {
      const std::uint32_t cells = crossed.cells[x][y];
      if (cells == 0) continue;
      const std::uint32_t nodes = cells | cells << 1 | cells << 2 | cells << 3;
      for (size_t dx = 0; dx < 4; ++dx) {
        for (size_t dy = 0; dy < 4; ++dy) read[x + dx][y + dy] |= nodes;
      }
    }
  }
  return read;
}

/// Takes the plane off the coefficients and returns half the span of what is left where it is read, around `middle`.
float take_plane(const glm::vec3& slope, const ReadNodes& read, Coefficients& c, float& middle) {
  float least = 1e30f, greatest = -1e30f;
  for (int x = 0; x < kSplineNodes; ++x) {
    for (int y = 0; y < kSplineNodes; ++y) {
      const std::uint32_t nodes = read[static_cast<size_t>(x)][static_cast<size_t>(y)];
      float* const row = &c[coefficient_at(x, y, 0)];
      const float across = slope.x * static_cast<float>(x) + slope.y * static_cast<float>(y);
      for (int z = 0; z < kSplineNodes; ++z) {
        row[z] -= across + slope.z * static_cast<float>(z);
        if ((nodes >> z & 1) == 0) continue;
        least = std::min(least, row[z]);
        greatest = std::max(greatest, row[z]);
      }
    }
  }
  middle = 0.5f * (least + greatest);
  return 0.5f * (greatest - least);
}

SplineBricks::Plane make_brick(const Values& values, std::int16_t* to) {
  Coefficients c;
  find_coefficients(values, c);
  const CrossedCells crossed = crossed_cells([&values](int x, int y) { return &values[at(x + 2, y + 2, 2)]; });
  const glm::vec3 slope = mean_slope(c, crossed);
  float middle = 0.0f;
  const float half = take_plane(slope, read_nodes(crossed), c, middle);
  // Where nothing is left any step would do: one that keeps the slope itself in range.
  const float steps_per_unit = kLargestStep / std::max(half, 1e-6f * std::max(glm::length(slope), 1e-30f));
  for (size_t k = 0; k < c.size(); ++k) {
    const float steps = std::clamp((c[k] - middle) * steps_per_unit, -kLargestStep, kLargestStep);
    to[k] = static_cast<std::int16_t>(steps + (steps < 0.0f ? -0.5f : 0.5f));
  }
  std::fill(to + c.size(), to + kSplineStride, std::int16_t{0});
  const glm::vec3 steps = slope * steps_per_unit;
  // The coefficients begin one node before the brick.
  return {{steps.x, steps.y, steps.z}, middle * steps_per_unit + steps.x + steps.y + steps.z};
}

}  // namespace

SplineBricks make_spline_bricks(const LevelSetData& data, std::span<const glm::ivec3> origins) {
  SplineBricks bricks;
  bricks.planes.resize(origins.size());
  bricks.rests.resize(origins.size() * kSplineStride);
  parallel_parts(origins.size(), size_t{64}, [&](const IndexRange<size_t>& range) {
    const Accessor accessor = data.accessor();
    Values values;
    for (size_t i = range.begin(); i < range.end(); ++i) {
      load_values(accessor, origins[i], values);
      bricks.planes[i] = make_brick(values, bricks.rests.data() + i * kSplineStride);
    }
  });
  return bricks;
}

}  // namespace limn
