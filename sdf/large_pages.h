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
  static bool release();                              ///< Hands what waits to the system; false where nothing does.
};

/// The same, but what is given back is the system's at once: for large arrays of which no second one of the same size follows, such as
/// those that a mesh is made from.
struct PassingPages {
  static void* take(size_t bytes);                    ///< At least one byte, unset. Throws std::bad_alloc.
  static void give_back(void* memory, size_t bytes);  ///< What take() gave, and how much that was. Never throws.
};

/// For std::vector: elements that it is given no value for are left unset. Memory of one may be given back by another.
template <class T, class Pages>
struct PageAllocator {
  using value_type = T;  ///< As std::vector asks.
  PageAllocator() = default;
  /// All are alike.
  template <class U>
  PageAllocator(const PageAllocator<U, Pages>&) {}
  T* allocate(size_t count) { return static_cast<T*>(Pages::take(count * sizeof(T))); }      ///< Room for `count` elements.
  void deallocate(T* memory, size_t count) { Pages::give_back(memory, count * sizeof(T)); }  ///< What allocate() gave.
  /// Leaves it unset.
  template <class U>
  void construct(U*) {}
  bool operator==(const PageAllocator&) const { return true; }  ///< All are alike.
};
template <class T>
using LargePageAllocator = PageAllocator<T, LargePages>;  ///< Of memory that waits to be used again.

/// Whoever fills them touches their pages first: many threads at once, where many fill them.
template <class T>
using LargeVector = std::vector<T, LargePageAllocator<T>>;
template <class T>
using PassingVector = std::vector<T, PageAllocator<T, PassingPages>>;  ///< Of memory that is soon given back.

}  // namespace limn
