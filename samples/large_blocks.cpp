// Large blocks of memory in large pages, for the whole program: refining a mesh touches hundreds of megabytes once, and the system takes as
// long to hand them over in small pages as the work on them takes. Libraries' vectors ask here, too.

#include <cstdlib>
#include <new>

#include "sdf/page_advice.h"

void* operator new(std::size_t bytes) {
  void* memory = std::malloc(bytes > 0 ? bytes : 1);
  while (memory == nullptr) {
    const std::new_handler free_some = std::get_new_handler();
    if (free_some == nullptr) throw std::bad_alloc();
    free_some();
    memory = std::malloc(bytes > 0 ? bytes : 1);
  }
  if (bytes >= limn::kLargePageBytes) limn::ask_for_large_pages(memory, bytes);
  return memory;
}

void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
