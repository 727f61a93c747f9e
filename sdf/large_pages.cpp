#include "sdf/large_pages.h"

#include <cstdlib>
#include <memory>
#include <new>

#include "sdf/page_advice.h"

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace limn {
namespace {

constexpr size_t kPage = size_t{2} << 20;

}  // namespace

void ask_for_large_pages([[maybe_unused]] void* memory, [[maybe_unused]] size_t bytes) {
#if defined(__linux__)
  void* first = memory;
  size_t left = bytes;
  if (std::align(kPage, kPage, first, left)) static_cast<void>(madvise(first, left / kPage * kPage, MADV_HUGEPAGE));
#endif
}

void* LargePages::take(size_t bytes) {
  const size_t page = bytes >= kPage ? kPage : 64, rounded = (bytes + page - 1) / page * page;
  void* const memory = std::aligned_alloc(page, rounded);
  if (!memory) throw std::bad_alloc();
  if (page == kPage) ask_for_large_pages(memory, rounded);
  return memory;
}

void LargePages::give_back(void* memory) { std::free(memory); }

}  // namespace limn
