#pragma once
// Internal: memory in few, large pages where the system has them: rays jump from brick to brick, and a page each would be looked up every
// time.

#include <cstddef>

namespace limn {

struct LargePages {
  static void* take(size_t bytes);
  static void give_back(void* memory);
};

template <class T>
struct LargePageAllocator {
  using value_type = T;
  LargePageAllocator() = default;
  template <class U>
  LargePageAllocator(const LargePageAllocator<U>&) {}
  T* allocate(size_t count) { return static_cast<T*>(LargePages::take(count * sizeof(T))); }
  void deallocate(T* memory, size_t) { LargePages::give_back(memory); }
  /// Elements are left unset: whoever makes bricks writes all of them.
  template <class U>
  void construct(U*) {}
  bool operator==(const LargePageAllocator&) const { return true; }
};

}  // namespace limn
