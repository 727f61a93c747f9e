#pragma once
// Memory in few, large pages where the system has them: rays jump from brick to brick, and a page each would be looked up every time; and
// the first touch of a picture's small pages takes longer than a border.

#include <cstddef>
#include <vector>

namespace limn {

/// Small pieces come from where all memory does. Large ones wait for the next that takes as much, up to 256 MB of them: their pages need
/// not be cleared again. All threads may ask.
struct LargePages {
  static void* take(size_t bytes);                    ///< At least one byte, unset. Throws std::bad_alloc.
  static void give_back(void* memory, size_t bytes);  ///< What take() gave, and how much that was. Never throws.
  static void release();                              ///< Hands what waits to the system.
};

/// For std::vector: elements that it is given no value for are left unset.
template <class T>
struct LargePageAllocator {
  using value_type = T;  ///< As std::vector asks.
  LargePageAllocator() = default;
  /// All are alike.
  template <class U>
  LargePageAllocator(const LargePageAllocator<U>&) {}
  T* allocate(size_t count) { return static_cast<T*>(LargePages::take(count * sizeof(T))); }      ///< Room for `count` elements.
  void deallocate(T* memory, size_t count) { LargePages::give_back(memory, count * sizeof(T)); }  ///< What allocate() gave.
  /// Leaves it unset.
  template <class U>
  void construct(U*) {}
  bool operator==(const LargePageAllocator&) const { return true; }  ///< Memory of one may be given back by another.
};

/// Whoever fills it touches its pages first: many threads at once, where many fill it.
template <class T>
using LargeVector = std::vector<T, LargePageAllocator<T>>;

}  // namespace limn
