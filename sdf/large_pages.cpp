#include "sdf/large_pages.h"

#include <sys/mman.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <new>
#include <vector>

#include "sdf/page_advice.h"

namespace limn {
namespace {

/// Of blocks that nobody uses: two pictures of 1920x1080 with all that one is made from.
constexpr size_t kMostKept = size_t{256} << 20;

struct Block {
  void* memory = nullptr;
  size_t bytes = 0;
};

/// Blocks that were given back, the latest last. The system clears every page that it hands out, which takes a third of the time of a
/// picture; the next picture needs blocks of the same sizes.
class KeptBlocks {
 public:
  /// As many as there can be: nothing is allocated while the mutex is held, where what frees memory may ask for it (release()).
  KeptBlocks() { blocks_.reserve(kMostKept / kLargePageBytes); }

  /// Null where there is none of that size.
  void* take(size_t bytes) {
    const std::lock_guard lock(mutex_);
    for (size_t i = blocks_.size(); i-- > 0;) {
      if (blocks_[i].bytes != bytes) continue;
      void* const memory = blocks_[i].memory;
      blocks_.erase(blocks_.begin() + static_cast<std::ptrdiff_t>(i));
      kept_ -= bytes;
      return memory;
    }
    return nullptr;
  }

  void keep(const Block& block) {
    const std::lock_guard lock(mutex_);
    if (block.bytes > kMostKept) {
      ::munmap(block.memory, block.bytes);
      return;
    }
    while (kept_ + block.bytes > kMostKept) drop_oldest();
    blocks_.push_back(block);
    kept_ += block.bytes;
  }

  /// False where there were none.
  bool drop_all() {
    const std::lock_guard lock(mutex_);
    const bool any = !blocks_.empty();
    while (!blocks_.empty()) drop_oldest();
    return any;
  }

 private:
  void drop_oldest() {
    kept_ -= blocks_.front().bytes;
    ::munmap(blocks_.front().memory, blocks_.front().bytes);
    blocks_.erase(blocks_.begin());
  }

  std::mutex mutex_;
  std::vector<Block> blocks_;
  size_t kept_ = 0;
};

KeptBlocks& kept_blocks() {
  // Never destroyed: pictures may outlive what main() leaves behind.
  static KeptBlocks* const blocks = new KeptBlocks;
  return *blocks;
}

/// Mapped by the system, not cut from the heap, whose gaps between blocks that are aligned like this grow by a block with every other
/// picture. Null where there is no room.
void* map_block(size_t bytes) {
  const size_t mapped = bytes + kLargePageBytes;
  void* const start = ::mmap(nullptr, mapped, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (start == MAP_FAILED) return nullptr;
  auto* const first = static_cast<std::byte*>(start);
  const size_t before = (kLargePageBytes - reinterpret_cast<std::uintptr_t>(start) % kLargePageBytes) % kLargePageBytes;
  if (before > 0) ::munmap(first, before);
  ::munmap(first + before + bytes, mapped - before - bytes);
  return first + before;
}

constexpr size_t kLine = 64;  // bytes of the cache

/// From the heap, on a line of the cache, with its own place before it. Not by aligned_alloc: up to version 2.37 glibc never finds what was
/// given back to it again for the next block of the same size, and a call of many pictures grows by megabytes with each of them.
void* take_line(size_t bytes) {
  void* const place = std::malloc(bytes + kLine);
  if (place == nullptr) return nullptr;
  auto* const first = static_cast<std::byte*>(place);
  std::byte* const memory = first + (kLine - reinterpret_cast<std::uintptr_t>(place) % kLine);
  static_assert(alignof(std::max_align_t) >= sizeof place);  // room before it, which malloc leaves at least
  std::memcpy(memory - sizeof place, &place, sizeof place);
  return memory;
}

void give_back_line(void* memory) {
  void* place = nullptr;
  std::memcpy(&place, static_cast<std::byte*>(memory) - sizeof place, sizeof place);
  std::free(place);
}

size_t rounded(size_t bytes) {
  const size_t page = bytes >= kLargePageBytes ? kLargePageBytes : kLine;
  return (bytes + page - 1) / page * page;
}

}  // namespace

void* LargePages::take(size_t bytes) {
  const size_t size = rounded(bytes);
  if (size >= kLargePageBytes)
    if (void* const kept = kept_blocks().take(size)) return kept;
  return PassingPages::take(bytes);
}

void LargePages::give_back(void* memory, size_t bytes) {
  const size_t size = rounded(bytes);
  if (size < kLargePageBytes) return give_back_line(memory);
  kept_blocks().keep({memory, size});
}

bool LargePages::release() { return kept_blocks().drop_all(); }

void* PassingPages::take(size_t bytes) {
  const size_t size = rounded(bytes);
  const bool large = size >= kLargePageBytes;
  void* memory = large ? map_block(size) : take_line(size);
  if (!memory && large) {
    kept_blocks().drop_all();
    memory = map_block(size);
  }
  if (!memory) throw std::bad_alloc();
  if (large) ask_for_large_pages(memory, size);
  return memory;
}

void PassingPages::give_back(void* memory, size_t bytes) {
  const size_t size = rounded(bytes);
  if (size < kLargePageBytes) return give_back_line(memory);
  ::munmap(memory, size);
}

}  // namespace limn
