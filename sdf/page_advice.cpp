#include "sdf/page_advice.h"

#include <memory>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace limn {

void ask_for_large_pages([[maybe_unused]] void* memory, [[maybe_unused]] std::size_t bytes) {
#if defined(__linux__)
  void* first = memory;
  std::size_t left = bytes;
  if (std::align(kLargePageBytes, kLargePageBytes, first, left))
    static_cast<void>(madvise(first, left / kLargePageBytes * kLargePageBytes, MADV_HUGEPAGE));
#endif
}

}  // namespace limn
