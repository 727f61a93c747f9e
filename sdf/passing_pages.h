#pragma once
// Large arrays of which no second one of the same size follows, such as those that a mesh is made from.

#include <cstddef>
#include <vector>

namespace limn {

/// As LargePages (sdf/large_pages.h), but what is given back is the system's at once: nothing waits for the next.
struct PassingPages {
  static void* take(size_t bytes);                    ///< At least one byte, unset. Throws std::bad_alloc.
  static void give_back(void* memory, size_t bytes);  ///< What take() gave, and how much that was. Never throws.
};

/// For std::vector: elements that it is given no value for are left unset.
template <class T>
struct PassingAllocator {
  using value_type = T;  ///< As std::vector asks.
  PassingAllocator() = default;
  /// All are alike.
  template <class U>
  PassingAllocator(const PassingAllocator<U>&) {}
  T* allocate(size_t count) { return static_cast<T*>(PassingPages::take(count * sizeof(T))); }      ///< Room for `count` elements.
  void deallocate(T* memory, size_t count) { PassingPages::give_back(memory, count * sizeof(T)); }  ///< What allocate() gave.
  /// Leaves it unset.
  template <class U>
  void construct(U*) {}
  bool operator==(const PassingAllocator&) const { return true; }  ///< Memory of one may be given back by another.
};

/// Whoever fills it touches its pages first: many threads at once, where many fill it.
template <class T>
using PassingVector = std::vector<T, PassingAllocator<T>>;

}  // namespace limn
