#include "sdf/large_pages.h"

#include <cstdlib>
#include <new>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace limn {

void* LargePages::take(size_t bytes) {
  constexpr size_t kPage = size_t{2} << 20;
  const size_t page = bytes >= kPage ? kPage : 64, rounded = (bytes + page - 1) / page * page;
  void* const memory = std::aligned_alloc(page, rounded);
  if (!memory) throw std::bad_alloc();
#if defined(__linux__)
  // A wish, no more: where it is not granted everything works the same.
  if (page == kPage) static_cast<void>(madvise(memory, rounded, MADV_HUGEPAGE));
#endif
  return memory;
}

void LargePages::give_back(void* memory) { std::free(memory); }

}  // namespace limn
