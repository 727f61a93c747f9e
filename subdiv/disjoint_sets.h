#pragma once
// Internal: which of many things are one.

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace limn {

/// Of 0, ..., count - 1, each alone at first. A set is named by the least in it.
class DisjointSets {
 public:
  explicit DisjointSets(size_t count = 0) { reset(count); }
  void reset(size_t count) {
    parent_.resize(count);
    std::iota(parent_.begin(), parent_.end(), size_t{0});
  }
  size_t find(size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(size_t a, size_t b) {
    a = find(a), b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<size_t> parent_{};
};

}  // namespace limn
