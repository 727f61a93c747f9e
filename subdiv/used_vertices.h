#pragma once
// Internal: which vertices something uses, and the box around them, by all threads: large meshes are asked several times in a call.

#include <atomic>
#include <vector>

#include "sdf/geometry.h"
#include "sdf/parallel.h"

namespace limn {

/// Sets `used` at vertex(0), ..., vertex(count - 1), all below its size.
template <class Vertex>
void mark_used(size_t count, const Vertex& vertex, std::vector<char>& used) {
  parallel_parts(count, size_t{16'384}, [&](const IndexRange<size_t>& part) {
    // Several threads may set one: to the same.
    for (size_t i = part.begin(); i < part.end(); ++i)
      std::atomic_ref(used[static_cast<size_t>(vertex(i))]).store(1, std::memory_order_relaxed);
  });
}

/// Around at(v) of each used vertex v; empty where none is.
template <class At>
Box box_of_used(const std::vector<char>& used, const At& at) {
  return parallel_reduce(
      used.size(), size_t{16'384}, Box{},
      [&](const IndexRange<size_t>& part, Box box) {
        for (size_t v = part.begin(); v < part.end(); ++v)
          if (used[v]) box = include(box, at(v));
        return box;
      },
      [](const Box& a, const Box& b) { return merge(a, b); });
}

}  // namespace limn
