#include "sdf/key_numbers.h"

#include <algorithm>
#include <bit>

namespace limn {

// Keys are places, close to each other; Fibonacci hashing spreads them. Knuth, "The Art of Computer Programming", vol. 3, 6.4.
size_t KeyNumbers::slot_of(std::uint64_t key) const {
  const size_t mask = slots_.size() - 1;
  size_t slot = (key * 0x9e3779b97f4a7c15u) >> (64 - std::countr_zero(slots_.size()));
  while (slots_[slot].number != kNone && slots_[slot].key != key) slot = (slot + 1) & mask;
  return slot;
}

size_t KeyNumbers::find(std::uint64_t key) const { return slots_.empty() ? kNone : slots_[slot_of(key)].number; }

std::pair<size_t, bool> KeyNumbers::add(std::uint64_t key) {
  if (2 * (count_ + 1) > slots_.size()) grow();
  Slot& slot = slots_[slot_of(key)];
  const bool is_new = slot.number == kNone;
  if (is_new) slot = {key, count_++};
  return {slot.number, is_new};
}

void KeyNumbers::grow() {
  std::vector<Slot> before(std::max(size_t{64}, 4 * slots_.size()));
  before.swap(slots_);
  for (const Slot& slot : before)
    if (slot.number != kNone) slots_[slot_of(slot.key)] = slot;
}

}  // namespace limn
