#include "raymarch/level_set/spline_bricks.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace limn {
namespace {

using Accessor = nanovdb::FloatGrid::AccessorType;
using Leaf = nanovdb::FloatGrid::TreeType::LeafNodeType;

// A little less than 24 bits hold: the product that it is part of is rounded.
constexpr float kLargestStep = 8388600.0f;
// Coefficients at -1..9 need values at -2..10.
constexpr int kSide = kSplineNodes + 2;
using Values = std::array<float, kSide * kSide * kSide>;
using Coefficients = std::array<float, kSplineNodes * kSplineNodes * kSplineNodes>;

size_t at(int x, int y, int z) { return static_cast<size_t>((x * kSide + y) * kSide + z); }

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

/// f less a sixth of its second differences along the axes, as sdf/gradients/cubic.cpp has them. Returns the largest in size.
float find_coefficients(const Values& values, Coefficients& out) {
  constexpr size_t kX = kSide * kSide, kY = kSide;
  float largest = 0.0f;
  size_t i = 0;
  for (int x = 1; x <= kSplineNodes; ++x) {
    for (int y = 1; y <= kSplineNodes; ++y) {
      const float* const row = &values[at(x, y, 1)];
      for (int z = 0; z < kSplineNodes; ++z, ++i) {
        const float* const f = row + z;
        const float beside = (f[kX] + *(f - kX)) + (f[kY] + *(f - kY)) + (f[1] + f[-1]);
        out[i] = 2.0f * *f - beside / 6.0f;
        largest = std::max(largest, std::abs(out[i]));
      }
    }
  }
  return largest;
}

}  // namespace

SplineBricks make_spline_bricks(const LevelSetData& data, std::span<const glm::ivec3> origins) {
  SplineBricks bricks;
  bricks.high.resize(origins.size() * kSplineStride);
  bricks.low.resize(origins.size() * kSplineStride + 3);
  std::fill_n(bricks.low.end() - 3, 3, std::uint8_t{0});
  tbb::parallel_for(tbb::blocked_range<size_t>(0, origins.size(), 64), [&](const tbb::blocked_range<size_t>& range) {
    const Accessor accessor = data.accessor();
    Values values;
    Coefficients coefficients;
    for (size_t i = range.begin(); i < range.end(); ++i) {
      load_values(accessor, origins[i], values);
      const float largest = find_coefficients(values, coefficients);
      const float steps_per_unit = largest > 0.0f ? kLargestStep / largest : 0.0f;
      std::int16_t* const high = bricks.high.data() + i * kSplineStride;
      std::uint8_t* const low = bricks.low.data() + i * kSplineStride;
      for (size_t k = 0; k < coefficients.size(); ++k) {
        const auto steps = static_cast<std::int32_t>(std::lround(coefficients[k] * steps_per_unit));
        high[k] = static_cast<std::int16_t>(steps >> 8);
        low[k] = static_cast<std::uint8_t>(steps & 255);
      }
      high[kSplineStride - 1] = 0;
      low[kSplineStride - 1] = 0;
    }
  });
  return bricks;
}

}  // namespace limn
