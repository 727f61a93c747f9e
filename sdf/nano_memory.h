#pragma once
// Internal: memory that NanoVDB takes.

#include <cstring>
#include <new>
#include <stdexcept>

namespace limn {

/// What `make` makes in NanoVDB's buffers. Where memory ends they have words of their own ("Pool::Pool malloc failed"): std::bad_alloc.
template <class Make>
auto in_nano_memory(const Make& make) {
  try {
    return make();
  } catch (const std::runtime_error& error) {
    if (std::strstr(error.what(), "malloc failed") != nullptr) throw std::bad_alloc();
    throw;
  }
}

}  // namespace limn
