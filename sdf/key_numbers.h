#pragma once
// Internal: numbers for keys of 64 bits.

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace limn {

/// Numbers in the order in which their keys came. Slots are open and half of them free: a look touches one line of memory.
class KeyNumbers {
 public:
  static constexpr size_t kNone = ~size_t{0};

  size_t find(std::uint64_t key) const;
  /// The key's number, its own or the next one, and whether it is new.
  std::pair<size_t, bool> add(std::uint64_t key);
  bool contains(std::uint64_t key) const { return find(key) != kNone; }

 private:
  struct Slot {
    std::uint64_t key = 0;
    size_t number = kNone;
  };
  size_t slot_of(std::uint64_t key) const;
  void grow();

  std::vector<Slot> slots_{};  ///< A power of two, or none.
  size_t count_ = 0;
};

}  // namespace limn
