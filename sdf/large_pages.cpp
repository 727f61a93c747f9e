#include "sdf/large_pages.h"

#include <cstdlib>
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
    if (block.bytes > kMostKept) return std::free(block.memory);
    while (kept_ + block.bytes > kMostKept) drop_oldest();
    blocks_.push_back(block);
    kept_ += block.bytes;
  }

  void drop_all() {
    const std::lock_guard lock(mutex_);
    while (!blocks_.empty()) drop_oldest();
  }

 private:
  void drop_oldest() {
    kept_ -= blocks_.front().bytes;
    std::free(blocks_.front().memory);
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

size_t rounded(size_t bytes) {
  const size_t page = bytes >= kLargePageBytes ? kLargePageBytes : 64;
  return (bytes + page - 1) / page * page;
}

}  // namespace

void* LargePages::take(size_t bytes) {
  const size_t size = rounded(bytes);
  if (size < kLargePageBytes) {
    void* const memory = std::aligned_alloc(64, size);
    if (!memory) throw std::bad_alloc();
    return memory;
  }
  if (void* const kept = kept_blocks().take(size)) return kept;
  void* memory = std::aligned_alloc(kLargePageBytes, size);
  if (!memory) {
    kept_blocks().drop_all();
    memory = std::aligned_alloc(kLargePageBytes, size);
  }
  if (!memory) throw std::bad_alloc();
  ask_for_large_pages(memory, size);
  return memory;
}

void LargePages::give_back(void* memory, size_t bytes) {
  const size_t size = rounded(bytes);
  if (size < kLargePageBytes) return std::free(memory);
  try {
    kept_blocks().keep({memory, size});
  } catch (const std::bad_alloc&) {  // of the list itself
    std::free(memory);
  }
}

void LargePages::release() { kept_blocks().drop_all(); }

}  // namespace limn
