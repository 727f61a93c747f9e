#pragma once
// Internal: which of many places is nearest, found with the widest SIMD of the machine.

#include <array>
#include <cstddef>
#include <vector>

namespace limn {

/// Places by axis. pad() fills up what a vector would read beyond them.
struct Places {
  std::array<std::vector<float>, 3> at{};

  bool empty() const { return at[0].empty(); }
  void clear();
  void add(float x, float y, float z);
  void pad();  ///< With the last place again; not where there is none.
};

/// The number of the place nearest to `p`, the first of several; of places that were padded, at least one. No coordinate is NaN.
std::size_t nearest_place(const Places& places, const std::array<float, 3>& p);

}  // namespace limn
